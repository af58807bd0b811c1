"""A nonlinear oscillator under a relay: output and input of the relation are nonlinear as well."""

import numpy as np
import siconos.kernel as sk

t0, T, h = 0.0, 6.0, 2e-3


class Oscillator(sk.FirstOrderNonLinearDS):
    def __init__(self, x0):
        super().__init__(x0)
        self.setFPtr(np.zeros(2))
        self.setJacobianfxPtr(np.zeros((2, 2)))

    def computef(self, time, x):
        self.setFPtr([x[1], -x[0] - x[0] ** 3 + np.sin(2.0 * time)])

    def computeJacobianfx(self, time, x):
        self.setJacobianfxPtr([[0.0, 1.0], [-1.0 - 3.0 * x[0] ** 2, 0.0]])


class Feedback(sk.FirstOrderNonLinearR):
    def computeh(self, time, x, lam, z, y):
        y[0] = x[0] + x[1] + 0.1 * x[1] ** 3 + 0.02 * lam[0]

    def computeg(self, time, x, lam, z, r):
        r[0] = 0.1 * lam[0]
        r[1] = 1.5 * lam[0] + 0.2 * lam[0] ** 3 + 0.5 * x[0] ** 2 * lam[0]

    def computeJachx(self, time, x, lam, z, C):
        C[:] = [[1.0, 1.0 + 0.3 * x[1] ** 2]]

    def computeJachlambda(self, time, x, lam, z, D):
        D[:] = [[0.02]]

    def computeJacgx(self, time, x, lam, z, K):
        K[:] = [[0.0, 0.0], [x[0] * lam[0], 0.0]]

    def computeJacglambda(self, time, x, lam, z, B):
        B[:] = [[0.1], [1.5 + 0.6 * lam[0] ** 2 + 0.5 * x[0] ** 2]]


oscillator, law, feedback = Oscillator([1.5, 0.0]), sk.RelayNSL(1), Feedback()
relay = sk.Interaction(law, feedback)
model = sk.NonSmoothDynamicalSystem(t0, T)
model.insertDynamicalSystem(oscillator)
model.link(relay, oscillator)
simulation = sk.TimeStepping(model, sk.TimeDiscretisation(t0, h), sk.EulerMoreauOSI(0.5), sk.Relay())
simulation.setComputeResiduY(True)
simulation.setComputeResiduR(True)
simulation.setNewtonMaxIteration(40)
simulation.setNewtonTolerance(1e-12)

N = int(round((T - t0) / h))
dataPlot = np.zeros((N, 5))
for row in dataPlot:
    simulation.advanceToEvent()
    row[:] = [simulation.nextTime(), *oscillator.x(), relay.y(0)[0], relay.lambda_(0)[0]]
    simulation.nextStep()
