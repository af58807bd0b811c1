"""Two balls, one above the other, that fall together: an interaction between two systems."""

import numpy as np
import siconos.kernel as sk

gravity, radius = 9.81, 0.1
model = sk.NonSmoothDynamicalSystem(0, 3)
balls = []
for mass, height in ((2.0, 1.0), (0.5, 1.3)):
    ball = sk.LagrangianLinearTIDS([height], [0.0], [[mass]])
    ball.setFExtPtr([-mass * gravity])
    model.insertDynamicalSystem(ball)
    balls.append(ball)
law = sk.NewtonImpactNSL(0.6)
floor = sk.Interaction(law, sk.LagrangianLinearTIR([[1.0]], [-radius]))
between = sk.Interaction(law, sk.LagrangianLinearTIR([[-1.0, 1.0]], [-2 * radius]))
model.link(floor, balls[0])
model.link(between, balls[0], balls[1])
simulation = sk.TimeStepping(model, sk.TimeDiscretisation(0, 2e-3), sk.MoreauJeanOSI(0.5), sk.LCP())
rows = [[0.0, 1.0, 1.3, 0, 0, 0, 0]]
while simulation.hasNextEvent():
    simulation.computeOneStep()
    rows.append(
        [
            simulation.nextTime(),
            *(ball.q()[0] for ball in balls),
            *(ball.p(1)[0] for ball in balls),
            floor.lambda_(1)[0],
            between.lambda_(1)[0],
        ]
    )
    simulation.nextStep()
dataPlot = np.array(rows)
