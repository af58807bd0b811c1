"""A ball under a force that a Python class gives, F(t) = m (a sin(w t) - g)."""

from math import sin

import numpy as np
import siconos.kernel as sk

mass, gravity, amplitude, frequency = 1.0, 9.81, 2.0, 3.0


class Ball(sk.LagrangianDS):
    def computeFExt(self, time):
        self.fExt()[0] = mass * (amplitude * sin(frequency * time) - gravity)


ball = Ball([1.0, 0.0, 0.0], [0.0, 0.0, 0.0], mass * np.eye(3))
ball.setFExtPtr(np.zeros(3))
floor = sk.Interaction(sk.NewtonImpactNSL(0.7), sk.LagrangianLinearTIR([[1.0, 0.0, 0.0]], [-0.1]))
model = sk.NonSmoothDynamicalSystem(0.0, 4.0)
model.insertDynamicalSystem(ball)
model.link(floor, ball)
simulation = sk.TimeStepping(model, sk.TimeDiscretisation(0.0, 2e-3), sk.MoreauJeanOSI(0.5), sk.LCP())
rows = [[0.0, 1.0, 0.0, 0.0]]
while simulation.hasNextEvent():
    simulation.computeOneStep()
    rows.append([simulation.nextTime(), ball.q()[0], ball.velocity()[0], floor.lambda_(1)[0]])
    simulation.nextStep()
dataPlot = np.array(rows)
