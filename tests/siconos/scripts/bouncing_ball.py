"""A ball that falls on the floor and bounces until it lies."""

import numpy as np
from siconos.kernel import (
    LCP,
    Interaction,
    LagrangianLinearTIDS,
    LagrangianLinearTIR,
    MoreauJeanOSI,
    NewtonImpactNSL,
    NonSmoothDynamicalSystem,
    TimeDiscretisation,
    TimeStepping,
)

t0, T, h = 0.0, 5.0, 5e-3
mass, gravity, height, e, theta = 1.5, 9.81, 1.0, 0.8, 0.5

ball = LagrangianLinearTIDS([height, 0, 0], [0, 0, 0], mass * np.eye(3))
ball.setFExtPtr([-mass * gravity, 0, 0])
floor = Interaction(NewtonImpactNSL(e), LagrangianLinearTIR([[1, 0, 0]]))
model = NonSmoothDynamicalSystem(t0, T)
model.insertDynamicalSystem(ball)
model.link(floor, ball)
simulation = TimeStepping(model, TimeDiscretisation(t0, h), MoreauJeanOSI(theta), LCP())

N = int(round((T - t0) / h))
dataPlot = np.zeros((N + 1, 6))
q, v, p, impulse = ball.q(), ball.velocity(), ball.p(1), floor.lambda_(1)
dataPlot[0] = [t0, q[0], v[0], p[0], impulse[0], floor.y(0)[0]]
k = 1
while simulation.hasNextEvent():
    simulation.computeOneStep()
    dataPlot[k, 0] = simulation.nextTime()
    dataPlot[k, 1] = q[0]
    dataPlot[k, 2] = v[0]
    dataPlot[k, 3] = p[0]
    dataPlot[k, 4] = impulse[0]
    dataPlot[k, 5] = floor.y(0)[0]
    k += 1
    simulation.nextStep()
