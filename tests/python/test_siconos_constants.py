"""What a simulation has taken as a constant cannot be set any more: it would change nothing, silently."""

import numpy as np
import pytest
import saltus.siconos.kernel as sk


def mechanics(system=None):
    ball = system or sk.LagrangianLinearTIDS([1.0], [0.0], [[1.0]])
    relation = sk.LagrangianLinearTIR([[1.0]])
    floor = sk.Interaction(sk.NewtonImpactNSL(0.5), relation)
    model = sk.NonSmoothDynamicalSystem(0, 1)
    model.insertDynamicalSystem(ball)
    model.link(floor, ball)
    steps = sk.TimeDiscretisation(0, 0.1)
    simulation = sk.TimeStepping(model, steps, sk.MoreauJeanOSI(0.5), sk.LCP())
    return ball, relation, floor, model, simulation


def refused(name, *arguments):
    with pytest.raises(NotImplementedError, match="constant once the simulation is made"):
        name(*arguments)


def test_terms_of_a_mechanical_model_that_are_set_after_the_first_step_are_refused():
    ball, relation, _, model, simulation = mechanics()
    ball.setFExtPtr([-1.0])
    simulation.computeOneStep()
    for setter in (ball.setFExtPtr, ball.setFIntPtr, ball.setFGyrPtr):
        refused(setter, [2.0])
    for setter in (ball.setMassPtr, ball.setKPtr, ball.setCPtr, relation.setJachqPtr):
        refused(setter, [[2.0]])
    refused(ball.setBoundaryConditions, sk.FixedBC([0]))
    refused(model.insertDynamicalSystem, sk.LagrangianLinearTIDS([1.0], [0.0], [[1.0]]))
    refused(model.link, sk.Interaction(sk.NewtonImpactNSL(0), sk.LagrangianLinearTIR([[1.0]])), ball)
    refused(simulation.insertIntegrator, sk.MoreauJeanOSI(1.0))
    refused(simulation.insertNonSmoothProblem, sk.LCP())


def test_overrides_set_their_terms_in_every_step():
    class Pushed(sk.LagrangianLinearTIDS):
        def computeFExt(self, time):
            self.setFExtPtr([2.0])

    ball, _, _, _, simulation = mechanics(Pushed([1.0], [0.0], [[1.0]]))
    simulation.run()
    assert ball.velocity()[0] == pytest.approx(2.0)


def test_terms_of_a_first_order_model_that_are_set_after_the_first_step_are_refused():
    ds = sk.FirstOrderLinearDS([1.0], [[-1.0]])
    relation = sk.FirstOrderLinearTIR([[1.0]], [[1.0]])
    model = sk.NonSmoothDynamicalSystem(0, 1)
    model.insertDynamicalSystem(ds)
    model.link(sk.Interaction(sk.RelayNSL(1), relation), ds)
    steps = sk.TimeDiscretisation(0, 0.1)
    sk.TimeStepping(model, steps, sk.EulerMoreauOSI(0.5), sk.Relay()).computeOneStep()
    for setter in (ds.setAPtr, ds.setMPtr, relation.setCPtr, relation.setDPtr, relation.setBPtr):
        refused(setter, [[2.0]])
    refused(ds.setbPtr, [2.0])
    refused(relation.setePtr, [2.0])


def test_what_is_inserted_or_linked_twice_is_there_once():
    ball, _, floor, model, _ = mechanics()
    model.insertDynamicalSystem(ball)
    model.link(floor, ball)
    assert (model.getNumberOfDS(), model.getNumberOfInteractions()) == (1, 1)
    other = sk.LagrangianLinearTIDS([1.0], [0.0], [[1.0]])
    model.insertDynamicalSystem(other)
    with pytest.raises(ValueError, match="not linked to other systems"):
        model.link(floor, other)


@pytest.mark.parametrize("h", [0.0, -1e-3, np.nan, np.inf])
def test_steps_are_positive(h):
    with pytest.raises(ValueError, match="h must be positive and finite"):
        sk.TimeDiscretisation(0, h)
