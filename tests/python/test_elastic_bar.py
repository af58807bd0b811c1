"""The elastic bar: Figures 13 to 15 against what is known of them, the languages against each other."""

import json

import numpy as np
import pytest
import saltus.kernel as sk
from saltus import _core
from saltus.cli.app import app
from saltus.examples.elastic_bar import figures
from saltus.examples.elastic_bar.elastic_bar import CONTACT, DAMPING, END, TIME_STEP, Parameters, build
from saltus.examples.elastic_bar.figures import EXACT, MOREAU, VELOCITY
from typer.testing import CliRunner

P = Parameters()
FIGURES = {13: figures.figure_13, 14: figures.figure_14, 15: figures.figure_15}
ELEMENTS = {13: 50, 14: 1000, 15: 1000}


@pytest.fixture(scope="module")
def drawn():
    return {number: make() for number, make in FIGURES.items()}


def test_the_continuous_bar_is_that_of_table_5():
    assert P.wave_speed == pytest.approx(5188.7, abs=0.05)
    assert P.contact_time == pytest.approx(3.854e-4, rel=1e-3)
    assert P.contact_force == pytest.approx(1271, abs=1)


@pytest.mark.parametrize(
    ("number", "scheme", "lasts", "mean", "deviation", "largest"),
    [
        (13, VELOCITY, 3.819e-4, 1264.1, 82.0, 1994),
        (14, VELOCITY, 3.849e-4, 1271.1, 16.0, 1968),
        (15, VELOCITY, 3.852e-4, 1271.1, 15.0, 1431),
        (13, MOREAU, 3.819e-4, 1264.5, 79.5, 1990),
        (14, MOREAU, 3.850e-4, 1271.3, 10.0, 1989),
        (15, MOREAU, 3.853e-4, 1271.3, 9.43, 1358),
    ],
)
def test_forces(drawn, number, scheme, lasts, mean, deviation, largest):
    value = {row.quantity: row.value for row in drawn[number].quantities if row.scheme == scheme}
    assert value["time of the impact"] == pytest.approx(5.001e-4, rel=1e-12)
    assert value["contact lasts"] == pytest.approx(lasts, abs=TIME_STEP)
    assert value["mean force, first half"] == pytest.approx(mean, rel=1e-3)
    assert value["mean force, first half"] == pytest.approx(P.contact_force, rel=7e-3)
    assert value["its standard deviation"] == pytest.approx(deviation, abs=0.05)
    assert value["largest force"] == pytest.approx(largest, rel=1e-3)
    assert value["steps without force in between"] == 0


@pytest.mark.parametrize(("number", "lost"), [(13, 0.577), (14, 0.029), (15, 0.029)])
def test_the_impact_is_that_of_a_node(drawn, number, lost):
    figure = drawn[number]
    assert figure.value(VELOCITY, "impacts") == 1
    impulse = P.v0 * P.rho * P.S * P.L / ELEMENTS[number] / np.sqrt(12)
    assert figure.value(VELOCITY, "impulse Λ") == pytest.approx(impulse, rel=1e-12)
    assert figure.value(EXACT, "impulse Λ of these elements") == pytest.approx(impulse, rel=1e-12)
    for scheme in (VELOCITY, EXACT):
        assert figure.value(scheme, "energy lost at the impact") == pytest.approx(lost, abs=5e-4)
    assert figure.value(VELOCITY, "largest penetration") == pytest.approx(5e-9, rel=1e-3)
    assert figure.value(VELOCITY, "largest speed in contact") < 1e-15


def test_energy_is_kept_but_for_damping(drawn):
    for number in (13, 14):
        lost = drawn[number].value(VELOCITY, "energy lost in all")
        assert lost == pytest.approx(drawn[number].value(VELOCITY, "energy lost at the impact"), abs=0.01)
    assert drawn[15].value(VELOCITY, "energy lost in all") == pytest.approx(0.983, abs=1e-3)


