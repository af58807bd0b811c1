"""A rectifier with a source that follows the time, an override, and a resistance that follows it as well."""

import numpy as np
import siconos.kernel as sk

t0, T, h = 0.0, 3.0, 2e-3


class Source(sk.FirstOrderLinearDS):
    def computeb(self, time):
        self.setbPtr([0.0, np.sin(4.0 * time)])

    def computeA(self, time):
        self.setAPtr([[-0.2, 1.0], [-1.0, -0.5 - 0.4 * np.cos(time)]])


circuit = Source([0.5, 0.0], -np.eye(2), [0.0, 0.0])
relation = sk.FirstOrderLinearTIR([[1.0, 0.0]], [[1.0], [0.0]])
relation.setDPtr([[0.3]])
relation.setePtr([-0.1])
diode = sk.Interaction(sk.ComplementarityConditionNSL(1), relation)
model = sk.NonSmoothDynamicalSystem(t0, T)
model.insertDynamicalSystem(circuit)
model.link(diode, circuit)
simulation = sk.TimeStepping(model, sk.TimeDiscretisation(t0, h), sk.EulerMoreauOSI(0.5, 0.75), sk.LCP())

N = int(round((T - t0) / h))
dataPlot = np.zeros((N, 5))
for row in dataPlot:
    simulation.computeOneStep()
    row[:] = [simulation.nextTime(), *circuit.x(), diode.y(0)[0], diode.lambda_(0)[0]]
    simulation.nextStep()
