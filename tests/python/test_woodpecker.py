"""The woodpecker: the one-dimensional map and its fixed point; runs against the limit cycle; energy."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest
import saltus.kernel as sk
from saltus.examples.woodpecker.phases import PHASES, Event, limit_cycle, period, take
from saltus.examples.woodpecker.woodpecker import (
    CONTACTS,
    GRAVITY,
    HALF_SLEEVE,
    MU,
    PLAY,
    SCHEME,
    WEIGHT,
    K,
    M,
    build,
    sliding_angle,
)

MOREAU_JEAN = "MoreauJeanOSI"


@cache
def cycle():
    return limit_cycle()


@cache
def run(scheme, time_step, periods=4):
    until = (periods + 0.5) * cycle().period
    return sk.TimeStepping(build(cycle().rate), scheme, time_step).run(until)


def pecks(trajectory):
    return np.flatnonzero(trajectory["beak"].impulse[:, 0] > 0)


def test_the_jammed_edge_slides_at_one_angle():
    """There the three equations with q̈ = (0, 0, α) have λ_T = μ λ_N."""
    q = np.array([0.0, -PLAY / HALF_SLEEVE, sliding_angle()])
    lower = CONTACTS["lower"]
    columns = np.column_stack([M[:, 2], -np.array(lower.normal), -np.array(lower.tangent)])
    _, normal, tangential = np.linalg.solve(columns, WEIGHT - K @ q)
    assert normal > 0
    assert tangential == pytest.approx(MU * normal, rel=1e-12)


def test_the_limit_cycle_is_a_fixed_point_and_stable():
    known = cycle()
    [*_, end] = period(known.rate)
    assert end.v[2] == pytest.approx(known.rate, rel=1e-9)
    assert known.slope == pytest.approx(-0.84, abs=0.01)
    assert known.period == pytest.approx(0.14598, abs=1e-5)
    assert known.drop == pytest.approx(19.445e-3, abs=1e-6)
    assert end.v == pytest.approx([0.0, 0.0, known.rate], abs=1e-8)
    assert len(PHASES) == len(known.events)


def test_the_published_state_is_near_the_cycle():
    """The initial values in use since Glocker's thesis, while the lower edge slides."""
    now = Event(0.0, np.array([0.0, -PLAY / HALF_SLEEVE, -0.2788]), np.array([-0.3411, 0.0, -7.4583]), 0.0)
    for phase in PHASES[-2:]:
        now = take(phase, now)
    assert now.v[2] == pytest.approx(cycle().rate, rel=2.5e-3)


def test_the_map_shrinks_deviations():
    """Alternating, by the slope."""
    rates = [cycle().rate + 0.05]
    for _ in range(5):
        rates.append(period(rates[-1])[-1].v[2])
    deviations = np.array(rates) - cycle().rate
    assert (deviations[:-1] * deviations[1:] < 0).all()
    assert np.abs(deviations[-1]) < np.abs(deviations[0])
    np.testing.assert_allclose(deviations[1:] / deviations[:-1], cycle().slope, rtol=0.1)


@pytest.mark.parametrize(
    ("scheme", "steps"), [(SCHEME, 4), ("HalfExplicitTrapezoidalOSI", 12), (MOREAU_JEAN, 25)]
)
def test_runs_stay_on_the_cycle(scheme, steps):
    """Times of the pecks within so many steps, impulses and drops in proportion."""
    for time_step in (1e-4, 2e-5):
        trajectory = run(scheme, time_step)
        found = pecks(trajectory)
        exact = cycle().events[2].t + cycle().period * np.arange(5)
        np.testing.assert_allclose(trajectory.t[found], exact, atol=steps * time_step)
        beak = trajectory["beak"].impulse[found]
        np.testing.assert_allclose(beak[:, 0], cycle().events[2].impulse, rtol=50 * steps * time_step)
        np.testing.assert_allclose(beak[:, 1], -MU * beak[:, 0], rtol=1e-10)
        drops = -np.diff(trajectory.q[found, 0])
        np.testing.assert_allclose(drops, cycle().drop, atol=0.8 * steps * time_step)


def test_impacts_come_in_the_order_of_the_phases():
    trajectory = run(SCHEME, 1e-5, periods=1)
    until = trajectory.t < cycle().period
    for name, phases in (("beak", [2]), ("upper", [1, 3]), ("lower", [5, 6])):
        found = np.flatnonzero((trajectory[name].impulse[:, 0] > 0) & until)
        assert trajectory.t[found] == pytest.approx([cycle().events[k].t for k in phases], abs=2e-5)
        impulses = [cycle().events[k].impulse for k in phases]
        assert trajectory[name].impulse[found, 0] == pytest.approx(impulses, rel=2e-3, abs=2e-7)
    end = np.searchsorted(trajectory.t, cycle().period)
    assert trajectory.v[end, 2] == pytest.approx(cycle().rate, rel=1e-3)


@pytest.mark.parametrize("scheme", [SCHEME, MOREAU_JEAN])
def test_friction_and_impacts_take_what_the_weight_gives(scheme):
    trajectory = run(scheme, 2e-5)
    works = trajectory.work_forces + trajectory.work_lambda + trajectory.work_impulse
    change = np.diff(trajectory.kinetic_energy)
    np.testing.assert_allclose(change, works[1:], rtol=0, atol=1e-13)  # of 1e-4 J
    assert (trajectory.work_lambda + trajectory.work_impulse).max() < 1e-15
    for first, last in pairwise(pecks(trajectory)):
        rows = slice(first + 1, last + 1)
        lost = (trajectory.work_lambda + trajectory.work_impulse)[rows].sum()
        drop = trajectory.q[first, 0] - trajectory.q[last, 0]
        assert -lost == pytest.approx(M[0, 0] * GRAVITY * drop, rel=2e-3)


def test_while_it_jams_the_sleeve_does_not_move():
    trajectory = run(SCHEME, 2e-5)
    stuck, slides = cycle().events[7].t, cycle().period
    rows = (trajectory.t > stuck + 1e-4) & (trajectory.t < slides - 1e-4)
    np.testing.assert_allclose(trajectory.v[rows, :2], 0.0, atol=1e-12)
    lower = trajectory["lower"].force[rows]
    assert (np.abs(lower[:, 1]) < MU * lower[:, 0]).all()


def test_the_system():
    assert build().check().ok
