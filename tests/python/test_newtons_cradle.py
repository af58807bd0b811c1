"""Newton's cradle: simultaneous impacts by their law, successive ones two balls at a time."""

import numpy as np
import pytest
import saltus.kernel as sk
from saltus.examples.newtons_cradle.newtons_cradle import AMPLITUDE, PERIOD, SPEED, build, together

SCHEMES = ["HalfExplicitTrapezoidalOSI", "HalfExplicitRungeKuttaOSI"]


def swing(scheme, time_step, periods, **cradle):
    return sk.TimeStepping(build(**cradle), scheme, time_step).run(periods * PERIOD)


def shares_after_impacts(run):
    """Of the momentum, a row for each impulsive step."""
    after = run.v[run.impulsive]
    return after / after.sum(axis=1, keepdims=True)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("restitution", [1.0, 0.5, 0.0])
@pytest.mark.parametrize("balls", [2, 3, 5])
def test_touching_balls_are_hit_at_once(balls, restitution, scheme):
    run = swing(scheme, 1e-4, 0.3, balls=balls, gap=0.0, restitution=restitution)
    [shares] = shares_after_impacts(run)
    np.testing.assert_allclose(shares, together(balls, restitution), rtol=0, atol=1e-14)
    [row] = np.flatnonzero(run.impulsive)
    assert 0 <= run.t[row] - PERIOD / 4 <= run.provenance.time_step
    assert run.v[row].sum() == pytest.approx(SPEED, rel=1e-6)
    # 1 − ε² of the energy of the relative motion is lost, of the first ball against the others as one body
    left = 1 - (1 - restitution**2) * (balls - 1) / balls
    assert run.energy[-1] / run.energy[0] == pytest.approx(left, abs=1e-6)


@pytest.mark.parametrize("balls", [3, 5])
def test_half_a_period_later_the_first_ball_goes_out_alone(balls):
    run = swing("HalfExplicitTrapezoidalOSI", 1e-4, 0.8, balls=balls, gap=0.0)
    back = np.flatnonzero(run.impulsive)[1]
    assert run.t[back] == pytest.approx(0.75 * PERIOD, abs=5e-4)
    np.testing.assert_allclose(run.v[back] / SPEED, [-1.0] + [0.0] * (balls - 1), atol=1e-5)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_with_gaps_the_last_ball_goes_out_alone(scheme):
    run = swing(scheme, 1e-5, 0.3, gap=1e-4)
    shares = shares_after_impacts(run)
    np.testing.assert_allclose(shares, np.eye(5)[1:], atol=1e-4)  # from one ball to the next
    assert np.diff(run.t[run.impulsive]) == pytest.approx(1e-4 / SPEED, abs=1e-5)  # the time to cross a gap


def test_with_losses_and_gaps_two_balls_hit_at_a_time():
    """Of three balls at ε = 1/2: contact 1, contact 2, contact 1 again, then each is slower than the next."""
    run = swing("HalfExplicitTrapezoidalOSI", 1e-6, 0.26, balls=3, gap=1e-5, restitution=0.5)
    expected, u = [], [1.0, 0.0, 0.0]
    for first in (0, 1, 0):
        mean, half = (u[first] + u[first + 1]) / 2, 0.5 * (u[first] - u[first + 1]) / 2
        u[first : first + 2] = [mean - half, mean + half]
        expected.append(list(u))
    np.testing.assert_allclose(shares_after_impacts(run), expected, atol=1e-5)


@pytest.mark.parametrize(
    ("gap", "restitution", "accuracy"), [(0.0, 0.8, 1e-9), (0.0, 0.0, 1e-9), (1e-4, 0.8, 1e-3)]
)
def test_in_the_end_all_swing_together(gap, restitution, accuracy):
    """With the momentum that they share, and 1/n of the energy."""
    run = swing("HalfExplicitTrapezoidalOSI", 1e-4, 60, gap=gap, restitution=restitution)
    assert run.energy[-1] / run.energy[0] == pytest.approx(1 / 5, rel=accuracy)
    np.testing.assert_allclose(run.q[-1] / AMPLITUDE, -1 / 5, atol=max(1e-6, 20 * gap))


def test_check_shapes_and_refusals():
    assert build().check().ok
    run = swing("HalfExplicitTrapezoidalOSI", 1e-4, 0.01, gap=0.0)
    centres = [shape.poses[0, 0] for shape in run.shapes if shape.kind == "Disc"]
    np.testing.assert_allclose(np.diff(centres)[1:], 0.02)  # they touch
    for wrong in ({"balls": 1}, {"gap": -1.0}):
        with pytest.raises(ValueError, match="expected at least 2 balls and a gap >= 0"):
            build(**wrong)
