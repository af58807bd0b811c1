"""A pendulum that swings against a wall: its internal force is a Python override."""

from math import pi, sin

import numpy as np
import siconos.kernel as sk

mass, length, gravity, wall = 2.0, 1.5, 9.81, -0.3


class Pendulum(sk.LagrangianDS):
    def computeFInt(self, time, position, velocity):
        self.fInt()[0] = mass * gravity * length * sin(position[0])


pendulum = Pendulum([pi / 3], [0.0], [[mass * length**2]])
pendulum.setFIntPtr([0.0])
model = sk.NonSmoothDynamicalSystem(0.0, 3.0)
model.insertDynamicalSystem(pendulum)
contact = sk.Interaction(sk.NewtonImpactNSL(0.9), sk.LagrangianLinearTIR([[1.0]], [-wall]))
model.link(contact, pendulum)
simulation = sk.TimeStepping(model, sk.TimeDiscretisation(0.0, 1e-3), sk.MoreauJeanOSI(0.5), sk.LCP())
simulation.setNewtonTolerance(1e-12)
rows = [[0.0, pi / 3, 0.0, 0.0]]
while simulation.hasNextEvent():
    simulation.computeOneStep()
    rows.append([simulation.nextTime(), pendulum.q()[0], pendulum.velocity()[0], contact.lambda_(1)[0]])
    simulation.nextStep()
dataPlot = np.array(rows)
