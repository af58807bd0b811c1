"""An oscillating circuit whose bridge of four ideal diodes feeds a resistor."""

import numpy as np
import siconos.kernel as sk

t0, T, h = 0.0, 2e-3, 2e-6
L, capacitance, R, voltage = 1e-2, 1e-6, 1e3, 10.0

circuit = sk.FirstOrderLinearDS([voltage, 0.0], [[0.0, -1.0 / capacitance], [1.0 / L, 0.0]])
C = [[0.0, 0.0], [0.0, 0.0], [-1.0, 0.0], [1.0, 0.0]]
B = [[0.0, 0.0, -1.0 / capacitance, 1.0 / capacitance], [0.0, 0.0, 0.0, 0.0]]
bridge = sk.FirstOrderLinearTIR(C, B)
bridge.setDPtr(
    [[1 / R, 1 / R, -1.0, 0.0], [1 / R, 1 / R, 0.0, -1.0], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]]
)
diodes = sk.Interaction(sk.ComplementarityConditionNSL(4), bridge)
model = sk.NonSmoothDynamicalSystem(t0, T)
model.setTitle("diode bridge")
model.insertDynamicalSystem(circuit)
model.link(diodes, circuit)
simulation = sk.TimeStepping(model, sk.TimeDiscretisation(t0, h), sk.EulerMoreauOSI(0.5), sk.LCP())

N = int(round((T - t0) / h))
dataPlot = np.zeros((N, 12))
x, r, y, lam = circuit.x(), circuit.r(), diodes.y(0), diodes.lambda_(0)
for row in dataPlot:
    simulation.computeOneStep()
    row[0] = simulation.nextTime()
    row[1:3] = x
    row[3] = r[0]
    row[4:8] = y
    row[8:12] = lam
    simulation.nextStep()
