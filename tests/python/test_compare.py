"""Comparisons of integrators: what they measure, which limits catch what, and the pytest fixture."""

import subprocess
from pathlib import Path

import numpy as np
import pytest
import saltus.kernel as sk
from saltus import models
from saltus.compare import compare, converge
from saltus.conformance.models import DoublePendulum
from saltus.examples.bouncing_ball import bouncing_ball

ROOT = Path(__file__).resolve().parents[2]
HALF_EXPLICIT, MOREAU_JEAN = "HalfExplicitTrapezoidalOSI", "ExplicitMoreauJeanOSI"
GRAVITY = 9.81


@pytest.fixture(scope="module")
def project(build_project):
    """Broken integrators and the slider crank as a plugin, and a program that compares."""
    return build_project(ROOT / "tests/python/compare_project", f"-DEXAMPLES={ROOT / 'examples'}")


def ball(height=0.2, restitution=0.6):
    body = sk.LagrangianLinearTIDS([height], [0.0], [[1.0]], external_force=[-GRAVITY])
    system = sk.NonSmoothDynamicalSystem([body])
    law = sk.NewtonImpactNSL(restitution)
    system.link(sk.Interaction(sk.LagrangianLinearTIR([[1.0]]), law, name="floor"), body)
    return system


def double_pendulum():
    return sk.NonSmoothDynamicalSystem([DoublePendulum([1.0, 0.5], [0.5, -1.0])])


def only(model, scheme, **settings):
    """The row of one integrator without baseline."""
    [row] = compare(model, [scheme], baseline=None, timings=0, **settings).rows
    return row


# ---- Broken integrators are caught, by the limit that is about it

BOUNCES = {
    "time_steps": [2e-4],
    "until": 5.0,
    "max_error": 0.02,
    "max_energy_drift": 0.01,
    "max_impulse_error": 0.02,
    "max_penetration": 2e-3,
}
SMOOTH = {"time_steps": [4e-3, 2e-3, 1e-3], "until": 0.5, "max_error": 0.1, "min_order": 1.8}


def broken_limits(model, scheme, settings):
    found = compare(model, [scheme], timings=0, **settings)
    assert {breach.integrator for breach in found.breaches} <= {scheme}
    assert all(breach.limit in breach.message for breach in found.breaches)
    return {breach.limit for breach in found.breaches}


@pytest.mark.parametrize("scheme", [HALF_EXPLICIT, MOREAU_JEAN, "MoreauJeanOSI(theta=0.55)"])
def test_healthy_integrators_keep_the_limits(scheme):
    assert broken_limits("bouncing-ball", scheme, BOUNCES) == set()


@pytest.mark.parametrize("scheme", [HALF_EXPLICIT, "MoreauJeanOSI(theta=0.5)"])
def test_healthy_integrators_have_their_order(scheme):
    assert broken_limits(double_pendulum, scheme, {**SMOOTH, "baseline": None}) == set()


def test_restitution_too_small(project):
    scheme = f"{project / 'libbroken.so'}:WeakRestitution"
    assert broken_limits("bouncing-ball", scheme, BOUNCES) == {"max-error", "max-impulse-error"}


def test_order_lost(project):
    scheme = f"{project / 'libbroken.so'}:LostOrder"
    assert broken_limits(double_pendulum, scheme, SMOOTH) == {"min-order"}


def test_positions_that_drift(project):
    scheme = f"{project / 'libbroken.so'}:Sinking"
    assert {"max-penetration", "max-energy-drift"} <= broken_limits("bouncing-ball", scheme, BOUNCES)


def test_a_baseline_that_is_compared_as_well():
    found = compare("ball-in-box", ["MoreauJeanOSI"], timings=0, max_error=1e-6)
    assert [row.baseline for row in found.rows] == [True, False]
    assert [breach.limit for breach in found.breaches] == ["max-error"]


def test_too_slow():
    found = compare("slider-crank", ["MoreauJeanOSI"], baseline=MOREAU_JEAN, max_slowdown=2.0)
    [breach] = found.breaches
    assert breach.limit == "max-slowdown"
    assert breach.value == found.rows[1].slowdown > 2.0  # measured: 5
    assert compare("slider-crank", [HALF_EXPLICIT], baseline=MOREAU_JEAN, max_slowdown=2.0).ok


# ---- The figures


