"""Pictures of runs: what is drawn is what was computed, into the axes that are given."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
import saltus.kernel as sk
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_hex
from saltus import plot
from saltus.examples.bouncing_ball import bouncing_ball
from saltus.examples.chain_of_bodies import chain_of_bodies
from saltus.examples.disc_pile import disc_pile
from saltus.examples.dry_friction import dry_friction
from saltus.examples.rolling_sphere import rolling_sphere
from saltus.examples.slider_crank import slider_crank
from saltus.io import ContactState
from saltus.io.hdf5 import RunFile
from saltus.io.records import UNITS
from saltus.panels.contacts import COLORS
from saltus.panels.drawing import PIECES, extremes
from test_models import ball

SCHEME = "HalfExplicitTrapezoidalOSI"


@pytest.fixture(autouse=True)
def _no_other_figures():
    plt.close("all")
    yield
    plt.close("all")


def run(system, scheme=SCHEME, time_step=1e-3, until=1.0, **options):
    return sk.TimeStepping(system, scheme, time_step, **options).run(until)


def free_mass(**options):
    return run(sk.NonSmoothDynamicalSystem([sk.LagrangianLinearTIDS([0.0], [1.0], [[1.0]])]), **options)


def labels(axes):
    return [ax.get_ylabel().split("\n")[0] for ax in axes]


def bands(ax):
    """[(contact, state, start, end)] of a panel of states."""
    kinds = {to_hex(color): state for state, color in COLORS.items()}
    found = []
    for bars in ax.collections:
        if isinstance(bars, PolyCollection):
            state = kinds[to_hex(bars.get_facecolor()[0])]
            for path in bars.get_paths():
                (start, low), (end, _) = path.vertices.min(axis=0), path.vertices.max(axis=0)
                found.append((round(low + 0.4), state, start, end))
    return sorted(found, key=lambda band: (band[0], band[2]))


def test_a_run_is_drawn_into_the_axes_that_are_given():
    trajectory = run(bouncing_ball.build(), until=2.0)
    figure, given = plt.subplots(5)
    drawn = trajectory.plot(given)
    assert plt.get_fignums() == [figure.number]
    assert list(drawn) == list(given)
    assert labels(drawn) == [
        "position q",
        "gap g [m]",
        "force λ_N [N]",
        "impulse Λ_N [N s]",
        "total energy [J]",
    ]
    assert {ax.get_xlabel() for ax in drawn} == {"time t [s]"}
    np.testing.assert_array_equal(drawn[1].lines[0].get_ydata(), trajectory["floor"].gap[:, 0])
    hits = trajectory.t[trajectory.impulsive]
    assert len(hits) == 3
    marks = drawn[2].collections[0].get_segments()
    np.testing.assert_array_equal([mark[0, 0] for mark in marks], hits)
    stems = [line for line in drawn[3].lines if line.get_marker() == "o"]
    np.testing.assert_array_equal(
        stems[0].get_xydata(), np.column_stack([hits, trajectory["floor"].impulse[trajectory.impulsive]])
    )


def test_without_axes_there_is_a_new_figure():
    axes = free_mass().plot()
    assert labels(axes) == ["position q", "total energy [J]"]
    assert plt.get_fignums() == [axes[0].figure.number]


def test_wrong_axes_and_names_are_told():
    trajectory = run(bouncing_ball.build(), until=0.1)
    _, axes = plt.subplots(2, 2)
    panels = "positions, gaps, forces, impulses, energy; got 4 of Axes"
    with pytest.raises(ValueError, match=f"expected 5 axes for the panels {panels}"):
        trajectory.plot(axes)
    with pytest.raises(
        ValueError, match="expected 3 axes for the panels energies, work, defect; got 1 of Figure"
    ):
        trajectory.plot_energy(axes[0, 0].figure)
    with pytest.raises(KeyError, match="no contact named 'wall', there are floor"):
        trajectory.plot(contacts=["wall"])
    with pytest.raises(ValueError, match="a run with contacts, or names of some, got none to draw"):
        free_mass().plot_contacts()
    assert len(plt.get_fignums()) == 1


@pytest.mark.parametrize("scheme", [SCHEME, "MoreauJeanOSI"])
def test_friction_stays_in_its_cone_and_the_band_says_when_it_slips(scheme):
    trajectory = run(dry_friction.block(0.2), scheme, until=3.0)
    gap, speed, force, impulse, band, slip, friction, tangential = trajectory.plot_contacts()
    symbol = "λ_T" if scheme == SCHEME else "Λ_T/Δt"
    assert labels([friction, slip]) == [f"friction {symbol} [N]", "velocity γ_T [m/s]"]
    np.testing.assert_array_equal(slip.lines[0].get_ydata(), trajectory["plane"].velocity[:, 1])
    weight = dry_friction.MASS * dry_friction.GRAVITY * np.array([np.cos(0.2), np.sin(0.2)])
    np.testing.assert_allclose(force.lines[0].get_ydata()[1:], weight[0])
    held = trajectory.t > dry_friction.block_at_rest(0.2)[0] + 1e-3
    drawn = friction.lines[0].get_ydata()
    np.testing.assert_allclose(drawn[held], -weight[1])
    np.testing.assert_allclose(drawn[1:2000], -dry_friction.MU * weight[0])
    cone = next(c for c in friction.collections if isinstance(c, PolyCollection)).get_paths()[0].vertices
    np.testing.assert_allclose([cone[:, 1].min(), cone[:, 1].max()], [-0.3 * weight[0], 0.3 * weight[0]])
    for panel in (impulse, tangential):
        assert [len(line.get_xdata()) for line in panel.lines] == [0]
    (_, sliding, start, stop), (_, sticking, _, end) = bands(band)
    assert (sliding, sticking) == (ContactState.SLIP, ContactState.STICK)
    assert (start, end) == (0.0, 3.0)
    assert stop == trajectory.t[~held][-2]
    assert gap.get_legend() is None
    assert [text.get_text() for text in band.get_yticklabels()] == ["plane"]


def test_under_moreau_jean_what_carries_is_no_impulse():
    trajectory = run(bouncing_ball.build(), "MoreauJeanOSI", until=4.5)
    hits = trajectory["floor"].states == ContactState.IMPACT
    _, _, force, impulse, band = trajectory.plot_contacts()
    assert labels([force, impulse]) == ["force Λ_N/Δt [N]", "impulse Λ_N [N s]"]
    drawn = force.lines[0].get_ydata()
    np.testing.assert_allclose(drawn[-100:], bouncing_ball.MASS * bouncing_ball.GRAVITY)
    assert not drawn[hits].any()
    stems = next(line for line in impulse.lines if line.get_marker() == "o")
    np.testing.assert_array_equal(stems.get_xdata(), trajectory.t[hits])
    np.testing.assert_array_equal(stems.get_ydata(), trajectory["floor"].impulse[hits, 0])
    ticks = next(c for c in band.collections if isinstance(c, LineCollection))
    np.testing.assert_array_equal([tick[0, 0] for tick in ticks.get_segments()], trajectory.t[hits])


def test_of_many_contacts_those_that_press_most_are_drawn():
    trajectory = run(disc_pile.build(), disc_pile.SCHEME, until=1.0)
    pressed = {
        name: 1e-3 * trajectory[name].force[:, 0].sum() + trajectory[name].impulse[:, 0].sum()
        for name in trajectory.contacts
    }
    most = sorted(pressed, key=pressed.get)[-12:]
    axes = trajectory.plot_contacts()
    names = [text.get_text() for text in axes[4].get_yticklabels()]
    assert len(trajectory.contacts) == 168
    assert set(names) == set(most)
    assert names == [name for name in trajectory.contacts if name in most]
    assert axes[4].get_title("left") == "12 of 168 contacts"
    legend = trajectory.plot()[1].get_legend()
    assert [text.get_text() for text in legend.get_texts()] == names
    two = trajectory.plot(contacts=["5 on 4", "0 on floor"])[1]
    np.testing.assert_array_equal(two.lines[0].get_ydata(), 1e3 * trajectory["5 on 4"].gap[:, 0])
    assert two.get_ylabel() == "gap g [mm]"
    everything = trajectory.plot_contacts(contacts=trajectory.contacts)
    assert len(bands(everything[4])) > 168
    assert not everything[4].get_yticklabels()


def test_in_space_tangential_quantities_are_lengths():
    trajectory = run(rolling_sphere.build(), until=0.5)
    slip, friction, _ = trajectory.plot_contacts()[5:]
    assert labels([slip, friction]) == ["velocity |γ_T| [m/s]", "friction |λ_T| [N]"]
    plane = trajectory["plane"]
    np.testing.assert_allclose(slip.lines[0].get_ydata(), np.hypot(*plane.velocity[:, 1:].T), rtol=1e-15)
    np.testing.assert_allclose(
        friction.lines[0].get_ydata()[1:], plane.law.friction * plane.force[1:, 0], rtol=1e-8
    )


def test_equalities_are_drawn_with_all_their_rows():
    trajectory = run(chain_of_bodies.build(3), until=0.1)
    gap, _, force, _, band = trajectory.plot_contacts()
    rows = sum(slot.rows for slot in trajectory.layout.contacts.values())
    assert rows > 3
    assert len(gap.lines) == rows + 1  # and the axis
    assert len(force.lines) == rows
    assert [state for _, state, *_ in bands(band)] == 3 * [ContactState.HELD]


def test_a_contact_has_its_colour_in_all_panels():
    point = sk.LagrangianLinearTIDS([0.0, 0.0], [1.0, 0.0], np.eye(2), external_force=[0.0, -9.81])
    system = sk.NonSmoothDynamicalSystem([point])
    wall = sk.LagrangianLinearTIR([[-1.0, 0.0]], [9.0])
    system.link(sk.Interaction(wall, sk.NewtonImpactNSL(0.5), "wall"), point)
    floor = sk.LagrangianLinearTIR([[0.0, 1.0], [1.0, 0.0]])
    system.link(sk.Interaction(floor, sk.NewtonImpactFrictionNSL(0.0, 0.0, 0.1, 2), "floor"), point)
    gap, _, force, _, band, slip, friction, _ = run(system).plot_contacts()
    assert [line.get_color() for line in gap.lines[:2]] == ["C0", "C1"]
    assert [line.get_color() for line in (*slip.lines, *friction.lines)] == ["C1", "C1"]
    assert [text.get_color() for text in band.get_yticklabels()] == ["C0", "C1"]
    assert force.lines[1].get_linestyle() == friction.lines[0].get_linestyle() == "--"


def test_long_runs_are_drawn_by_their_extremes():
    values = np.sin(np.linspace(0.0, 40.0, 1_000_003))
    values[[123_457, 876_543]] = 9.0, -9.0
    values[500:900] = np.nan
    rows = extremes(values)
    assert len(rows) < 5 * PIECES
    assert {0, 123_457, 876_543, 1_000_002} < set(rows)
    assert (np.diff(rows) > 0).all()
    pieces = values[:1_000_000].reshape(PIECES, 500)
    shown = np.full(1_000_003, np.nan)
    shown[rows] = values[rows]
    drawn = shown[:1_000_000].reshape(PIECES, 500)
    np.testing.assert_array_equal(np.nanmin(drawn, axis=1), np.nanmin(pieces, axis=1))
    np.testing.assert_array_equal(np.nanmax(drawn, axis=1), np.nanmax(pieces, axis=1))
    np.testing.assert_array_equal(extremes(values[:100]), np.arange(100))


def test_long_bands_keep_every_impact_and_long_phases():
    trajectory = run(slider_crank.build(), time_step=2e-6, until=0.03)
    assert len(trajectory) > 4 * PIECES
    band = trajectory.plot_contacts(contacts=["upper left"])[4]
    states = trajectory["upper left"].states
    hits = trajectory.t[states == ContactState.IMPACT]
    ticks = next(c for c in band.collections if isinstance(c, LineCollection))
    np.testing.assert_array_equal([tick[0, 0] for tick in ticks.get_segments()], hits)
    slips = [(start, end) for _, state, start, end in bands(band) if state == ContactState.SLIP]
    piece = 8 * 2e-6
    sliding = trajectory.t[states == ContactState.SLIP]
    assert slips[0][0] == pytest.approx(sliding[0], abs=piece)
    assert slips[-1][1] == pytest.approx(sliding[-1], abs=piece)


@pytest.mark.parametrize("scheme", [SCHEME, "MoreauJeanOSI"])
def test_work_and_energy_balance(scheme):
    trajectory = run(slider_crank.build(), scheme, 1e-4, 0.1)
    energies, work, defect = trajectory.plot_energy()
    kinetic, potential, total = (line.get_ydata() for line in energies.lines)
    np.testing.assert_array_equal(kinetic + potential, total)
    forces, friction, shock, gained = (line.get_ydata() for line in work.lines)
    np.testing.assert_allclose(shock[-1], trajectory.work_impulse.sum(), rtol=1e-12)
    np.testing.assert_allclose(
        defect.lines[0].get_ydata(), gained - forces - friction - shock, rtol=0, atol=1e-13
    )
    assert np.abs(defect.lines[0].get_ydata()).max() < 0.02 * np.abs(gained).max()
    assert shock[-1] < -0.1
    assert (friction[-1] < 0) == (scheme == SCHEME)


def test_a_potential_that_is_not_known():
    class Unknown(sk.LagrangianDS):
        def forces(self, t, q, v, out):
            out[0] = -9.81

    trajectory = run(sk.NonSmoothDynamicalSystem([Unknown([0.0], [0.0], mass=[[2.0]])]))
    energies, work, _ = trajectory.plot_energy()
    assert [line.get_label() for line in energies.lines] == ["kinetic T"]
    np.testing.assert_allclose(work.lines[0].get_ydata()[-1], 9.81**2 / (2 * 2.0), rtol=1e-12)
    assert labels(trajectory.plot())[-1] == "kinetic energy [J]"


def test_a_balance_needs_every_step():
    """What is lost at impacts is known anyway: they are always recorded."""
    every = run(bouncing_ball.build(), until=2.0)
    some = run(bouncing_ball.build(), until=2.0, record_every=100)
    _, work, defect = some.plot_energy()
    assert [text.get_text() for text in defect.texts] == ["not every step is recorded"]
    assert [line.get_label() for line in work.lines] == ["forces h and λ", "impulses Λ", "T − T(0)"]
    together, shock, gained = (line.get_ydata() for line in work.lines)
    np.testing.assert_allclose(shock[-1], every.work_impulse.sum(), rtol=1e-15)
    np.testing.assert_allclose(together, gained - shock, rtol=0, atol=1e-14)


def test_names_are_shown_as_they_are(tmp_path):
    mass = sk.LagrangianLinearTIDS([1.0], [0.0], [[1.0]], external_force=[-9.81])
    system = sk.NonSmoothDynamicalSystem([mass])
    for name in ("_hidden", "a $ b $", "<script>"):
        system.link(sk.Interaction(sk.LagrangianLinearTIR([[1.0]]), sk.NewtonImpactNSL(0.5), name), mass)
    axes = run(system, "MoreauJeanOSI", 1e-2).plot()
    axes[0].figure.savefig(tmp_path / "names.png")
    assert [text.get_text() for text in axes[1].get_legend().get_texts()] == [
        " _hidden",
        r"a \$ b \$",
        "<script>",
    ]


def test_a_run_in_a_file_is_drawn_while_it_goes_on(tmp_path, monkeypatch):
    simulation = sk.TimeStepping(bouncing_ball.build(), SCHEME, 1e-3, file=tmp_path / "run.h5")
    for _ in range(600):
        simulation.step()
    read = []
    inner = RunFile.read
    monkeypatch.setattr(
        RunFile, "read", lambda self, name, rows: read.append(name) or inner(self, name, rows)
    )
    axes = simulation.trajectory.plot()
    assert len(axes[1].lines[0].get_ydata()) == 601
    assert sorted(read) == sorted(UNITS)


def test_units_of_gaps_suit_the_largest():
    for height, unit, scale in ((1.0, "m", 1.0), (0.05, "mm", 1e3), (2e-5, "µm", 1e6)):
        trajectory = run(ball(height), until=1e-2)
        ax = trajectory.plot()[1]
        assert ax.get_ylabel() == f"gap g [{unit}]"
        assert ax.lines[0].get_ydata()[0] == pytest.approx(scale * height)


def test_panels_are_functions_of_axes_and_run():
    """What figures of one's own are made of."""
    trajectory = run(bouncing_ball.build(), until=2.0)
    _, (left, right) = plt.subplots(1, 2)
    plot.forces(left, trajectory)
    plot.energy(right, trajectory)
    assert labels([left, right]) == ["force λ_N [N]", "total energy [J]"]
    assert left.get_legend() is not None
