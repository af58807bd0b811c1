"""States of contacts over time, against motions whose phases are known."""

from dataclasses import replace

import h5py
import numpy as np
import pytest
import saltus.kernel as sk
from saltus.examples.bouncing_ball import bouncing_ball
from saltus.examples.disc_pile import disc_pile
from saltus.examples.dry_friction import dry_friction
from saltus.examples.slider_crank import slider_crank
from saltus.io import ContactLaw, ContactState, Trajectory, read_hdf5
from saltus.io.records import Loaded
from test_models import Circle, ball

OPEN, CLOSED, STICK, SLIP, IMPACT, HELD = ContactState
TOLD_APART = ["HalfExplicitTrapezoidalOSI", "DMinusAccelerationOSI", "AdaptiveHalfExplicitOSI"]
MOREAU = ["MoreauJeanOSI", "ExplicitMoreauJeanOSI"]


def phases(states):
    """The states one after the other, without repetition."""
    changes = np.flatnonzero(np.diff(states)) + 1
    return [ContactState(int(states[k])) for k in (0, *changes)]


def bounces(until):
    """Exact times of the bounces of `bouncing_ball`, t1 (1 + 2 ε + ... + 2 εᵏ)."""
    first = np.sqrt(2 * bouncing_ball.HEIGHT / bouncing_ball.GRAVITY)
    flights = 2 * bouncing_ball.RESTITUTION ** np.arange(1, 100)
    times = first * (1 + np.concatenate([[0.0], np.cumsum(flights)]))
    return times[times < until]


@pytest.mark.parametrize("scheme", TOLD_APART + MOREAU)
@pytest.mark.parametrize("record_every", [1, 50])
def test_impacts_of_a_ball_are_its_bounces(scheme, record_every):
    run = sk.TimeStepping(bouncing_ball.build(), scheme, 1e-4, record_every=record_every).run(3.0)
    states = run["floor"].states
    exact = bounces(3.0)
    assert len(exact) == 6
    assert states.dtype == np.int8
    np.testing.assert_allclose(run.t[states == IMPACT], exact, atol=1.5e-3)
    assert phases(states) == 6 * [OPEN, IMPACT] + [OPEN]


@pytest.mark.parametrize("scheme", TOLD_APART + MOREAU)
def test_a_ball_that_lies_is_not_hit_in_every_step(scheme):
    run = sk.TimeStepping(ball(height=0.0), scheme, 1e-3).run(1.0)
    assert (run["floor"].states == CLOSED).all()
    run = sk.TimeStepping(bouncing_ball.build(), scheme, 1e-4).run(4.5)
    rest = run.t > bouncing_ball.rest_time() + 0.01
    assert (run["floor"].states[rest] == CLOSED).all()


@pytest.mark.parametrize("scheme", ["HalfExplicitTrapezoidalOSI", "MoreauJeanOSI", "EventDrivenOSI"])
def test_a_block_slips_until_it_stops(scheme):
    run = sk.TimeStepping(dry_friction.block(0.2), scheme, 1e-3).run(3.0)
    states = run["plane"].states
    stop, _ = dry_friction.block_at_rest(0.2)
    assert phases(states) == [SLIP, STICK]
    assert 0.0 <= run.t[states == STICK][0] - stop <= 1e-3


def test_a_ball_slips_until_it_rolls():
    run = sk.TimeStepping(dry_friction.ball(), "HalfExplicitTrapezoidalOSI", 1e-3).run(0.5)
    states = run["plane"].states
    assert phases(states) == [SLIP, STICK]
    assert 0.0 <= run.t[states == STICK][0] - dry_friction.rolling()[0] <= 1e-3


