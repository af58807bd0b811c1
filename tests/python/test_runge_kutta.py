"""Half-explicit Runge-Kutta schemes: tableaux by name and of one's own, their options, and the mean force."""

import itertools
import json

import numpy as np
import pytest
import saltus.kernel as sk
from saltus import registry
from saltus.cli.app import app
from saltus.conformance.models import GRAVITY, RADIUS, RATE, START, ball, pendulum, touching_bowl
from saltus.examples.slider_crank import slider_crank
from saltus.io import read_hdf5
from scipy.integrate import solve_ivp
from typer.testing import CliRunner

NAME = "HalfExplicitRungeKuttaOSI"
ORDERS = {"Heun": (2, 2), "third-order": (3, 3), "Kutta3": (3, 3), "RK4": (4, 3), "HEM5": (5, 5)}
RK4 = ([[0, 0, 0, 0], [0.5, 0, 0, 0], [0, 0.5, 0, 0], [0, 0, 1, 0]], np.array([1, 2, 2, 1]) / 6)
RALSTON = ([[0, 0, 0], [1 / 2, 0, 0], [0, 3 / 4, 0]], [2 / 9, 1 / 3, 4 / 9])


def spec(tableau, **options):
    return (
        f"{NAME}({', '.join(f'{name}={value}' for name, value in {'tableau': tableau, **options}.items())})"
    )


# ---- Tableaux by name


@pytest.mark.parametrize("tableau", ORDERS)
def test_a_scheme_is_swapped_in_with_one_word(tableau):
    run = sk.TimeStepping(ball(0.05, 0.5), spec(tableau), 1e-3).run(0.6)
    assert run.provenance.integrator == NAME
    assert run.provenance.options["tableau"] == tableau
    last = run["floor"]
    assert last.force[-1, 0] == pytest.approx(9.81, abs=1e-9)
    assert last.impulse[-1, 0] == 0.0
    assert abs(run.v[-1, 0]) < 1e-12


@pytest.mark.parametrize(("tableau", "orders"), ORDERS.items())
def test_the_table_knows_the_orders_of_each_tableau(tableau, orders):
    claims = registry.properties(spec(tableau))
    assert (claims["order_free"], claims["order_bilateral"]) == orders
    assert claims["order_sliding"] == orders[1]
    assert claims["impact_law"]
    assert not registry.properties(spec(tableau, activity="predicted"))["impact_law"]


def test_options_are_listed_with_their_choices():
    [entry] = [entry for entry in sk.integrators() if entry["name"] == NAME]
    assert entry["options"]["tableau"]["choices"] == list(ORDERS)
    assert entry["options"]["tableau"]["default"] == "third-order"
    with pytest.raises(ValueError, match="tableau.*Heun, third-order, Kutta3, RK4, HEM5.*'RK5'"):
        registry.make_integrator(spec("RK5"))
    with pytest.raises(ValueError, match="stabilization = position takes the activity sticky, got predicted"):
        registry.make_integrator(spec("RK4", stabilization="position", activity="predicted"))


# ---- Tableaux of one's own


def test_a_tableau_gives_back_what_it_was_made_of():
    tableau = sk.Tableau(*RALSTON, name="Ralston")
    np.testing.assert_array_equal(tableau.A, RALSTON[0])
    np.testing.assert_array_equal(tableau.b, RALSTON[1])
    np.testing.assert_array_equal(tableau.c, [0, 1 / 2, 3 / 4])
    assert tableau.name == "Ralston"
    assert repr(tableau) == "<Tableau Ralston>"
    assert tableau.order == (3, 2)


