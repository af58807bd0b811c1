"""The rocking block: its fall, the change of corners, the turns, the end and when it tips over."""

from math import cos, hypot, pi, sin

import numpy as np
import pytest
import saltus.kernel as sk
from saltus.examples.rocking_block.rocking_block import SCHEME, TILT, Block, build, exact
from scipy.integrate import solve_ivp

BLOCK = Block()


def run(scheme=SCHEME, time_step=1e-3, until=0.3, **what):
    return sk.TimeStepping(build(**what), scheme, time_step).run(until)


def test_the_elliptic_integral_is_the_time_of_the_inverted_pendulum():
    def upright(_t, y):
        return BLOCK.a - y[0]

    upright.terminal = True
    solution = solve_ivp(
        lambda t, y: [y[1], BLOCK.p**2 * sin(y[0])],
        (0, 2),
        [BLOCK.a - TILT, 0.0],
        "DOP853",
        events=upright,
        rtol=1e-12,
        atol=1e-13,
    )
    assert solution.t[-1] == pytest.approx(BLOCK.fall(TILT), rel=1e-10)
    assert solution.y[1, -1] == pytest.approx(BLOCK.rate(TILT), rel=1e-10)
    slender = Block(0.001, 0.2)
    assert slender.fall(0.6 * slender.a) == pytest.approx(slender.housner_fall(0.6 * slender.a), rel=1e-5)


def test_turns_keep_the_angular_momentum_about_the_new_corner():
    radius = hypot(BLOCK.b, BLOCK.h)
    about_centre = radius**2 / 3
    before = about_centre + BLOCK.h**2 - BLOCK.b**2
    assert before / (about_centre + radius**2) == pytest.approx(BLOCK.ratio, rel=1e-14)
    tilt = BLOCK.next_turn(TILT)
    assert BLOCK.rate(tilt) == pytest.approx(BLOCK.ratio * BLOCK.rate(TILT), rel=1e-12)


def test_it_falls_as_the_pendulum_does():
    errors = []
    for time_step in (2e-3, 5e-4):
        trajectory = run(time_step=time_step, until=0.2)
        tilt = -trajectory.q[:, 2]
        rate = BLOCK.p * np.sqrt(2 * np.maximum(0, np.cos(BLOCK.a - TILT) - np.cos(BLOCK.a - tilt)))
        errors.append(np.abs(trajectory.v[:, 2] - rate).max())
        assert np.abs(trajectory["right"].gap).max() < 1e-13
        assert not trajectory.impulsive.any()
    assert errors[0] < 1e-4
    assert np.log(errors[0] / errors[1]) / np.log(4) == pytest.approx(2, abs=0.15)


def first_impact(block, mu):
    """One step in which a block that turns at 1 rad/s about its right corner comes down on the left one."""
    system = build(tilt=1e-10, rate=-1.0, mu=mu, block=block)
    return sk.TimeStepping(system, SCHEME, 1e-9).run(1e-9)


@pytest.mark.parametrize("size", [(0.1, 0.2), (0.1, 0.1), (0.2, 0.15)])
def test_the_change_of_corners_is_housners(size):
    block = Block(*size)
    trajectory = first_impact(block, mu=1.001 * block.impact_friction)
    left, right = trajectory["left"].impulse[-1], trajectory["right"].impulse[-1]
    assert trajectory.v[-1, 2] == pytest.approx(block.ratio, abs=1e-7)  # gravity has acted for 1e-9 s
    assert abs(left[1] / left[0]) == pytest.approx(block.impact_friction, rel=1e-7)
    np.testing.assert_array_equal(right, 0.0)
    slipping = first_impact(block, mu=0.999 * block.impact_friction)
    velocity = slipping.v[-1, 0] + block.h * slipping.v[-1, 2]  # of the new corner
    assert velocity < -1e-4
    assert slipping.v[-1, 2] < block.ratio - 1e-4


@pytest.mark.parametrize("size", [(0.1415, 0.1), (0.3, 0.2)])
def test_a_wide_block_stops_at_once(size):
    block = Block(*size)  # b > √2 h
    assert block.ratio == 0.0
    trajectory = first_impact(block, mu=1.0)
    np.testing.assert_allclose(trajectory.v[-1], 0.0, atol=1e-15)
    assert trajectory["left"].impulse[-1, 0] > 0
    assert trajectory["right"].impulse[-1, 0] > 0


def test_it_rocks_to_rest_in_time():
    known = exact(BLOCK)
    errors = []
    for time_step in (1e-3, 2.5e-4):
        trajectory = run(time_step=time_step, until=1.2)
        found = np.flatnonzero(np.diff(np.sign(trajectory.q[:, 2])))[:4]  # it is upright
        assert trajectory.t[found] == pytest.approx(known.impacts[:4], abs=1.5 * time_step)
        pairs = zip(found, [*found[1:], len(trajectory) - 1], strict=True)
        tilts = [np.abs(trajectory.q[first + 1 : last, 2]).max() for first, last in pairs]
        errors.append(np.abs(np.array(tilts) - known.tilts[:4]).max())
        moving = np.flatnonzero(np.abs(trajectory.v).max(axis=1) > 1e-9)[-1]
        assert trajectory.t[moving] == pytest.approx(known.end, abs=8 * time_step)
    assert errors[0] < 4e-4
    assert errors[1] < 0.3 * errors[0]  # Δt at the changes of corners
    assert trajectory.closed[-1] == 2
    forces = sum(trajectory[name].force[-1] for name in ("left", "right"))
    np.testing.assert_allclose(forces, [2.0 * 9.81, 0.0], atol=1e-10)


@pytest.mark.parametrize(("factor", "falls"), [(0.995, False), (1.005, True)])
def test_it_tips_over_from_a_certain_rate_on(factor, falls):
    trajectory = run(tilt=0.0, rate=factor * BLOCK.tipping_rate, until=1.2)
    tilt = -trajectory.q[:, 2]
    assert (tilt.max() > BLOCK.a) == falls
    if not falls:  # ½ θ̇² = p² (1 − cos a) at the limit: it turns where the energy says
        top = BLOCK.a - np.arccos(cos(BLOCK.a) + (factor * BLOCK.tipping_rate / BLOCK.p) ** 2 / 2)
        assert tilt.max() == pytest.approx(top, abs=1e-4)


def test_checks_and_refusals():
    assert build().check().ok
    with pytest.raises(ValueError, match=r"tilt must be in \[0, pi/2\), got -0\.1"):
        build(tilt=-0.1)
    assert BLOCK.housner_fall(TILT) < BLOCK.fall(TILT) < pi