def test_table_3():
    found = compare("slider-crank", [HALF_EXPLICIT], baseline=MOREAU_JEAN, time_steps=[1e-3, 1e-4, 1e-5])
    assert (found.reference, found.reference_step) == (HALF_EXPLICIT, 1e-7)
    spectral = {(row.integrator, row.time_step): row.spectral for row in found.rows}
    assert spectral == {
        (HALF_EXPLICIT, 1e-3): pytest.approx(0.472, rel=0.01),
        (HALF_EXPLICIT, 1e-4): pytest.approx(0.01747, rel=1e-3),
        (HALF_EXPLICIT, 1e-5): pytest.approx(0.003304, rel=1e-3),
        (MOREAU_JEAN, 1e-3): pytest.approx(0.794, rel=0.01),
        (MOREAU_JEAN, 1e-4): pytest.approx(0.1526, rel=1e-3),
        (MOREAU_JEAN, 1e-5): pytest.approx(0.04535, rel=1e-3),
    }
    assert found.warnings == ()


def test_python_and_cpp_give_the_same_figures(project):
    done = subprocess.run([project / "program"], capture_output=True, text=True, check=True)
    settings = {"time_steps": [1e-3, 1e-4], "reference": f"{HALF_EXPLICIT}@1e-6", "until": 0.1, "timings": 0}
    schemes = {"integrators": [HALF_EXPLICIT], "baseline": MOREAU_JEAN}
    for model in ("slider-crank", f"{project / 'libbroken.so'}:slider_crank"):
        rows = compare(model, **schemes, **settings).rows
        assert len(done.stdout.splitlines()) == len(rows) == 4
        for line, row in zip(done.stdout.splitlines(), rows, strict=True):
            name, *numbers = line.split()
            mine = [
                row.time_step,
                row.error_q,
                row.error_v,
                row.spectral,
                row.impulse_error,
                row.energy_drift,
            ]
            assert name == row.integrator
            assert [float(number) for number in numbers] == pytest.approx(mine, rel=1e-9)
    assert subprocess.run([project / "program", "1e-9"], capture_output=True).returncode == 1


def test_errors_are_scaled_differences():
    """A ball that starts 1 % too high, against a recording of the right one: known in closed form."""
    right = sk.TimeStepping(ball(1.0), HALF_EXPLICIT, 1e-3).run(0.4)
    row = only(lambda: ball(1.01), HALF_EXPLICIT, time_steps=[1e-2], until=0.4, reference=right)
    fall = right.q[10, 0] - right.q[-1, 0]
    assert row.common_times == 40
    assert row.error_q == pytest.approx(0.01 / fall, rel=1e-9)
    assert row.error_v == pytest.approx(0.0, abs=1e-12)
    assert row.spectral == pytest.approx(0.01 * np.sqrt(40), rel=1e-9)
    assert row.normalised == pytest.approx(0.01, rel=1e-9)
    assert row.energy_drift == pytest.approx(0.0, abs=1e-12)  # a height more is no drift


def test_energy_drift_in_closed_form():
    """Explicit Moreau-Jean falls by ½ g² Δt t too far, so that the energy falls with it."""
    dt, until = 1e-3, 0.4
    row = only(lambda: ball(1.0), MOREAU_JEAN, time_steps=[dt], until=until)
    drift = 0.5 * GRAVITY**2 * dt * until
    assert row.energy_drift == pytest.approx(drift / (0.5 * (GRAVITY * until) ** 2), rel=1e-6)


def test_penetration_and_contacts_are_those_of_the_run():
    row = only("ball-in-box", HALF_EXPLICIT)
    run = sk.TimeStepping(models.model("ball-in-box").build(), HALF_EXPLICIT, 5e-3).run(2.0)
    assert row.penetration == run.penetration.max()
    assert row.impulsive_steps == run.impulsive.sum()
    assert row.closed == pytest.approx(run.closed[1:].mean())
    assert row.residual == run.residual.max()
    assert row.steps == len(run) - 1


# ---- Alignment


def test_no_impact():
    row = only(lambda: ball(10.0), HALF_EXPLICIT, time_steps=[1e-3], until=1.0)
    assert (row.impacts, row.reference_impacts, row.unmatched) == (0, 0, 0)
    assert (row.impulse_error, row.impact_time_error) == (0.0, 0.0)
    assert row.error_q < 1e-11
    assert row.order is None