def test_a_tableau_cannot_be_changed_by_its_arrays():
    A, b = np.array(RALSTON[0]), np.array(RALSTON[1])
    tableau = sk.Tableau(A, b)
    A[1, 0], b[0] = 7.0, 7.0
    for array in (tableau.A, tableau.b, tableau.c):
        array += 1.0
    np.testing.assert_array_equal(tableau.A, RALSTON[0])
    np.testing.assert_array_equal(tableau.b, RALSTON[1])
    np.testing.assert_array_equal(tableau.c, [0, 1 / 2, 3 / 4])
    for name in ("A", "b", "c", "name", "order"):
        with pytest.raises(AttributeError):
            setattr(tableau, name, None)


def test_a_tableau_runs_as_the_one_of_that_name_and_brings_its_orders():
    own = sk.HalfExplicitRungeKuttaOSI(tableau=sk.Tableau(*RK4, name="mine", order=(4, 3)), activity="sticky")
    named = sk.HalfExplicitRungeKuttaOSI(tableau="RK4", activity="sticky")
    one, other = (sk.TimeStepping(touching_bowl(0.3), scheme, 1e-3).run(0.1) for scheme in (own, named))
    np.testing.assert_array_equal(one.q, other.q)
    np.testing.assert_array_equal(one["circle"].force, other["circle"].force)
    claims = sk._core.integrator_properties(NAME, own.options)
    assert (claims["order_free"], claims["order_bilateral"]) == (4, 3)


@pytest.mark.parametrize(
    ("A", "b", "order", "words"),
    [
        (*RK4, 5, r"tableau 'mine': order 5 claimed, but Σ b_i c_i\^4 = 0.208333333333333, must be 1/5"),
        (*RK4, (4, 4), r"order 4 with multipliers claimed, but .* = 0.125, must be 1/6, where \(ω\) is the"),
        (*RALSTON, 7, "order 7 claimed, but conditions are known up to order 6"),
        ([[0]], [1.1], None, "row 1 must sum up to 1"),
        ([[0, 0]], [1.0], None, r"A must be \(1, 1\) as b has 1 entries, got \(1, 2\)"),
        ([[0, 0], [1, 0.5]], [0.5, 0.5], None, r"A\[1, 1\] must be 0, on or above the diagonal"),
        ([[0, 0], [1, 0]], [1.0, 0.0], None, r"a_\{l,l-1\} must be positive in row 2, got 0"),
        ([[0, 0], [-1, 0]], [0.5, 0.5], None, r"a_\{l,l-1\} must be positive in row 1, got -1"),
        ([[0, 0], [1, 0]], [0.5, np.nan], None, r"b\[1\] must be finite"),
        (np.zeros((0, 0)), [], None, "needs at least one stage"),
    ],
)
def test_what_is_no_tableau_or_no_such_order_is_refused(A, b, order, words):
    with pytest.raises(ValueError, match=words):
        sk.Tableau(A, b, name="mine", order=order)


def test_an_order_is_a_number_or_two():
    for order in ("high", "45", True, -1, (-3, 2), 2.5, (1, 2, 3)):
        with pytest.raises(TypeError, match="order must be a whole number, or two of them, from 0 on; got "):
            sk.Tableau(*RK4, order=order)
    for right in (4, np.int64(4), (4, 3)):
        assert sk.Tableau(*RK4, order=right).order == (4, 3)


def test_options_take_numbers_of_numpy_and_say_what_runs():
    scheme = sk.HalfExplicitTrapezoidalOSI(impulsive_substeps=np.int64(10), stabilization="position")
    assert scheme.options["impulsive_substeps"] == 10.0
    assert scheme.options["activity"] == "sticky"  # implied
    run = sk.TimeStepping(ball(0.05, 0.5), scheme, 1e-3).run(0.01)
    assert run.provenance.options["activity"] == "sticky"
    with pytest.raises(TypeError, match="impulsive_substeps must be a number, a word or a Tableau, got bool"):
        sk.HalfExplicitTrapezoidalOSI(impulsive_substeps=True)


