"""A point mass on a rod: a bilateral constraint whose relation is a Python override."""

import numpy as np
import siconos.kernel as sk

mass, length, gravity = 1.0, 2.0, 9.81


class Rod(sk.LagrangianScleronomousR):
    def computeh(self, q, z, y):
        y[0] = (q[0] ** 2 + q[1] ** 2 - length**2) / (2 * length)

    def computeJachq(self, q, z):
        self.jachq()[0, :] = q / length


point = sk.LagrangianLinearTIDS([length, 0.0], [0.0, 0.0], mass * np.eye(2))
point.setFExtPtr([0.0, -mass * gravity])
relation = Rod()
rod = sk.Interaction(sk.EqualityConditionNSL(1), relation)
model = sk.NonSmoothDynamicalSystem(0.0, 2.0)
model.insertDynamicalSystem(point)
model.link(rod, point)
simulation = sk.TimeStepping(model, sk.TimeDiscretisation(0.0, 1e-3), sk.MoreauJeanOSI(0.5), sk.Equality())
rows = [[0.0, length, 0.0, 0.0, 0.0, 0.0]]
while simulation.hasNextEvent():
    simulation.computeOneStep()
    q, v = point.q(), point.velocity()
    rows.append([simulation.nextTime(), q[0], q[1], v[0], v[1], rod.lambda_(1)[0]])
    simulation.nextStep()
dataPlot = np.array(rows)
