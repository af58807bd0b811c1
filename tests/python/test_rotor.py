"""Runs of the rotor: welds, orders, friction, energy, the schemes against each other, table and pictures."""

import json
from dataclasses import replace

import numpy as np
import pytest
import saltus.kernel as sk
from PIL import Image
from saltus import _core
from saltus.cli.app import app
from saltus.examples.rotor import animation, comparison
from saltus.examples.rotor.animation import centre_line
from saltus.examples.rotor.comparison import MOREAU, PREDICTED, SHORT, START
from saltus.examples.rotor.rotor import CONTACT, END, STABILISED, TIME_STEP, Parameters, build
from typer.testing import CliRunner

P = Parameters()


@pytest.fixture(scope="module")
def runs():
    return {scheme: comparison.run(scheme, TIME_STEP) for scheme in SHORT}


@pytest.mark.parametrize("scheme", SHORT)
def test_runs_reach_the_end_inside_of_the_ring(runs, scheme):
    r = runs[scheme].trajectory
    assert r.t[-1] == pytest.approx(END, rel=1e-12)
    distance = np.linalg.norm(comparison.orbit(r), axis=1)
    np.testing.assert_allclose(distance, P.clearance - r[CONTACT].gap[:, 0], rtol=0, atol=1e-15)
    # The way of a step at the largest speed of approach, in parts of Δt/10 where the scheme takes them
    part = TIME_STEP if scheme == MOREAU else TIME_STEP / 10
    assert r.penetration.max() < -r[CONTACT].velocity[:, 0].min() * part
    assert (r[CONTACT].gap[:, 0] <= 0).mean() > 0.4


@pytest.mark.parametrize(
    ("scheme", "distance", "angle"),
    [(START, 1e-8, 1e-5), (PREDICTED, 1e-8, 1e-5), (STABILISED, 1e-12, 1e-12), (MOREAU, 1e-8, 1e-5)],
)
def test_welds_stay_closed(runs, scheme, distance, angle):
    opening = runs[scheme].opening
    assert opening[0] < distance
    assert opening[1] < angle


@pytest.mark.parametrize("scheme", SHORT)
def test_friction_is_that_of_coulomb_and_opposes_sliding(runs, scheme):
    contact = runs[scheme].trajectory[CONTACT]
    impulse = contact.impulse if scheme == MOREAU else contact.lambda_minus
    pressed = impulse[:, 0] > 1e-6 * impulse[:, 0].max()
    normal, friction = impulse[pressed, 0], impulse[pressed, 1:]
    sliding = contact.velocity[pressed, 1:]
    speed = np.linalg.norm(sliding, axis=1)
    np.testing.assert_allclose(np.linalg.norm(friction, axis=1), P.friction * normal, rtol=1e-6)
    along = np.einsum("ti,ti->t", friction, sliding)
    fast = speed > 0.5  # slower, the direction turns between the stage of the multiplier and the step's end
    assert fast.mean() > 0.9
    np.testing.assert_allclose(along[fast], (-P.friction * normal * speed)[fast], rtol=1e-4)


def test_few_steps_are_impulsive(runs):
    for scheme in (START, PREDICTED, STABILISED):
        assert 0.2 < runs[scheme].impulsive < 1.3
    assert runs[MOREAU].impulsive == 100.0


def test_energy_balance(runs):
    for scheme in (START, PREDICTED, STABILISED):
        assert runs[scheme].energy_defect < 2e-4
    assert runs[MOREAU].energy_defect < 1e-10
    finer = comparison.run(STABILISED, TIME_STEP / 2)
    assert finer.energy_defect < runs[STABILISED].energy_defect / 4


def test_the_drive_puts_in_what_the_rotor_has(runs):
    """T_D times the angle of the end: a little more than what moves and strains."""
    for r in (run.trajectory for run in runs.values()):
        work = P.drive_torque * r.q[-1, P.freedoms - 5]
        damped = work - r.energy[-1]
        assert 0 < damped < 0.06 * work
        spin = P.drive_torque * END / P.flywheel_inertia[0]
        assert r.v[-1, P.freedoms + 3] == pytest.approx(spin, rel=0.05)


def test_schemes_agree_on_the_orbit(runs):
    for scheme in (START, PREDICTED, MOREAU):
        assert runs[scheme].error(runs[STABILISED]) < 6e-7


@pytest.mark.parametrize(
    ("scheme", "finest", "ratio"),
    [
        (STABILISED, 1.25e-6, (3.5, 4.5)),
        (STABILISED, 2.5e-7, (3.8, 4.2)),
        (sk.HalfExplicitRungeKuttaOSI(stabilization="position"), 1.25e-6, (5, 9)),
        (sk.DMinusGalerkinOSI(activity="sticky"), 1.25e-6, (14, 18)),
    ],
)
def test_orbit_before_the_first_contact_has_the_order_of_the_scheme(scheme, finest, ratio):
    """Over the whole orbit: what the halving of Δt changes, over what the next one does."""
    until, orbits = 2e-3, []
    for dt in (4 * finest, 2 * finest, finest):
        r = sk.TimeStepping(build(), scheme, dt).run(until)
        assert r[CONTACT].gap.min() > 0
        orbits.append(comparison.orbit(r)[:: round(4 * finest / dt)])
    coarse, fine = (np.linalg.norm(a - b) for a, b in zip(orbits, orbits[1:], strict=False))
    assert ratio[0] < coarse / fine < ratio[1]


