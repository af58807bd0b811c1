"""Three states, one held by an equality and two by complementarity: a mixed problem."""

import numpy as np
import siconos.kernel as sk

t0, T, h = 0.0, 4.0, 5e-3

system = sk.FirstOrderLinearDS(
    [0.2, -1.0, 0.5], [[-1.0, 0.2, 0.0], [0.0, -2.0, 0.3], [0.1, 0.0, -0.5]], [0.5, -0.5, -0.3]
)
relation = sk.FirstOrderLinearTIR(np.eye(3), np.eye(3))
relation.setDPtr(np.diag([0.0, 0.1, 0.0]))
relation.setePtr([-0.2, 0.1, -0.25])
law = sk.MixedComplementarityConditionNSL(2, 1)
interaction = sk.Interaction(law, relation)
model = sk.NonSmoothDynamicalSystem(t0, T)
model.insertDynamicalSystem(system)
model.link(interaction, system)
discretisation, osi, problem = sk.TimeDiscretisation(t0, h), sk.EulerMoreauOSI(0.5, 1.0), sk.MLCP()
simulation = sk.TimeStepping(model, discretisation, osi, problem)

N = int(round((T - t0) / h))
dataPlot = np.zeros((N, 8))
for row in dataPlot:
    simulation.computeOneStep()
    row[0] = simulation.nextTime()
    row[1:4] = system.x()
    row[4:7] = interaction.lambda_(0)
    row[7] = interaction.y(0)[2]
    simulation.nextStep()