def test_a_block_that_never_moves_sticks_and_without_friction_it_is_closed():
    def states(mu):
        body = sk.LagrangianLinearTIDS(
            [0.0, 0.0], [0.0, 0.0], 2.0 * np.eye(2), external_force=[1.0 if mu else 0.0, -20.0]
        )
        return sk.TimeStepping(dry_friction.on_plane(body, [1.0, 0.0], mu), "MoreauJeanOSI", 1e-3).run(0.1)

    assert (states(0.3)["plane"].states == STICK).all()
    assert (states(0.0)["plane"].states == CLOSED).all()


def test_corners_of_the_slider_bounce_then_slide_on_the_walls():
    run = sk.TimeStepping(slider_crank.build(), "HalfExplicitTrapezoidalOSI", 1e-5).run(0.03)
    upper, lower = run["upper left"].states, run["lower left"].states
    assert phases(upper)[:4] == [OPEN, IMPACT, OPEN, IMPACT]
    assert phases(upper)[-3:] == [IMPACT, SLIP, OPEN]
    assert phases(lower) == 4 * [OPEN, IMPACT] + [OPEN]
    np.testing.assert_array_equal(
        run.impulsive, np.any([run[name].states == IMPACT for name in run.contacts], axis=0)
    )
    carried = np.any([run[name].force.any(axis=1) for name in run.contacts], axis=0)
    np.testing.assert_array_equal(
        carried, np.any([run[name].states == SLIP for name in run.contacts], axis=0)
    )


def test_equalities_are_held_and_shocks_of_others_are_no_impacts_of_theirs():
    point = sk.LagrangianLinearTIDS([1.0, 0.0], [0.0, 0.0], np.eye(2), external_force=[0.0, -9.81])
    system = sk.NonSmoothDynamicalSystem([point])
    system.link(sk.Interaction(Circle(), sk.EqualityConditionNSL(1), "rod"), point)
    wall = sk.LagrangianLinearTIR([[1.0, 0.0]], [-0.5])
    system.link(sk.Interaction(wall, sk.NewtonImpactNSL(0.5), "wall"), point)
    run = sk.TimeStepping(system, "HalfExplicitTrapezoidalOSI", 1e-3).run(1.0)
    assert run["rod"].impulse.any()
    assert (run["rod"].states == HELD).all()
    assert IMPACT in run["wall"].states


def test_states_of_a_pile_agree_with_the_number_of_closed_contacts():
    run = sk.TimeStepping(disc_pile.build(), disc_pile.SCHEME, 1e-3).run(3.0)
    states = np.array([run[name].states for name in run.contacts])
    np.testing.assert_array_equal((states[:, -100:] != OPEN).sum(axis=0), run.closed[-100:])
    assert set(np.unique(states[:, -1])) == {OPEN, STICK}


def test_a_velocity_that_is_not_known_tells_no_sliding():
    run = sk.TimeStepping(dry_friction.block(0.2), "HalfExplicitTrapezoidalOSI", 1e-3).run(0.1)
    columns = dict(run.columns())
    columns["velocity"] = columns["velocity"].copy()
    columns["velocity"][20:30] = np.nan
    unknown = Trajectory(Loaded(len(run), columns), run.layout, run.provenance)
    assert phases(unknown["plane"].states) == [SLIP, CLOSED, SLIP]


def test_laws_are_kept_with_the_run(tmp_path):
    point = sk.LagrangianLinearTIDS([1.0, 0.0], [0.0, 0.0], np.eye(2))
    system = sk.NonSmoothDynamicalSystem([point])
    system.link(sk.Interaction(Circle(), sk.EqualityConditionNSL(1), "rod"), point)
    wall = sk.LagrangianLinearTIR([[1.0, 0.0]])
    system.link(sk.Interaction(wall, sk.NewtonImpactNSL(0.5), "wall"), point)
    rough = sk.LagrangianLinearTIR([[0.0, 1.0], [1.0, 0.0]], [2.0, 0.0])
    system.link(sk.Interaction(rough, sk.NewtonImpactFrictionNSL(0.25, 0.125, 0.75, 2), "floor"), point)
    run = sk.TimeStepping(system, "HalfExplicitTrapezoidalOSI", 1e-2).run(0.05)
    assert run["rod"].law == ContactLaw("EqualityConditionNSL")
    assert run["wall"].law == ContactLaw("NewtonImpactNSL", 0.5)
    assert run["floor"].law == ContactLaw("NewtonImpactFrictionNSL", 0.25, 0.125, 0.75)
    back = read_hdf5(run.to_hdf5(tmp_path / "run.h5"))
    assert back.layout == run.layout
    np.testing.assert_array_equal(back["rod"].states, run["rod"].states)


