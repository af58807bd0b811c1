"""A block on a spring that dry friction on the floor brings to rest."""

import numpy as np
import siconos.kernel as sk
import siconos.numerics as sn

mass, stiffness, gravity, mu, x0 = 1.0, 25.0, 10.0, 0.15, 1.0
t0, T, h = 0.0, 3.0, 1e-3

K = np.zeros((2, 2))
K[0, 0] = stiffness
block = sk.LagrangianLinearTIDS([x0, 0.0], [0.0, 0.0], mass * np.eye(2))
block.setKPtr(K)
block.setFExtPtr([0.0, -mass * gravity])

floor = sk.Interaction(
    sk.NewtonImpactFrictionNSL(0.0, 0.0, mu, 2), sk.LagrangianLinearTIR([[0.0, 1.0], [1.0, 0.0]])
)
model = sk.NonSmoothDynamicalSystem(t0, T)
model.insertDynamicalSystem(block)
model.link(floor, block)

contact = sk.FrictionContact(2, sn.SICONOS_FRICTION_2D_NSGS)
contact.numericsSolverOptions().iparam[sn.SICONOS_IPARAM_MAX_ITER] = 1000
contact.numericsSolverOptions().dparam[sn.SICONOS_DPARAM_TOL] = 1e-13
simulation = sk.TimeStepping(model, sk.TimeDiscretisation(t0, h))
simulation.insertIntegrator(sk.MoreauJeanOSI(0.5))
simulation.insertNonSmoothProblem(contact)

dataPlot = np.zeros((int(round((T - t0) / h)) + 1, 5))
dataPlot[0, 1] = x0
for k in range(1, len(dataPlot)):
    simulation.computeOneStep()
    impulse = floor.lambda_(1)
    dataPlot[k] = [simulation.nextTime(), block.q()[0], block.velocity()[0], impulse[0], impulse[1]]
    simulation.nextStep()
