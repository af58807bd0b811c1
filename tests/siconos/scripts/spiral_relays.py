"""Two relays with crossed feedback: the state spirals into the origin in finite time, and stays."""

import numpy as np
import siconos.kernel as sk

t0, T, h, mixing = 0.0, 4.0, 1e-3, 0.2

process = sk.FirstOrderLinearDS([1.0, 1.0], np.zeros((2, 2)))
B = 2.0 * np.array([[mixing, 1.0 - mixing], [-(1.0 - mixing), mixing]])
relation = sk.FirstOrderLinearTIR(np.eye(2), B)
relation.setDPtr(np.zeros((2, 2)))
law = sk.RelayNSL(2, -1.5, 1.0)
law.display()
relays = sk.Interaction(law, relation)
model = sk.NonSmoothDynamicalSystem(t0, T)
model.insertDynamicalSystem(process)
model.link(relays, process)
simulation = sk.TimeStepping(model, sk.TimeDiscretisation(t0, h), sk.EulerMoreauOSI(1.0), sk.Relay())

N = int(round((T - t0) / h))
dataPlot = np.zeros((N + 1, 7))
dataPlot[0] = [t0, *process.x(), *relays.lambda_(0), *relays.y(0)]
k = 1
while simulation.hasNextEvent():
    simulation.computeOneStep()
    dataPlot[k] = [simulation.nextTime(), *process.x(), *relays.lambda_(0), *relays.y(0)]
    k += 1
    simulation.nextStep()
