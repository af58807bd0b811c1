"""What conformance measures, on schemes whose figures are known in closed form."""

import json

import pytest
import saltus.kernel as sk
from saltus import conformance, registry
from saltus.cli.app import app
from saltus.conformance import measure
from saltus.conformance.defects import Mended, drift, from_touch
from saltus.conformance.models import double_pendulum, exact_double_pendulum
from saltus.examples.extending.trapezoidal_moreau import TrapezoidalMoreauOSI
from typer.testing import CliRunner

PREDICTED = "HalfExplicitTrapezoidalOSI(activity=predicted)"


def figures(spec):
    return {finding.quantity: finding for finding in conformance.check(spec)}


def saltus(*arguments):
    return CliRunner().invoke(app, ["conformance", *arguments])


@pytest.mark.parametrize(
    ("spec", "limit", "note"),
    [
        ("HalfExplicitTrapezoidalOSI", 2.0, ""),
        ("DMinusAccelerationOSI", 2.0, ""),
        ("MoreauJeanOSI", 4.0, "or more"),
        ("MoreauJeanOSI(theta=1)", 4.0, "or more"),
        ("ExplicitMoreauJeanOSI", 0.0, "none"),  # Euler's method: |1 + iωΔt| > 1
        ("MoreauJeanOSI(theta=0.49)", 0.0, "none"),
    ],
)
def test_stability_limits_of_an_oscillator(spec, limit, note):
    found = measure.stability_limit(lambda: registry.make_integrator(spec))
    assert found.measured == pytest.approx(limit, abs=1e-6)
    assert found.note.startswith(note)


class RungeKuttaOSI(sk.OneStepIntegrator):
    """Explicit methods for free motion."""

    A, b = (), ()

    def prepare(self, system, solver):
        self.at = sk.Configuration(system)

    def step(self, dt, state, reactions):
        rates = []
        for row in self.A:
            self.at.move_to(state.q + dt * sum(a * v for a, (v, _) in zip(row, rates, strict=True)))
            v = state.v + dt * sum(a * w for a, (_, w) in zip(row, rates, strict=True))
            rates.append((v, self.at.solve_mass(self.at.forces(state.t, v))))
        state.q = state.q + dt * sum(b * v for b, (v, _) in zip(self.b, rates, strict=True))
        state.v = state.v + dt * sum(b * w for b, (_, w) in zip(self.b, rates, strict=True))
        state.t += dt
        return sk.StepReport()


class HeunOSI(RungeKuttaOSI):
    A, b = ((), (1.0,)), (0.5, 0.5)


class ThirdOrderOSI(RungeKuttaOSI):
    A, b = ((), (1 / 3,), (0, 2 / 3)), (1 / 4, 0, 3 / 4)


class ClassicOSI(RungeKuttaOSI):
    A, b = ((), (1 / 2,), (0, 1 / 2), (0, 0, 1)), (1 / 6, 1 / 3, 1 / 3, 1 / 6)


class FifthOrderOSI(RungeKuttaOSI):
    A = (
        (),
        (1 / 4,),
        (1 / 8, 1 / 8),
        (0, 0, 1 / 2),
        (3 / 16, -3 / 8, 3 / 8, 9 / 16),
        (-3 / 7, 8 / 7, 6 / 7, -12 / 7, 8 / 7),
    )
    b = (7 / 90, 0, 16 / 45, 2 / 15, 16 / 45, 7 / 90)


@pytest.mark.parametrize(("scheme", "limit"), [(HeunOSI, 0.0), (ThirdOrderOSI, 3**0.5), (ClassicOSI, 8**0.5)])
def test_stability_limits_of_runge_kutta_methods(scheme, limit):
    assert measure.stability_limit(scheme).measured == pytest.approx(limit, abs=1e-6)


@pytest.mark.parametrize(("scheme", "order"), [(ThirdOrderOSI, 3), (ClassicOSI, 4), (FifthOrderOSI, 5)])
def test_high_orders_are_measured_above_rounding(scheme, order):
    def found(claim):
        exact = exact_double_pendulum(0.5)
        return list(measure.orders("free", claim, scheme, double_pendulum, exact, 0.5, measure.FREE_STEPS))

    for finding in found(order):
        assert finding.measured == pytest.approx(order, abs=0.2)
        assert finding.ok
    assert not any(finding.ok for finding in found(order + 1))