def test_one_impact():
    row = only(ball, HALF_EXPLICIT, time_steps=[1e-3], until=0.3)
    assert (row.impacts, row.reference_impacts, row.unmatched) == (1, 1, 0)
    assert 0 < row.impact_time_error <= 1e-3
    assert 0 < row.impulse_error < 0.01
    assert 0 < row.error_v < 0.01  # where v jumps it is not compared


@pytest.mark.parametrize("scheme", [HALF_EXPLICIT, "MoreauJeanOSI"])
def test_five_hundred_impacts(scheme):
    """Flights shorten by 0.5 % each; errors of their times add up, and no impact is lost by that."""
    row = only(
        lambda: ball(0.01, 0.995),
        scheme,
        time_steps=[1e-5],
        until=16.6,
        reference=f"{HALF_EXPLICIT}@1e-6",
    )
    assert row.reference_impacts == 507
    assert abs(row.impacts - 507) <= 1  # at the end one can be earlier or later than it
    assert row.unmatched == 0
    assert row.impact_time_error < 3e-3
    assert row.impulse_error < 1e-3
    assert row.error_q < 0.05


@pytest.mark.parametrize("scheme", [HALF_EXPLICIT, MOREAU_JEAN, "MoreauJeanOSI"])
def test_an_accumulation_point_is_no_nonsense(scheme):
    """Infinitely many impacts until 4.06 s, then rest: an impulse in every step under Moreau-Jean."""
    row = only("bouncing-ball", scheme, time_steps=[1e-4])
    assert row.reference_impacts == 21  # those above 1 % of the largest impulse: 0.8 ** 20 is 0.0115
    assert row.impacts == 21
    assert row.unmatched == 0
    assert row.impulse_error < 1e-3
    assert row.error_q < 2e-3
    assert row.error_v < 3e-3


def test_different_numbers_of_impacts():
    """A ball that sticks hits once; each of the right one's further impacts counts as a whole."""
    right = sk.TimeStepping(ball(), HALF_EXPLICIT, 1e-4).run(1.0)
    impulses = right["floor"].impulse[right.impulsive, 0]
    row = only(lambda: ball(restitution=0.0), HALF_EXPLICIT, time_steps=[1e-3], until=1.0, reference=right)
    assert row.impacts == 1
    assert row.unmatched == row.reference_impacts - 1 > 1
    assert row.impulse_error == pytest.approx(impulses[1] / impulses[0], rel=0.01)


class FailsOSI(sk.OneStepIntegrator):
    """Diverges at 0.3 s, or where its option says."""

    def __init__(self, at=0.3):
        super().__init__()
        self.at = at

    def prepare(self, system, solver):
        self.here = sk.Configuration(system)

    def step(self, dt, state, reactions):
        self.here.move_to(state.q)
        a = self.here.solve_mass(self.here.forces(state.t, state.v))
        state.q = state.q + dt * state.v + 0.5 * dt**2 * a
        state.v = state.v + dt * a if state.t < self.at else np.array([np.nan])
        state.t += dt
        return sk.StepReport()


def fails(at=0.3):
    if "FailsOSI" not in {entry["name"] for entry in sk.integrators()}:
        sk.register_integrator(FailsOSI)
    return f"FailsOSI(at={at})"


def test_a_run_that_ends_early_is_compared_and_named():
    found = compare(lambda: ball(2.0), [fails()], time_steps=[1e-2], until=0.5)
    row = found.rows[1]
    assert row.end == pytest.approx(0.3, abs=0.011)
    assert row.common_times == round(row.end / 1e-2)
    assert row.error_q < 1e-12
    assert "step 31 from t = 0.3 s failed" in row.ended or "step 32" in row.ended
    [breach] = found.breaches
    assert breach.limit == "until"
    assert "not finite" in breach.message
    assert breach.value == row.end


def test_a_run_that_does_not_begin():
    found = compare(lambda: ball(2.0), [fails(-1.0)], time_steps=[1e-2], until=0.5, max_error=1e-3)
    row = found.rows[1]
    assert (row.common_times, row.error_q, row.error_v) == (0, None, None)
    assert [breach.limit for breach in found.breaches] == ["until"]
    with pytest.raises(ValueError, match="times in common.*step 1 from t = 0 s failed"):
        compare(
            lambda: ball(2.0), [HALF_EXPLICIT], time_steps=[1e-2], until=0.5, reference=fails(-1.0) + "@1e-3"
        )


