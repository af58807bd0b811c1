"""A ball between its impacts, by an event-driven simulation: every event with the state on both sides."""

import numpy as np
import siconos.kernel as sk

ball = sk.LagrangianLinearTIDS([1.0, 0.2], [0.0, 0.5], [[2.0, 0.0], [0.0, 1.0]])
ball.setFExtPtr([-2.0 * 9.81, 0.0])
law = sk.NewtonImpactNSL(0.8)
relation = sk.LagrangianLinearTIR([[1.0, 0.0]])
floor = sk.Interaction(law, relation)
model = sk.NonSmoothDynamicalSystem(0.0, 3.0)
model.insertDynamicalSystem(ball)
model.link(floor, ball)

integrator = sk.LsodarOSI()
steps = sk.TimeDiscretisation(0.0, 0.05)
impact, acceleration = sk.LCP(), sk.LCP()
simulation = sk.EventDriven(model, steps)
simulation.insertIntegrator(integrator)
simulation.insertNonSmoothProblem(impact, sk.SICONOS_OSNSP_ED_IMPACT)
simulation.insertNonSmoothProblem(acceleration, sk.SICONOS_OSNSP_ED_SMOOTH_ACC)
simulation.initialize()
manager = simulation.eventsManager()

rows = []
while simulation.hasNextEvent():
    simulation.advanceToEvent()
    kind = manager.nextEvent().getType()
    before = ball.velocity()[0]
    simulation.processEvents()
    rows.append(
        [
            simulation.startingTime(),
            kind,
            before,
            ball.velocity()[0],
            ball.q()[1],
            ball.p(1)[0],
            floor.lambda_(1)[0],
            floor.y(1)[0],
        ]
    )
dataPlot = np.array(rows)
