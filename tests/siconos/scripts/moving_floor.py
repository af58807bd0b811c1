"""A ball on a floor that moves up and down: a relation that depends on the time."""

from math import cos, sin

import numpy as np
import siconos.kernel as sk

amplitude, frequency = 0.05, 8.0


class Floor(sk.LagrangianRheonomousR):
    def computeh(self, time, q, z, y):
        y[0] = q[0] - amplitude * sin(frequency * time)

    def computehDot(self, time, q, z):
        self.hDot()[0] = -amplitude * frequency * cos(frequency * time)

    def computeJachq(self, time, q, z):
        self.jachq()[0, 0] = 1.0


ball = sk.LagrangianLinearTIDS([0.5], [0.0], [[1.0]])
ball.setFExtPtr([-9.81])
model = sk.NonSmoothDynamicalSystem(0.0, 3.0)
model.insertDynamicalSystem(ball)
relation = Floor()
floor = sk.Interaction(sk.NewtonImpactNSL(0.5), relation)
model.link(floor, ball)
simulation = sk.TimeStepping(model, sk.TimeDiscretisation(0.0, 1e-3), sk.MoreauJeanOSI(0.5), sk.LCP())
simulation.setNewtonTolerance(1e-12)
rows = [[0.0, 0.5, 0.0, 0.0]]
while simulation.hasNextEvent():
    simulation.computeOneStep()
    rows.append([simulation.nextTime(), ball.q()[0], ball.velocity()[0], floor.lambda_(1)[0]])
    simulation.nextStep()
dataPlot = np.array(rows)