def test_phases_of_an_impact():
    found = figures("HalfExplicitTrapezoidalOSI")
    for kind in ("mean", "lowest", "highest"):
        finding = found[f"restitution 0.3, 1000 phases: {kind}"]
        assert finding.measured == pytest.approx(0.3, abs=1e-12)
        assert finding.expected
    # Nearly a whole step under the floor, at the speed of the fall then: 4 m/s and ten steps of gravity.
    depth = found["penetration at an impact / (speed Δt): largest"]
    assert depth.measured == pytest.approx(1.0, abs=5e-3)
    assert not depth.expected


def test_the_predicted_activity_is_measured_but_not_judged():
    found = figures(PREDICTED)
    mean = found["restitution 0.3, 1000 phases: mean"]
    assert mean.measured == pytest.approx(0.2, abs=0.01)
    assert found["restitution 0.3, 1000 phases: lowest"].measured < 0.01
    assert mean.ok
    assert not mean.expected
    assert "restitution 0.6: deviation" not in found


def test_the_known_defects_are_seen_where_they_are():
    half, acceleration = figures("HalfExplicitTrapezoidalOSI"), figures("DMinusAccelerationOSI")
    classic, predicted = figures("ExplicitMoreauJeanOSI"), figures(PREDICTED)
    jump = "jump of a block at rest by an impact / (ε g Δt)"
    assert [found[jump].measured for found in (half, classic)] == pytest.approx([1.0, 0.0], abs=1e-12)
    start = "closed at t0, restitution 0.9: -v⁺/v⁻"
    assert [found[start].measured for found in (half, acceleration, classic)] == pytest.approx(
        [0.0, -1.0, 0.9], abs=1e-12
    )
    rest = "ball after its bounces: speed [m/s]"
    assert half[rest].measured < 1e-12
    assert acceleration[rest].measured > 1e-3
    assert half["bilateral constraint, Δt = 1 ms: |ġ| [m/s]"].measured < 1e-14
    assert acceleration["bilateral constraint, Δt = 1 ms: |ġ| [m/s]"].measured > 1e-7
    across = "order of q, across an impact"
    assert half[across].measured == pytest.approx(1.0, abs=0.2)
    assert predicted[across].measured == pytest.approx(0.0, abs=0.2)  # the error stays
    turning = "order of q, sliding that turns in space"
    assert half[turning].measured == pytest.approx(2.0, abs=0.1)
    assert turning not in acceleration
    assert acceleration["order of q, lasting contact"].measured == pytest.approx(1.0, abs=0.1)


FROM_TOUCH = [f"order of {symbol}, sliding from g = 0" for symbol in "qv"]
IMPACTS = "sliding from g = 0: impacts in four runs"
DRIFT = "bilateral constraint, Δt = 1 ms: |g| [m]"
JUMP = "jump of a block at rest by an impact / (ε g Δt)"
DEPTH = "penetration at an impact / (speed Δt): largest"
ERROR = "error of q across an impact, Δt = 1 ms [m]"


def runge_kutta(options):
    return figures(f"HalfExplicitRungeKuttaOSI({options})")


def test_what_an_option_mends_is_judged_with_it_alone():
    plain = runge_kutta("tableau=Kutta3")
    for name in (*FROM_TOUCH, IMPACTS, DRIFT, JUMP):
        assert not plain[name].expected
    for name in FROM_TOUCH:
        assert plain[name].measured == pytest.approx(2.0, abs=0.1)  # of a third-order scheme
    assert plain[IMPACTS].measured >= 4
    assert plain[DRIFT].measured > 1e-10
    assert plain[JUMP].measured == pytest.approx(1.0, abs=1e-12)

    sticky = runge_kutta("tableau=Kutta3, activity=sticky")
    stabilised = runge_kutta("tableau=Kutta3, stabilization=position")
    for found in (sticky, stabilised):
        for name in FROM_TOUCH:
            assert found[name].measured == pytest.approx(3.0, abs=0.1)
            assert (found[name].ok, found[name].expected) == (True, ">= 2.8")
        assert (found[IMPACTS].measured, found[IMPACTS].expected) == (0, "0")
    assert not sticky[DRIFT].expected
    assert (stabilised[DRIFT].ok, stabilised[DRIFT].expected) == (True, "<= 1e-12")

    keeping = runge_kutta("impact=keep-resting-forces")[JUMP]
    assert (keeping.ok, keeping.expected) == (True, "<= 1e-9")
    assert keeping.measured == 0.0