def test_baseline_and_reference_that_end_early_are_said():
    found = compare(lambda: ball(2.0), [HALF_EXPLICIT], baseline=fails(), time_steps=[1e-2], until=0.5)
    assert found.ok
    assert any("baseline ended early" in warning for warning in found.warnings)
    found = compare(
        lambda: ball(2.0), [HALF_EXPLICIT], time_steps=[1e-2], until=0.5, reference=fails() + "@1e-3"
    )
    assert found.rows[1].end == pytest.approx(0.3, abs=0.011)
    assert any("reference ended early" in warning for warning in found.warnings)


# ---- References


def test_a_file_is_a_reference(tmp_path):
    path = tmp_path / "truth.h5"
    sk.TimeStepping(bouncing_ball.build(), HALF_EXPLICIT, 1e-5).run(2.0).to_hdf5(path)
    read = only("bouncing-ball", MOREAU_JEAN, time_steps=[1e-3], until=2.0, reference=path)
    made = only("bouncing-ball", MOREAU_JEAN, time_steps=[1e-3], until=2.0, reference=f"{HALF_EXPLICIT}@1e-5")
    assert read == made


def test_rows_left_out_of_a_file_are_interpolated(tmp_path):
    path = tmp_path / "sparse.h5"
    sk.TimeStepping(ball(1.0), HALF_EXPLICIT, 1e-4, record_every=7).run(0.44).to_hdf5(path)
    found = compare(
        lambda: ball(1.0), [HALF_EXPLICIT], baseline=None, time_steps=[1e-3], until=0.44, reference=path
    )
    assert found.rows[0].error_q < 1e-12  # a parabola is exact
    assert found.rows[0].energy_drift is None
    assert any("energy drift cannot be told" in warning for warning in found.warnings)


def test_a_reference_that_is_not_clearly_finer_is_said():
    found = compare("ball-in-box", [HALF_EXPLICIT], reference=f"{HALF_EXPLICIT}@1e-3", timings=0)
    assert any("not a tenth of 0.005" in warning for warning in found.warnings)
    found = compare("ball-in-box", [HALF_EXPLICIT], reference=f"{MOREAU_JEAN}@5e-4", timings=0)
    assert any("not clearly better than HalfExplicit" in warning for warning in found.warnings)
    assert found.reference_moves > 0.1 * found.rows[1].error_q


# ---- Orders


def test_converge_against_ones_own_run():
    found = converge(double_pendulum, [HALF_EXPLICIT, MOREAU_JEAN], time_steps=[4e-3, 2e-3, 1e-3], until=0.5)
    assert [comparison.reference for comparison in found] == [HALF_EXPLICIT, MOREAU_JEAN]
    assert all(comparison.reference_step == pytest.approx(1e-5) for comparison in found)
    assert found[0].orders[HALF_EXPLICIT] == pytest.approx(2.0, abs=0.05)
    assert found[1].orders[MOREAU_JEAN] == pytest.approx(1.0, abs=0.1)
    common = converge(
        double_pendulum,
        [MOREAU_JEAN],
        time_steps=[4e-3, 2e-3],
        until=0.5,
        reference=f"{HALF_EXPLICIT}@1e-5",
    )
    assert common[0].reference == HALF_EXPLICIT
    with pytest.raises(ValueError, match="at least two time steps, got 1"):
        converge(double_pendulum, [MOREAU_JEAN], time_steps=[1e-3], until=0.5)


# ---- The fixture


def test_the_fixture_returns_what_it_found(compare_integrators):
    found = compare_integrators("ball-in-box", [HALF_EXPLICIT], timings=0, max_penetration=0.05)
    assert found.ok


def test_the_fixture_fails_the_test_and_names_the_limit(pytester):
    pytester.makepyfile(
        """
        def test_good(compare_integrators):
            compare_integrators("ball-in-box", ["MoreauJeanOSI"], baseline=None, timings=0, max_error=0.1)

        def test_bad(compare_integrators):
            compare_integrators("ball-in-box", ["MoreauJeanOSI"], baseline=None, timings=0, max_error=1e-6)
        """
    )
    result = pytester.runpytest_subprocess()
    result.assert_outcomes(passed=1, failed=1)
    result.stdout.fnmatch_lines(["*MoreauJeanOSI, Δt = 0.005 s: max-error, * is more than 1e-06*"])