def test_a_file_keeps_the_tableau(tmp_path):
    scheme = sk.HalfExplicitRungeKuttaOSI(tableau=sk.Tableau(*RALSTON, name="Ralston"))
    run = sk.TimeStepping(ball(0.05, 0.5), scheme, 1e-3, file=tmp_path / "run.h5").run(0.2)
    again = sk.TimeStepping(ball(0.05, 0.5), scheme, 1e-3).run(0.2)
    for path in (tmp_path / "run.h5", again.to_hdf5(tmp_path / "again.h5")):
        back = read_hdf5(path)
        np.testing.assert_array_equal(back["floor"].force, run["floor"].force)
        kept = back.provenance.options["tableau"]
        assert kept == {"name": "Ralston", "A": RALSTON[0], "b": RALSTON[1]}
        made = sk.Tableau(**kept)
        replay = sk.TimeStepping(ball(0.05, 0.5), sk.HalfExplicitRungeKuttaOSI(made), 1e-3).run(0.2)
        np.testing.assert_array_equal(replay.q, run.q)


# ---- The mean force


@pytest.mark.parametrize("activity", ["start", "sticky"])
def test_the_force_of_the_trapezoidal_rule_is_the_mean_of_both(activity):
    scheme = sk.HalfExplicitTrapezoidalOSI(activity=activity)
    run = sk.TimeStepping(slider_crank.build("frictional"), scheme, 1e-4).run(0.05)
    for name in run.contacts:
        record = run[name]
        mean = 0.5 * (record.lambda_plus + record.lambda_minus)
        np.testing.assert_allclose(record.force, mean, rtol=1e-15, atol=0)
    assert any(run[name].force.any() for name in run.contacts)


class Loaded(sk.LagrangianDS):
    """1 kg that a load which changes in time presses on the floor."""

    def mass(self, q, out):
        out[0, 0] = 1.0

    def forces(self, t, q, v, out):
        out[0] = -np.exp(3.0 * t)


@pytest.mark.parametrize(("tableau", "order"), [("Heun", 2), ("third-order", 3), ("RK4", 4), ("HEM5", 5)])
def test_the_mean_force_carries_the_momentum_of_a_varying_load(tableau, order):
    """At rest every multiplier is the load at its stage: their mean is the quadrature b, c of the load."""
    errors = []
    for steps in (4, 8, 16):
        body = Loaded([-1e-4], [0.0])
        system = sk.NonSmoothDynamicalSystem([body])
        floor = sk.Interaction(sk.LagrangianLinearTIR([[1.0]]), sk.NewtonImpactNSL(0.5), name="floor")
        system.link(floor, body)
        run = sk.TimeStepping(system, spec(tableau), 1.0 / steps).run(1.0)
        assert not run.impulsive.any()
        assert np.abs(run.v).max() < 1e-13
        errors.append(abs(run["floor"].force.sum() / steps - np.expm1(3.0) / 3.0))
    assert 0.5 * np.log2(errors[0] / errors[2]) == pytest.approx(order, abs=0.1)


@pytest.mark.parametrize(
    ("tableau", "order"), [("Heun", 2), ("third-order", 3), ("Kutta3", 3), ("RK4", 3), ("HEM5", 5)]
)
def test_the_mean_force_of_a_pendulum_is_that_of_its_motion(tableau, order):
    """Against ∫ m (R φ̇² + g cos φ) dt."""
    until, first = 0.25, {"HEM5": 5}.get(tableau, 40)

    def rates(t, y):
        return [y[1], -GRAVITY * np.sin(y[0]) / RADIUS, 2 * (RADIUS * y[1] ** 2 + GRAVITY * np.cos(y[0]))]

    exact = solve_ivp(rates, (0, until), [START, RATE, 0], method="DOP853", rtol=1e-13, atol=1e-13).y[2, -1]
    errors = []
    for steps in (first, 2 * first, 4 * first):
        run = sk.TimeStepping(pendulum(), spec(tableau), until / steps).run(until)
        errors.append(abs(run["circle"].force.sum() * until / steps - exact))
    assert np.log2(errors[1] / errors[2]) > order - 0.3