def test_runs_without_laws_are_refused(tmp_path):
    run = sk.TimeStepping(ball(), "HalfExplicitTrapezoidalOSI", 1e-2).run(0.05)
    path = run.to_hdf5(tmp_path / "run.h5")
    with h5py.File(path, "r+") as file:
        file.attrs["saltus_format"] = 3
    with pytest.raises(ValueError, match="has format 3, this version reads 4"):
        read_hdf5(path)


def test_rounding_is_no_impact():
    """Contacts that an impact elsewhere reaches with 1e-20 N s are not hit."""
    run = sk.TimeStepping(disc_pile.three_discs(), disc_pile.SCHEME, 1e-3).run(0.05)
    columns = dict(run.columns())
    columns["impulse"] = columns["impulse"].copy()
    columns["impulse"][10] = 1e-20
    columns["impulse"][20, run.layout.contacts["2 on 0"].row] = 1.0
    noisy = Trajectory(Loaded(len(run), columns), run.layout, run.provenance)
    assert np.flatnonzero(noisy["2 on 0"].states == IMPACT).tolist() == [20]


@pytest.mark.parametrize("scheme", ["HalfExplicitTrapezoidalOSI", "MoreauJeanOSI"])
def test_forces_and_impulses_are_told_apart(scheme):
    time_step = 1e-3
    run = sk.TimeStepping(bouncing_ball.build(), scheme, time_step).run(4.5)
    floor = run["floor"]
    force, impulse = run.reactions("floor")
    np.testing.assert_array_equal(run.impacts, floor.states == IMPACT)
    np.testing.assert_array_equal(run.impacts, impulse[:, 0] != 0.0)
    assert run.told_apart == (scheme != "MoreauJeanOSI")
    np.testing.assert_allclose(
        force * time_step + impulse, floor.force * time_step + floor.impulse, rtol=1e-15
    )
    np.testing.assert_allclose(force[-100:], bouncing_ball.MASS * bouncing_ball.GRAVITY)
    loaded = run.loaded()
    assert loaded.layout is run.layout
    np.testing.assert_array_equal(loaded["floor"].states, floor.states)


def test_bounces_in_recorded_rows_that_follow_each_other_are_impacts():
    """With rows of impulsive steps alone, the row before is that of the bounce before."""
    run = sk.TimeStepping(bouncing_ball.build(), "MoreauJeanOSI", 1e-3, record_every=10**6).run(2.0)
    assert run["floor"].states.tolist() == [OPEN, *len(bounces(2.0)) * [IMPACT]]


def test_a_run_without_rest_is_judged_by_its_scheme():
    # two impacts in rows that follow each other, no force: both are impacts but under Moreau-Jean
    half = sk.TimeStepping(bouncing_ball.build(), "HalfExplicitTrapezoidalOSI", 1e-3).run(1.0)
    assert not half["floor"].force.any()
    assert half.told_apart
    for provenance, second in (
        (half.provenance, IMPACT),
        (replace(half.provenance, forces_at_rest=False), ContactState.CLOSED),
    ):
        columns = {name: np.array(values) for name, values in half.columns().items()}
        row = int(np.flatnonzero(half.impulsive)[0])
        columns["impulse"][row + 1] = columns["impulse"][row]
        states = Trajectory(Loaded(len(half), columns), half.layout, provenance)["floor"].states
        assert states[row : row + 2].tolist() == [IMPACT, second]
