"""Motions that dry friction ends, against their exact solutions."""

from math import cos, sin

import numpy as np
import pytest
import saltus.kernel as sk
from saltus.examples.dry_friction.dry_friction import (
    GRAVITY,
    MASS,
    MU,
    OFFSET,
    RADIUS,
    SPEED,
    TIME_STEP,
    ball,
    block,
    block_at_rest,
    oscillator,
    rolling,
    turning_points,
)

SECOND_ORDER = ["HalfExplicitTrapezoidalOSI", "HalfExplicitRungeKuttaOSI", "MoreauJeanOSI"]
SLOPE = 0.2  # [rad]
WEIGHT = MASS * GRAVITY


def run(system, scheme, until, time_step=TIME_STEP):
    return sk.TimeStepping(system, scheme, time_step).run(until)


def last_forces(trajectory):
    """λ of the last step, or what its impulse is over Δt: one of them is zero."""
    plane = trajectory["plane"]
    return plane.force[-1] + plane.impulse[-1] / trajectory.provenance.time_step


@pytest.mark.parametrize("scheme", SECOND_ORDER)
def test_a_block_stops_on_a_slope_and_is_held(scheme):
    stop, place = block_at_rest(SLOPE)
    trajectory = run(block(SLOPE), scheme, 3.0)
    assert trajectory.q[-1, 0] == pytest.approx(place, abs=1e-6)
    moving = trajectory.t < stop - TIME_STEP
    deceleration = GRAVITY * (MU * cos(SLOPE) - sin(SLOPE))
    exact = SPEED - deceleration * trajectory.t[moving]
    np.testing.assert_allclose(trajectory.v[moving, 0], exact, atol=1e-11)
    np.testing.assert_allclose(trajectory.v[trajectory.t > stop + TIME_STEP], 0.0, atol=1e-16)
    np.testing.assert_allclose(
        last_forces(trajectory), [WEIGHT * cos(SLOPE), -WEIGHT * sin(SLOPE)], rtol=1e-11
    )


@pytest.mark.parametrize("scheme", SECOND_ORDER)
def test_a_block_slides_on_if_friction_is_too_small(scheme):
    mu = 0.9 * np.tan(SLOPE)
    trajectory = run(block(SLOPE, mu), scheme, 1.0)
    acceleration = GRAVITY * (sin(SLOPE) - mu * cos(SLOPE))
    assert trajectory.v[-1, 0] == pytest.approx(SPEED + acceleration, rel=1e-12)
    assert trajectory.q[-1, 0] == pytest.approx(SPEED + acceleration / 2, rel=1e-12)
    with pytest.raises(ValueError, match=r"does not stop on a slope beyond 0\.18"):
        block_at_rest(SLOPE, mu)


@pytest.mark.parametrize("scheme", SECOND_ORDER)
def test_an_oscillator_turns_where_friction_lets_it(scheme):
    points = turning_points()
    assert [x / OFFSET for _, x in points] == pytest.approx([-5.5, 3.5, -1.5, -0.5])
    errors = []
    for time_step in (2e-3, 5e-4):
        trajectory = run(oscillator(), scheme, 2.0, time_step)
        found = np.interp([t for t, _ in points], trajectory.t, trajectory.q[:, 0])
        errors.append(np.abs(found - [x for _, x in points]).max() / OFFSET)
        assert not np.any(np.diff(trajectory.q[trajectory.t > points[-1][0] + 2 * time_step, 0]) > 1e-16)
    assert errors[0] < 2e-4
    assert errors[1] < errors[0] / 4  # second order, but for where the turns fall in a step
    spring = trajectory.q[-1, 0] * WEIGHT * MU / OFFSET
    np.testing.assert_allclose(last_forces(trajectory), [WEIGHT, spring], rtol=1e-11)


@pytest.mark.parametrize("scheme", SECOND_ORDER)
def test_a_ball_begins_to_roll(scheme):
    start, speed = rolling()
    trajectory = run(ball(), scheme, 0.5)
    assert trajectory.v[-1, 0] == pytest.approx(speed, rel=1e-11)
    contact_point = trajectory.v[:, 0] + RADIUS * trajectory.v[:, 2]
    sliding = trajectory.t < start - TIME_STEP
    exact = SPEED - 3.5 * MU * GRAVITY * trajectory.t[sliding]
    np.testing.assert_allclose(contact_point[sliding], exact, atol=1e-11)
    np.testing.assert_allclose(contact_point[trajectory.t > start + TIME_STEP], 0.0, atol=1e-12)
    np.testing.assert_allclose(last_forces(trajectory), [WEIGHT, 0.0], atol=1e-9)
    assert trajectory.energy[-1] / trajectory.energy[0] == pytest.approx(5 / 7, rel=1e-11)


@pytest.mark.parametrize("system", [block(SLOPE), oscillator(), ball()], ids=["block", "oscillator", "ball"])
def test_check_finds_nothing(system):
    assert system.check().ok