def test_without_loads_the_rotor_turns_on():
    """Spinning straight in the ring's middle: nothing happens but damping of the axle's own rotation."""
    free = replace(P, drive_torque=0.0, fault_torque=0.0, gravity=0.0, mass_damping=0.0)
    v0 = np.zeros(30)
    v0[::5] = 300.0
    r = sk.TimeStepping(build(free, None, v0), START, TIME_STEP).run(2e-3)
    np.testing.assert_allclose(r.v[:, : P.freedoms : 5], 300.0, rtol=1e-9)
    np.testing.assert_allclose(r[CONTACT].gap, P.clearance, rtol=1e-9)
    np.testing.assert_allclose(r.energy, r.energy[0], rtol=1e-9)


def test_cost_follows_the_line_of_the_runs(runs):
    class Known(comparison.Run):
        def error(self, reference):
            return self.time_step**2

    series = [Known(START, dt, runs[START].trajectory, 3 / dt) for dt in (1e-3, 5e-4, 2.5e-4)]
    assert comparison.cost_at(1e-8, series, runs[START]) == pytest.approx(3e4, rel=1e-9)


def test_pictures_show_the_runs(runs):
    way, other, *_ = comparison.draw_orbit(runs).axes
    for ax, scheme in ((way, START), (other, MOREAU)):
        points = ax.collections[0].get_offsets()
        np.testing.assert_allclose(points, 1e6 * comparison.orbit(runs[scheme].trajectory))
    gap, force, impulse, beside = comparison.draw_forces(runs).axes
    contact = runs[START].trajectory[CONTACT]
    np.testing.assert_array_equal(gap.lines[0].get_ydata(), 1e6 * contact.gap[:, 0])
    np.testing.assert_array_equal(force.lines[0].get_ydata(), contact.force[:, 0])
    assert len(impulse.collections[0].get_segments()) == runs[START].trajectory.impulsive.sum()
    moreau = runs[MOREAU].trajectory[CONTACT].impulse[:, 0] / TIME_STEP
    np.testing.assert_array_equal(beside.lines[0].get_ydata(), moreau)


def test_the_table_has_the_figures_of_the_runs(runs, capsys):
    comparison.print_table(runs, runs[STABILISED])
    lines = {line[:26].strip(): line[26:].split() for line in capsys.readouterr().out.splitlines()}
    for scheme, r in runs.items():
        share, iterations, _, error, *_ = lines[SHORT[scheme]]
        assert float(share) == pytest.approx(r.impulsive, abs=5e-3)
        assert float(error) == pytest.approx(r.error(runs[STABILISED]), rel=0.1)
        assert int(iterations) > len(r.trajectory)


def test_both_languages_compose_the_same_model():
    python = sk.TimeStepping(build(), START, TIME_STEP).run(0.01).columns()
    simulation = _core.TimeSteppingBase(
        _core.compiled_rotor(), sk.HalfExplicitTrapezoidalOSI(impulsive_substeps=10), TIME_STEP, "auto"
    )
    recording = _core.Recording()
    simulation.add_observer(recording)
    simulation.advance(0.01, None)
    compiled = recording.columns()
    assert python["impulsive"].any()
    for name in ("q", "v", "force", "impulse", "gap"):
        np.testing.assert_array_equal(compiled[name], python[name])


def test_bench_tells_why_an_explicit_scheme_cannot_run_it():
    found = CliRunner().invoke(app, ["bench", "rotor", "--integrator", "ExplicitMoreauJeanOSI", "--json"])
    assert found.exit_code == 0, found.output
    result = json.loads(found.stdout)
    assert result["results"] == []
    [skipped] = result["skipped"]
    assert "the mass matrix is not positive definite" in skipped["reason"]


def test_the_centre_line_is_that_of_the_shape_functions():
    length = P.length / P.elements
    s = length * np.arange(P.elements + 1)
    cubic, slope = s**3 - s**2, 3 * s**2 - 2 * s  # cubics are exact
    for alpha, y, z in ((0.0, 1.0, -2.0), (np.pi / 2, 2.0, 1.0)):
        nodes = np.column_stack([np.full_like(s, alpha), cubic, slope, -2 * cubic, -2 * slope])
        x, deflection = centre_line(nodes.ravel())
        exact = np.outer(x**3 - x**2, [y, z])
        assert np.abs(deflection - exact).max() < 1e-15


def test_the_axle_is_animated(tmp_path, monkeypatch):
    monkeypatch.setattr(animation, "FRAMES", 3)
    trajectory = sk.TimeStepping(build(), comparison.START, comparison.TIME_STEP).run(1e-3)
    path = animation.animate(trajectory, comparison.orbit(trajectory), tmp_path / "rotor.gif")
    with Image.open(path) as picture:
        assert picture.n_frames == 3
        picture.seek(0)
        first = np.asarray(picture.convert("RGB"), dtype=int)
        picture.seek(2)
        assert np.abs(np.asarray(picture.convert("RGB")) - first).max() > 100  # it moves
