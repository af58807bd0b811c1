"""A bridge of diodes between an oscillating circuit and a capacitor with a load: two systems, and gamma."""

import numpy as np
import siconos.kernel as sk

t0, T, h = 0.0, 2e-3, 2e-6
L, capacitance, R, filtering = 1e-2, 1e-6, 1e3, 3e-7

source = sk.FirstOrderLinearTIDS([10.0, 0.0], [[0.0, -1.0 / capacitance], [1.0 / L, 0.0]])
load = sk.FirstOrderLinearTIDS([0.0], [[-1.0 / (R * filtering)]])
C = [[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [-1.0, 0.0, 1.0], [1.0, 0.0, 0.0]]
D = [[0.0, -1.0, 0.0, 0.0], [1.0, 0.0, 1.0, -1.0], [0.0, -1.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]]
B = [
    [0.0, 0.0, -1.0 / capacitance, 1.0 / capacitance],
    [0.0, 0.0, 0.0, 0.0],
    [1.0 / filtering, 0.0, 1.0 / filtering, 0.0],
]
relation = sk.FirstOrderLinearTIR(C, B)
relation.setDPtr(D)
diodes = sk.Interaction(sk.ComplementarityConditionNSL(4), relation)
model = sk.NonSmoothDynamicalSystem(t0, T)
model.insertDynamicalSystem(source)
model.insertDynamicalSystem(load)
model.link(diodes, source, load)
osi = sk.EulerMoreauOSI(0.5, 0.5)
osi.setUseGammaForRelation(True)
simulation = sk.TimeStepping(model, sk.TimeDiscretisation(t0, h), osi, sk.LCP())

N = int(round((T - t0) / h))
dataPlot = np.zeros((N, 8))  # of y and lambda what is determined while all diodes block
for row in dataPlot:
    simulation.computeOneStep()
    row[0] = simulation.nextTime()
    row[1:3] = source.x()
    row[3] = load.x()[0]
    row[4] = source.r()[0]
    row[5] = load.r()[0]
    row[6] = diodes.lambda_(0)[2]
    row[7] = diodes.y(0)[1]
    simulation.nextStep()
