"""A third-order system under a relay: it ends in an oscillation."""

import numpy as np
import siconos.kernel as sk

t0, T, h = 0.0, 20.0, 1e-2

process = sk.FirstOrderLinearDS([0.0, 0.7, 0.0], [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, -3.0, -2.0]])
relay = sk.Interaction(sk.RelayNSL(1), sk.FirstOrderLinearTIR([[1.0, 0.0, 0.0]], [[0.0], [0.0], [1.0]]))
model = sk.NonSmoothDynamicalSystem(t0, T)
model.insertDynamicalSystem(process)
model.link(relay, process)
simulation = sk.TimeStepping(model, sk.TimeDiscretisation(t0, h))
simulation.insertIntegrator(sk.EulerMoreauOSI(0.5))
simulation.insertNonSmoothProblem(sk.Relay())

N = int(round((T - t0) / h))
dataPlot = np.zeros((N, 6))
for row in dataPlot:
    simulation.computeOneStep()
    row[0] = simulation.nextTime()
    row[1:4] = process.x()
    row[4] = relay.y(0)[0]
    row[5] = relay.lambda_(0)[0]
    simulation.nextStep()
