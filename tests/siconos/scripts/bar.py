"""A bar of finite elements that hits a wall, with the forecast that is told by gamma."""

import numpy as np
import siconos.kernel as sk

N, E, AREA, DENSITY = 100, 210e9, 3.14e-4, 7800.0
element = 1.0 / N
stiffness = E * AREA / element * (2 * np.eye(N) - np.eye(N, k=1) - np.eye(N, k=-1))
mass = DENSITY * AREA * element / 6 * (4 * np.eye(N) + np.eye(N, k=1) + np.eye(N, k=-1))
for end in (0, -1):
    stiffness[end, end] /= 2
    mass[end, end] /= 2

t0, h = 1e-8, 2e-7
bar = sk.LagrangianLinearTIDS(np.full(N, 1e-5), np.full(N, -0.1), mass)
bar.setKPtr(stiffness)
bar.setFExtPtr(np.full(N, -9.81 * DENSITY * AREA * element))
law = sk.NewtonImpactNSL(0.0)
relation = sk.LagrangianLinearTIR(np.eye(1, N))
wall = sk.Interaction(law, relation)
model = sk.NonSmoothDynamicalSystem(t0, 4e-4)
model.insertDynamicalSystem(bar)
model.link(wall, bar)

integrator = sk.MoreauJeanOSI(1.0, 0.75)
steps = sk.TimeDiscretisation(t0, h)
problem = sk.LCP()
simulation = sk.TimeStepping(model, steps, integrator, problem)
rows = []
while simulation.hasNextEvent():
    simulation.computeOneStep()
    middle = N // 2
    rows.append(
        [
            simulation.nextTime(),
            bar.q()[0],
            bar.q()[middle],
            bar.velocity()[0],
            bar.velocity()[middle],
            bar.p(1)[0] / h,
            wall.lambda_(1)[0],
        ]
    )
    simulation.nextStep()
dataPlot = np.array(rows)