def test_the_pictures_show_the_runs(drawn):
    for figure in drawn.values():
        _, velocity, force, beside, impulse, _ = figure.picture.axes
        assert len(force.lines[0].get_ydata()) == 15001
        assert np.max(force.lines[0].get_ydata()) == figure.value(VELOCITY, "largest force")
        assert velocity.lines[0].get_ydata()[0] == -P.v0
        drawn_impulse = 1e-3 * impulse.lines[0].get_ydata()
        assert drawn_impulse == pytest.approx([figure.value(VELOCITY, "impulse Λ")])
        assert np.sum(beside.lines[0].get_ydata()) * TIME_STEP == pytest.approx(0.49, rel=0.02)


@pytest.mark.parametrize("scheme", [VELOCITY, MOREAU])
@pytest.mark.parametrize("damping", [0.0, DAMPING])
def test_both_languages_give_the_same_trajectory(scheme, damping):
    python = sk.TimeStepping(build(50, damping), scheme, TIME_STEP).run(END).columns()
    model = _core.compiled_elastic_bar(elements=50, damping=damping)
    simulation = _core.TimeSteppingBase(model, _core.make_integrator(scheme), TIME_STEP, "auto")
    recording = _core.Recording()
    simulation.add_observer(recording)
    simulation.advance(END, None)
    compiled = recording.columns()
    for name in ("impulsive", "closed"):
        np.testing.assert_array_equal(compiled[name], python[name])
    for name, scale in (("q", P.gap), ("v", P.v0), ("force", P.contact_force), ("impulse", P.impulse(50))):
        np.testing.assert_allclose(compiled[name], python[name], rtol=0, atol=1e-9 * scale)


def test_the_loop_written_by_hand_takes_the_same_steps():
    run = sk.TimeStepping(build(1000, DAMPING), VELOCITY, TIME_STEP, record_every=10**4).run(1e-3)
    q, v = _core.bare_elastic_bar(1000, DAMPING, P.gap, TIME_STEP, 10**4)
    np.testing.assert_allclose(q, run.q[-1], rtol=0, atol=1e-10 * P.gap)
    np.testing.assert_allclose(v, run.v[-1], rtol=0, atol=1e-9 * P.v0)


def test_the_first_node_is_recorded_as_in_a_whole_run():
    whole = sk.TimeStepping(build(50), VELOCITY, TIME_STEP, solver="lemke").run(END)
    slim = figures.run(VELOCITY, 50, 0.0)
    np.testing.assert_array_equal(slim.q, whole.q[:, :1])
    for name in ("t", "energy", "impulsive"):
        np.testing.assert_array_equal(getattr(slim, name), getattr(whole, name))
    np.testing.assert_array_equal(slim[CONTACT].force, whole[CONTACT].force)
    assert slim.provenance.solver == "lemke"
    assert slim.provenance.parameters["elements"] == 50


def test_check_finds_nothing_and_what_is_no_bar_is_refused():
    assert build(50, DAMPING).check().ok
    with pytest.raises(ValueError, match="elements must be at least 1, got 0"):
        build(0)
    with pytest.raises(ValueError, match="damping must be finite and at least 0, got -1"):
        build(50, -1.0)


def test_bench_knows_the_bars_and_leaves_out_what_is_unstable():
    schemes = [VELOCITY, "MoreauJeanOSI", "ExplicitMoreauJeanOSI"]
    options = [word for scheme in schemes for word in ("--integrator", scheme)]
    result = CliRunner().invoke(app, ["bench", "bar-50", *options, "--json"])
    assert result.exit_code == 0, result.output
    found = json.loads(result.stdout)
    rows = {(row["model"], row["integrator"]): row for row in found["results"]}
    assert set(rows) == {("bar-50", name) for name in (*schemes[:2], "bare-loop")}
    for row in rows.values():
        assert (row["steps"], row["time_step"]) == (15000, TIME_STEP)
        assert 0 < row["us_per_step"] < 100
    [skipped] = found["skipped"]
    assert skipped["integrator"] == "ExplicitMoreauJeanOSI"
    assert "is too large for ExplicitMoreauJeanOSI" in skipped["reason"]
