"""The ball on a string and on a rod: forces on the circle, when it goes slack, the jerk."""

from math import cos

import numpy as np
import pytest
import saltus.kernel as sk
from saltus.examples.ball_on_string.ball_on_string import (
    GRAVITY,
    LENGTH,
    MASS,
    SPEED,
    build,
    jerk,
    slack,
    tension,
)
from scipy.integrate import quad

SECOND_ORDER = ["HalfExplicitTrapezoidalOSI", "HalfExplicitRungeKuttaOSI(activity=sticky)"]


def run(scheme, time_step, until, link="string"):
    return sk.TimeStepping(build(link), scheme, time_step).run(until)


def test_the_angle_and_the_elliptic_integral():
    start, alpha = slack()
    assert cos(alpha) == pytest.approx(0.8, rel=1e-14)
    assert tension(LENGTH * cos(alpha)) == pytest.approx(0, abs=1e-12)
    time, _ = quad(
        lambda psi: LENGTH / np.sqrt(SPEED**2 - 2 * GRAVITY * LENGTH * (1 - cos(psi))), 0, np.pi - alpha
    )
    assert time == pytest.approx(start, rel=1e-12)


def test_the_parabola_ends_on_the_circle_at_three_times_the_angle():
    (start, alpha), end = slack(), jerk()
    speed, flight = np.sqrt(GRAVITY * LENGTH * np.cos(alpha)), end.t - start
    x = LENGTH * np.sin(alpha) - speed * np.cos(alpha) * flight
    y = LENGTH * np.cos(alpha) + speed * np.sin(alpha) * flight - GRAVITY * flight**2 / 2
    assert (x, y) == pytest.approx((-LENGTH * np.sin(end.angle), LENGTH * np.cos(end.angle)), rel=1e-12)
    kept = SPEED**2 - 2 * GRAVITY * (y + LENGTH)
    assert (end.impulse / MASS) ** 2 + end.speed**2 == pytest.approx(kept, rel=1e-12)


@pytest.mark.parametrize("scheme", SECOND_ORDER)
def test_the_taut_string_pulls_as_the_circle_demands(scheme):
    errors = []
    for time_step in (1e-3, 1e-4):
        trajectory = run(scheme, time_step, slack()[0] - time_step)
        force = trajectory["string"].force[1:, 0]
        height = (trajectory.q[1:, 1] + trajectory.q[:-1, 1]) / 2
        errors.append(np.abs(force - tension(height)).max())
        assert not trajectory.impulsive.any()
    assert errors[0] < 5e-4
    assert np.log10(errors[0] / errors[1]) == pytest.approx(2, abs=0.1)


@pytest.mark.parametrize("scheme", SECOND_ORDER)
def test_it_goes_slack_and_taut_in_time(scheme):
    end, time_step = jerk(), 1e-4
    trajectory = run(scheme, time_step, 1.3)
    string = trajectory["string"]
    loose = np.flatnonzero(string.force[1:, 0] <= 0)[0]
    assert trajectory.t[loose] == pytest.approx(slack()[0], abs=time_step)
    [hit] = np.flatnonzero(trajectory.impulsive)
    assert end.t <= trajectory.t[hit] < end.t + 2 * time_step
    assert (string.force[loose + 1 : hit] == 0).all()
    x, y = trajectory.q[hit]
    assert np.arctan2(-x, y) == pytest.approx(end.angle, abs=4 * time_step)
    assert string.impulse[hit, 0] == pytest.approx(end.impulse, rel=1e-3)
    assert np.hypot(*trajectory.v[hit]) == pytest.approx(end.speed, rel=1e-3)
    assert trajectory.work_impulse[hit] == pytest.approx(-(end.impulse**2) / (2 * MASS), rel=2e-3)
    assert (string.force[hit + 1 :, 0] > 0).all()  # it stays taut


def test_without_memory_the_runge_kutta_scheme_loses_the_string_at_once():
    assert run("HalfExplicitRungeKuttaOSI", 1e-3, 0.01).impulsive[2]


@pytest.mark.parametrize("scheme", SECOND_ORDER)
def test_a_rod_pushes_near_the_top(scheme):
    trajectory = run(scheme, 1e-3, 2.0, link="rod")
    force = trajectory["rod"].force[1:, 0]
    assert force.min() == pytest.approx(tension(LENGTH), abs=5e-4)
    assert force.min() < 0
    assert force.max() == pytest.approx(tension(-LENGTH), abs=5e-4)
    assert np.abs(trajectory["rod"].gap).max() < 1e-6
    np.testing.assert_allclose(trajectory.energy, trajectory.energy[0], rtol=2e-5)
    assert not trajectory.impulsive.any()


def test_checks_and_refusals():
    for link in ("string", "rod"):
        assert build(link).check().ok
    with pytest.raises(ValueError, match="link must be string or rod, got 'spring'"):
        build("spring")
