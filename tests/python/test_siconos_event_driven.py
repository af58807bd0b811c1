"""Event-driven simulations of saltus.siconos.kernel against motions known in closed form."""

import numpy as np
import pytest
import saltus.kernel as native
import saltus.siconos.kernel as sk

G, H = 9.81, 1.0


def simulation(e, T, h=0.05, integrator=None):
    """A ball of 2 kg that falls from 1 m."""
    ball = sk.LagrangianLinearTIDS([H], [0.0], [[2.0]])
    ball.setFExtPtr([-2.0 * G])
    floor = sk.Interaction(sk.NewtonImpactNSL(e), sk.LagrangianLinearTIR([[1.0]]))
    model = sk.NonSmoothDynamicalSystem(0.0, T)
    model.insertDynamicalSystem(ball)
    model.link(floor, ball)
    driven = sk.EventDriven(model, sk.TimeDiscretisation(0.0, h))
    driven.insertIntegrator(integrator or sk.LsodarOSI())
    driven.insertNonSmoothProblem(sk.LCP(), sk.SICONOS_OSNSP_ED_IMPACT)
    driven.insertNonSmoothProblem(sk.LCP(), sk.SICONOS_OSNSP_ED_SMOOTH_ACC)
    return driven, ball, floor


def impacts(e, T):
    """Times of the impacts and speeds before them."""
    t, speed = np.sqrt(2 * H / G), np.sqrt(2 * G * H)
    while t <= T:
        yield t, speed
        speed *= e
        t += 2 * speed / G


def test_every_impact_is_an_event_with_two_sides():
    driven, ball, floor = simulation(0.8, 3.5)
    manager, found, ends = driven.eventsManager(), [], 0
    q, v, p, y = ball.q(), ball.velocity(), ball.p(1), floor.y(1)
    while driven.hasNextEvent():
        driven.advanceToEvent()
        event = manager.nextEvent()
        assert driven.nextTime() == event.getDoubleTimeOfEvent()
        before, gap_rate = v[0], y[0]
        driven.processEvents()
        assert driven.startingTime() == event.getDoubleTimeOfEvent()
        if event.getType() == sk.TD_EVENT:
            ends += 1
            assert driven.startingTime() == pytest.approx(0.05 * ends)
            assert p[0] == 0.0
            continue
        assert abs(q[0]) < 1e-12
        assert (gap_rate, y[0]) == (before, v[0])
        assert p[0] == floor.lambda_(1)[0] == pytest.approx(2.0 * (v[0] - before), rel=1e-12)
        assert v[0] == pytest.approx(-0.8 * before, rel=1e-12)
        found.append((driven.startingTime(), -before))
    assert ends == 70
    np.testing.assert_allclose(found, list(impacts(0.8, 3.5)), rtol=1e-11)


def test_bounces_end_and_the_floor_carries_the_weight():
    driven, ball, floor = simulation(0.3, 1.5)
    driven.run()
    rest = np.sqrt(2 * H / G) * (1.3 / 0.7)
    times = [t for t, speed in impacts(0.3, rest - 1e-9) if speed > 1e-6]
    assert driven.trajectory.t[-1] == pytest.approx(1.5)
    assert len(times) > 10
    assert (ball.velocity()[0], ball.q()[0]) == (0.0, pytest.approx(0.0, abs=1e-12))
    assert ball.p(2)[0] == floor.lambda_(2)[0] == pytest.approx(2.0 * G, rel=1e-12)


def test_an_integrator_that_locates_nothing_has_the_ends_of_steps_alone():
    driven, ball, _ = simulation(0.8, 0.5, integrator=sk.HalfExplicitTrapezoidalOSI())
    kinds = []
    while driven.hasNextEvent():
        driven.advanceToEvent()
        kinds.append(driven.eventsManager().nextEvent().getType())
        driven.processEvents()
    assert kinds == [sk.TD_EVENT] * 10
    assert ball.velocity()[0] > 0.0


def test_misuse_says_what_was_expected():
    driven, _, _ = simulation(0.8, 0.5)
    with pytest.raises(RuntimeError, match="expected advanceToEvent"):
        driven.processEvents()
    with pytest.raises(NotImplementedError, match="SICONOS_OSNSP_ED_IMPACT = 1 .* got 7"):
        driven.insertNonSmoothProblem(sk.LCP(), 7)
    with pytest.raises(TypeError, match="expected a NonSmoothDynamicalSystem and a TimeDiscretisation, got"):
        sk.EventDriven(1, 2)


def test_events_of_a_native_simulation():
    """Sizes of what an event has: a rod of two masses that drops on one of its ends."""
    rod = native.LagrangianLinearTIDS([1.0, 2.0], [0.0, 0.0], np.diag([1.0, 3.0]), None, None, [-G, -3 * G])
    system = native.NonSmoothDynamicalSystem([rod])
    floor = native.Interaction(native.NewtonImpactNSL(0.5), native.LagrangianLinearTIR([[1.0, 0.0]]))
    link = native.Interaction(
        native.EqualityConditionNSL(1), native.LagrangianLinearTIR([[-1.0, 1.0]], [-1.0])
    )
    system.link(floor, rod)
    system.link(link, rod)
    run = native.TimeStepping(system, native.EventDrivenOSI(), 0.5)
    run.step()
    (event,) = run.events
    speed = np.sqrt(2 * G)
    assert event.t == pytest.approx(np.sqrt(2 / G), rel=1e-12)
    np.testing.assert_allclose(event.v_before, -speed, rtol=1e-12)
    np.testing.assert_allclose(event.v, speed / 2, rtol=1e-12)
    np.testing.assert_allclose(event.velocities_before, [-speed, 0.0], atol=1e-12)
    np.testing.assert_allclose(event.impulse, [6 * speed, 4.5 * speed], rtol=1e-12)
    np.testing.assert_allclose(event.generalised_impulse, [1.5 * speed, 4.5 * speed], rtol=1e-12)
    np.testing.assert_allclose(event.gaps, 0.0, atol=1e-12)
    np.testing.assert_allclose(event.force, 0.0, atol=1e-12)
    run.step()
    assert [event.t for event in run.events] == pytest.approx([2 * np.sqrt(2 / G)], rel=1e-12)
