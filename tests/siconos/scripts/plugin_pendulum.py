"""Two masses on springs in a circle; forces and distance are functions of the library pendulum_plugin."""

import numpy as np
import siconos.kernel as sk

ds = sk.LagrangianDS([1.0, 0.2], [0.0, 0.5], [[2.0, 0.3], [0.3, 1.0]])
ds.setComputeFIntFunction("pendulum_plugin", "internal_force")
ds.setComputeFExtFunction("pendulum_plugin.so", "external_force")
relation = sk.LagrangianScleronomousR("pendulum_plugin:distance", "pendulum_plugin:gradient")
contact = sk.Interaction(sk.NewtonImpactNSL(0.5), relation)
model = sk.NonSmoothDynamicalSystem(0.0, 2.0)
model.insertDynamicalSystem(ds)
model.link(contact, ds)
simulation = sk.TimeStepping(model, sk.TimeDiscretisation(0.0, 1e-3), sk.MoreauJeanOSI(0.5), sk.LCP())
simulation.setNewtonTolerance(1e-12)
rows = [[0.0, *ds.q(), *ds.velocity(), 0.0]]
while simulation.hasNextEvent():
    simulation.computeOneStep()
    rows.append([simulation.nextTime(), *ds.q(), *ds.velocity(), contact.lambda_(1)[0]])
    simulation.nextStep()
dataPlot = np.array(rows)