# ---- Options, and the command line


def test_sticky_and_stabilised_contacts_slide_without_an_impact():
    for options in ({"activity": "sticky"}, {"stabilization": "position"}):
        run = sk.TimeStepping(touching_bowl(0.3), spec("RK4", **options), 2e-3).run(0.25)
        assert not run.impulsive.any()
        assert (run["circle"].force[1:, 0] > 0).all()
    plain = sk.TimeStepping(touching_bowl(0.3), spec("RK4"), 2e-3).run(0.25)
    assert plain.impulsive.any()


def test_parts_of_an_impulsive_step_meet_the_impact_more_exactly():
    def depth(parts):
        scheme = spec("third-order", impulsive_substeps=parts)
        heights = 0.01 + 2e-5 * np.arange(50)
        return np.mean([-sk.TimeStepping(ball(h, 0.0), scheme, 1e-3).run(0.06).q[-1, 0] for h in heights])

    assert depth(1) / depth(10) == pytest.approx(10, rel=0.3)


@pytest.mark.parametrize(("omega_dt", "warned"), [(0.01, False), (0.1, False), (0.5, True)])
def test_heun_is_warned_about_where_its_growth_shows(omega_dt, warned, recwarn):
    body = sk.LagrangianLinearTIDS([1.0], [0.0], [[1.0]], [[1.0]])
    sk.TimeStepping(sk.NonSmoothDynamicalSystem([body]), spec("Heun"), omega_dt)
    assert bool(recwarn.list) is warned
    if warned:
        text = str(recwarn.pop(sk.StabilityWarning).message)
        assert "without more damping it grows at every small time_step, up to 0.233" in text
        assert "less than 1 % in a period" in text


@pytest.mark.parametrize("omega_dt", [0.01, 0.1, 0.5])
def test_hem5_is_not_warned_about(omega_dt, recwarn):
    body = sk.LagrangianLinearTIDS([1.0], [0.0], [[1.0]], [[1.0]])
    sk.TimeStepping(sk.NonSmoothDynamicalSystem([body]), spec("HEM5"), omega_dt)
    assert not recwarn.list


def test_a_comparison_takes_them_with_options():
    specs = [
        spec("HEM5", activity="sticky"),
        "HalfExplicitTrapezoidalOSI",
        spec("Heun", impulsive_substeps=10),
    ]
    steps = ["--time-steps", "1e-4", "--until", "0.02", "--reference", "HalfExplicitTrapezoidalOSI@2e-6"]
    words = ["compare", "slider-crank", "--integrators", ",".join(specs), *steps, "--json", "-"]
    result = CliRunner().invoke(app, words)
    assert result.exit_code == 0, result.output
    rows = json.loads(result.stdout)["rows"]
    names = [row["integrator"] for row in rows]
    assert f"{NAME}(tableau=HEM5, activity=sticky)" in names
    assert f"{NAME}(tableau=Heun, impulsive_substeps=10)" in names


COMBINATIONS = list(
    itertools.product(ORDERS, ("start", "sticky", "position"), ("paper", "keep-resting-forces"), (1, 10))
)


@pytest.mark.parametrize(("tableau", "contacts", "impact", "parts"), COMBINATIONS)
def test_every_combination_of_options_runs_the_crank(tableau, contacts, impact, parts):
    held = {"stabilization": "position"} if contacts == "position" else {"activity": contacts}
    scheme = spec(tableau, **held, impact=impact, impulsive_substeps=parts)
    run = sk.TimeStepping(slider_crank.build("frictional"), scheme, 1e-4).run(0.02)
    assert run.impulsive.any()
    balance = run.work_forces + run.work_lambda + run.work_impulse
    kinetic = np.diff(run.kinetic_energy)
    scale = np.abs(run.kinetic_energy).max()
    # Up to the scheme's own error, and what the projection moves.
    assert np.abs(balance[1:] - kinetic).max() < 1e-4 * scale