def test_impulsive_steps_in_ten_parts_make_a_tenth_of_depth_and_error():
    whole, parts = runge_kutta(""), runge_kutta("impulsive_substeps=10")
    assert parts[DEPTH].measured == pytest.approx(0.1, rel=0.02)
    assert whole[ERROR].measured / parts[ERROR].measured == pytest.approx(10.0, rel=0.1)


def test_an_option_that_mends_nothing_is_bad():
    class IdleOSI(TrapezoidalMoreauOSI):
        properties = {"order_free": 2, "forces_at_rest": True}

        def __init__(self):
            super().__init__()
            self.stabilization = "position"
            self.impact = "keep-resting-forces"

    options = IdleOSI().options
    for found in (drift(IdleOSI, holds=Mended.by(options).drift), from_touch(IdleOSI, 0.3, 2, holds=True)):
        assert not all(finding.ok for finding in found)
    assert Mended.by(options) == Mended(opening=True, drift=True, jump=True)


HALF_EXPLICIT = [
    f"HalfExplicitRungeKuttaOSI(tableau={tableau}, {activity})"
    for tableau in ("Heun", "third-order", "Kutta3", "RK4", "HEM5")
    for activity in ("activity=start", "activity=sticky", "activity=predicted", "stabilization=position")
]


@pytest.mark.parametrize("spec", HALF_EXPLICIT)
def test_every_half_explicit_scheme_keeps_its_claims(spec):
    assert [str(finding) for finding in conformance.check(spec) if not finding.ok] == []


def test_properties_follow_the_options():
    assert registry.properties("MoreauJeanOSI")["order_free"] == 2
    assert registry.properties("MoreauJeanOSI(theta=1)")["order_free"] == 1
    assert registry.properties("HalfExplicitTrapezoidalOSI")["impact_law"] is True
    assert registry.properties(PREDICTED)["impact_law"] is False
    with pytest.raises(ValueError, match="no option 'size'"):
        registry.properties("MoreauJeanOSI(size=1)")


def test_the_command_takes_options_and_prints_json_alone():
    result = saltus("MoreauJeanOSI(theta=1)", PREDICTED, "--json")
    assert result.exit_code == 0, result.output
    content = json.loads(result.stdout)
    assert content["ok"] is True
    assert [row["integrator"] for row in content["integrators"]] == ["MoreauJeanOSI(theta=1)", PREDICTED]
    found = {finding["quantity"]: finding for finding in content["integrators"][1]["findings"]}
    mean = found["restitution 0.3, 1000 phases: mean"]
    assert set(mean) == {"quantity", "measured", "expected", "ok", "note"}
    assert mean["measured"] == pytest.approx(0.2, abs=0.01)
    assert mean["expected"] is None
    assert found["order of q, free motion"]["expected"] == ">= 1.8"
    assert not any("µs" in quantity for quantity in found)


def test_the_command_measures_the_cost_when_asked(monkeypatch):
    monkeypatch.setattr("saltus.cli.conformance.REPEATS", 1)
    for spec, note in (
        ("DMinusAccelerationOSI", "without friction"),
        ("MoreauJeanOSI(theta=1)", "the bare loop"),
    ):
        [row] = json.loads(saltus(spec, "--cost", "--json").stdout)["integrators"]
        cost = row["findings"][-1]
        assert cost["quantity"] == "slider crank: µs a step"
        assert cost["measured"] > 0
        assert cost["note"].endswith(note)


def test_a_wrong_claim_is_bad_and_1(tmp_path):
    source = "from saltus.examples.extending.trapezoidal_moreau import TrapezoidalMoreauOSI\n\n\n"
    source += (
        "class BoastfulOSI(TrapezoidalMoreauOSI):\n    properties = {'order_free': 2, 'order_sliding': 2}\n"
    )
    (tmp_path / "boast.py").write_text(source)
    result = saltus(f"{tmp_path}/boast.py:BoastfulOSI")
    assert result.exit_code == 1
    bad = [line for line in result.stdout.splitlines() if line.startswith("BAD")]
    kinds = ("sliding", "sliding that turns in space")
    assert [line.split("  ")[1] for line in bad] == [f"order of {x}, {kind}" for kind in kinds for x in "qv"]
    assert all("expected >= 1.8" in line for line in bad)


def test_misuse_is_2(capsys):
    for spec, message in (
        ("NoSuchOSI", "no integrator named"),
        ("MoreauJeanOSI(theta=2)", "theta must be in"),
    ):
        result = saltus(spec)
        assert result.exit_code == 2
        assert message in result.output + capsys.readouterr().err
