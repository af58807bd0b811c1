"""Siconos's side of the comparison: prints t, q, v, impulse of a bouncing ball for every step as JSON.

Run by the Python that has Siconos, not by the one that has Saltus:
``python3 bouncing_ball.py THETA RESTITUTION DT UNTIL``.
"""

import json
import sys

import numpy as np
import siconos.kernel as sk

theta, restitution, time_step, until = map(float, sys.argv[1:])
ball = sk.LagrangianLinearTIDS([1.0, 0.0, 0.0], [0.0, 0.0, 0.0], np.eye(3))
ball.setFExtPtr([-9.81, 0.0, 0.0])
law = sk.NewtonImpactNSL(restitution)
relation = sk.LagrangianLinearTIR([[1.0, 0.0, 0.0]])
floor = sk.Interaction(law, relation)
system = sk.NonSmoothDynamicalSystem(0.0, until)
system.insertDynamicalSystem(ball)
system.link(floor, ball)
integrator = sk.MoreauJeanOSI(theta)
simulation = sk.TimeStepping(system, sk.TimeDiscretisation(0.0, time_step), integrator, sk.LCP())

rows = [[0.0, ball.q()[0], ball.velocity()[0], 0.0]]
while simulation.hasNextEvent():
    simulation.computeOneStep()
    rows.append([simulation.nextTime(), ball.q()[0], ball.velocity()[0], floor.lambda_(1)[0]])
    simulation.nextStep()
print(json.dumps(rows))
