"""The error-controlled scheme: motions with a closed solution, many cranks without stall, its report."""

import itertools
import json
from dataclasses import replace
from math import asin, cos, pi, sin, sqrt

import numpy as np
import pytest
import saltus.kernel as sk
from saltus._core import SliderCrankParameters
from saltus.cli.app import app
from saltus.cli.reproduce import FIXED_STEPS
from saltus.examples.chain_of_bodies.chain_of_bodies import build as chain
from saltus.examples.disc_pile.disc_pile import build as pile
from saltus.examples.elastic_bar.elastic_bar import build as bar
from saltus.examples.slider_crank.slider_crank import CompiledSliderCorner, CompiledSliderCrank
from saltus.examples.work_precision import work_precision
from saltus.registry import properties
from typer.testing import CliRunner

GRAVITY = 9.81


def adaptive(tolerance, **options):
    return sk.AdaptiveHalfExplicitOSI(rtol=tolerance, atol=tolerance, **options)


# ---- Stick and slip on a belt: a mass on a spring, pressed on a belt that moves with the speed B

MASS, STIFFNESS, MU, B = 1.0, 100.0, 0.5, 0.3
OMEGA = sqrt(STIFFNESS / MASS)
LIMIT = MU * MASS * GRAVITY / STIFFNESS  #: where the spring holds friction [m]


class Belt(sk.LagrangianRheonomousR):
    """A floor that moves by B t."""

    def __init__(self):
        super().__init__(size=2)

    def gap(self, t, q, out):
        out[0] = q[1]

    def jacobian(self, t, q, out):
        out[:] = [[0.0, 1.0], [1.0, 0.0]]

    def motion(self, t, q, out):
        out[:] = [0.0, -B]


def on_the_belt():
    block = sk.LagrangianLinearTIDS(
        [0.0, 0.0],
        [0.0, 0.0],
        MASS * np.eye(2),
        stiffness=np.diag([STIFFNESS, 0.0]),
        external_force=[0.0, -MASS * GRAVITY],
    )
    system = sk.NonSmoothDynamicalSystem([block])
    system.link(sk.Interaction(Belt(), sk.NewtonImpactFrictionNSL(0.0, 0.0, MU, 2), name="belt"), block)
    return system


def exact_on_the_belt(t):
    """It slides until it has the belt's speed, rides until the spring tears it off, then swings."""
    caught = asin(B / (OMEGA * LIMIT)) / OMEGA
    place = LIMIT * (1 - cos(OMEGA * caught))
    torn = caught + (LIMIT - place) / B
    if t <= caught:
        return LIMIT * (1 - cos(OMEGA * t))
    if t <= torn:
        return place + B * (t - caught)
    return LIMIT + B / OMEGA * sin(OMEGA * (t - torn))


@pytest.mark.parametrize("method", ["third-order", "trapezoidal"])
@pytest.mark.parametrize("tolerance", [1e-5, 1e-7, 1e-9])
def test_stick_and_slip_on_a_belt(tolerance, method):
    run = sk.TimeStepping(on_the_belt(), adaptive(tolerance, method=method), time_step=1e-3).run(1.5)
    exact = np.array([exact_on_the_belt(t) for t in run.t])
    assert np.abs(run.q[:, 0] - exact).max() <= 100 * tolerance


# ---- Impacts


def test_an_oblique_impact_with_tangential_restitution():
    """ε_T in flight: γ⁺ = −ε γ⁻ in both directions if the impulse is within the cone."""
    point = sk.LagrangianLinearTIDS([0.0, 1.0], [0.2, 0.0], np.eye(2), external_force=[0.0, -GRAVITY])
    system = sk.NonSmoothDynamicalSystem([point])
    law = sk.NewtonImpactFrictionNSL(0.6, 0.4, 1.0, 2)
    floor = sk.LagrangianLinearTIR([[0.0, 1.0], [1.0, 0.0]], [0.0, 0.0])
    system.link(sk.Interaction(floor, law, name="floor"), point)
    run = sk.TimeStepping(system, adaptive(1e-8), time_step=1e-2).run(0.6)
    fall = sqrt(2 / GRAVITY)
    speed = 0.6 * GRAVITY * fall
    flight = run.t[-1] - fall
    assert run.v[-1] == pytest.approx([-0.4 * 0.2, speed - GRAVITY * flight], abs=1e-10)
    assert run.q[-1, 1] == pytest.approx(speed * flight - GRAVITY * flight**2 / 2, abs=1e-10)
    assert run["floor"].impulse.sum(axis=0) == pytest.approx([1.6 * GRAVITY * fall, -1.4 * 0.2], abs=1e-10)


def crank(restitution, tangential, mu, q, v):
    parameters = SliderCrankParameters()
    system = sk.NonSmoothDynamicalSystem([CompiledSliderCrank(q, v, parameters)])
    law = sk.NewtonImpactFrictionNSL(restitution, tangential, mu, 2)
    for xi, eta in itertools.product((-parameters.a, parameters.a), (-parameters.b, parameters.b)):
        corner = CompiledSliderCorner(xi, eta, 2, parameters)
        system.link(sk.Interaction(corner, law, name=f"{xi}, {eta}"), system.systems[0])
    return system


def test_random_cranks_do_not_stall():
    random, parameters = np.random.default_rng(20), SliderCrankParameters()
    for _ in range(100):
        angle = random.uniform(0.0, 2 * pi)
        q = [angle, -asin(parameters.l1 / parameters.l2 * sin(angle)), random.uniform(-1e-3, 1e-3)]
        v = [random.uniform(-200, 200), random.uniform(-100, 100), random.uniform(-20, 20)]
        system = crank(random.uniform(0, 0.9), random.choice([0.0, 0.4]), random.uniform(0, 0.6), q, v)
        tolerance = 10 ** random.uniform(-8, -4)
        run = sk.TimeStepping(system, adaptive(tolerance), time_step=1e-3).run(0.1)
        assert run.accepted_steps.sum() < 2e4
        assert run.penetration[1:].max() < 1e-2 * tolerance + 1e-5 * tolerance**0.5


# ---- Models of other kinds


@pytest.mark.parametrize(
    ("build", "dt", "until", "bound"),
    [
        (lambda: chain(5, 1.0), 1e-3, 0.3, 100),  # joints, bodies in space
        (lambda: bar(20), 1e-6, 3e-4, 100),  # a sparse system that hits a wall
        (lambda: pile(2), 1e-3, 0.4, 100),  # many contacts with friction
    ],
    ids=["chain", "bar", "pile"],
)
def test_positions_converge_with_the_tolerance(build, dt, until, bound):
    ends = [sk.TimeStepping(build(), adaptive(10.0**-k), dt).run(until).q[-1] for k in (9, 7, 5)]
    for tolerance, end in ((1e-7, ends[1]), (1e-5, ends[2])):
        assert np.abs(end - ends[0]).max() <= bound * tolerance


# ---- What it says about itself


def test_the_report_counts_inner_steps():
    run = sk.TimeStepping(crank(0.4, 0.0, 0.01, [0.0] * 3, [150.0, -75.0, 0.0]), adaptive(1e-6), 1e-4).run(
        0.1
    )
    assert run.accepted_steps[0] == 0
    assert 500 < run.accepted_steps.sum() < 3000
    assert 0 < run.rejected_steps.sum() < 100
    assert run.impulsive.sum() <= run.event_steps.sum() < 200
    assert 0 < run.captures.sum() <= run.event_steps.sum()
    fixed = sk.TimeStepping(crank(0.4, 0.0, 0.01, [0.0] * 3, [150.0, -75.0, 0.0]), "MoreauJeanOSI", 1e-4)
    assert fixed.run(0.01).accepted_steps.sum() == 0


def test_inner_steps_grow_with_the_tolerance_to_the_minus_third():
    counts = []
    for tolerance in (1e-6, 1e-9):
        run = sk.TimeStepping(
            crank(0.4, 0.0, 0.01, [0.0] * 3, [150.0, -75.0, 0.0]), adaptive(tolerance), 1e-3
        )
        counts.append(run.run(0.1).accepted_steps.sum())
    assert counts[1] / counts[0] == pytest.approx(10, rel=0.15)


def test_claims():
    claims = properties("AdaptiveHalfExplicitOSI")
    assert claims["error_controlled"]
    assert claims["friction"]
    assert not properties("HalfExplicitTrapezoidalOSI")["error_controlled"]


def test_misuse_names_what_was_expected():
    with pytest.raises(ValueError, match=r"rtol must be in \[1e-13, 1\), got 0"):
        sk.AdaptiveHalfExplicitOSI(rtol=0)
    with pytest.raises(ValueError, match="minimum_step must be finite and not negative, got -1"):
        sk.AdaptiveHalfExplicitOSI(minimum_step=-1)
    with pytest.raises(ValueError, match="method must be one of third-order, trapezoidal, got 'Euler'"):
        sk.AdaptiveHalfExplicitOSI(method="Euler")


def test_work_precision_of_the_crank(tmp_path, monkeypatch):
    short = replace(work_precision.CRANK, time_steps=(1e-4, 1e-5), tolerances=(1e-5, 1e-7))
    monkeypatch.setattr(work_precision, "CRANK", short)
    result = CliRunner().invoke(app, ["reproduce", "work-precision", "--json", "--out", str(tmp_path)])
    assert result.exit_code == 0, result.output
    rows = [work_precision.Row(**row) for row in json.loads(result.stdout)["rows"]]
    assert (tmp_path / "work-precision.png").stat().st_size > 10_000
    errors = {(row.integrator, row.setting): row.error for row in rows}
    assert len(errors) == 10
    for name in work_precision.ADAPTIVE:
        assert errors[name, "rtol=atol=1e-05"] < 1e-3
        assert errors[name, "rtol=atol=1e-07"] < 1e-5
    for name in FIXED_STEPS:  # of first order across impacts
        ratio = errors[name, "time_step=0.0001"] / errors[name, "time_step=1e-05"]
        assert 5 < ratio < 20
    assert all(row.ms > 0 for row in rows)


def test_errors_between_runs_lie_on_a_line_of_logarithms():
    rows = [work_precision.Row("A", "", error, ms) for ms, error in ((1, 1e-1), (10, 1e-2), (100, 1e-4))]
    assert work_precision.error_at(rows, "A", 10**0.5) == pytest.approx(10**-1.5)
    assert work_precision.error_at(rows, "A", 1000) == pytest.approx(1e-6)
    assert work_precision.error_at(rows, "A", 0.1) == pytest.approx(1.0)


def test_studies_of_other_motions():
    """The finest run of each integrator is not the worst one, and the tolerance is met."""
    for study in work_precision.STUDIES[:2]:
        rows = list(work_precision.rows(study, lambda _what, _done: None))
        for name in dict.fromkeys(row.integrator for row in rows):
            own = [row for row in rows if row.integrator == name]
            assert own[-1].error < 0.5 * own[0].error, name
        met = [row for row in rows if row.integrator in work_precision.ADAPTIVE]
        for row in met:
            assert row.error < 100 * float(row.setting.rpartition("=")[2])


# ---- What once went wrong


class Switched(sk.LagrangianDS):
    """A force of 1 N and of −2 N in turns of 1/30 s."""

    def mass(self, q, out):
        out[0, 0] = 1.0

    def forces(self, t, q, v, out):
        out[0] = 1.0 if int(30 * t) % 2 == 0 else -2.0


@pytest.mark.parametrize("dt", [0.03, 0.01, 0.001])
def test_forces_that_switch_are_not_stepped_over(dt):
    run = sk.TimeStepping(sk.NonSmoothDynamicalSystem([Switched([0.0], [0.0])]), adaptive(1e-6), dt).run(0.96)
    whole, rest = divmod(round(30 * run.t[-1] * 1e6), 2_000_000)
    left = rest / 1e6
    exact = (-whole + min(left, 1.0) - 2 * max(left - 1.0, 0.0)) / 30
    assert run.v[-1, 0] == pytest.approx(exact, abs=1e-4)


@pytest.mark.parametrize("ratio", [10.0, 1000.0])
def test_a_stack_of_masses_comes_to_rest_without_stall(ratio):
    """Contacts that accumulate together open each other in turns."""
    masses = [
        sk.LagrangianLinearTIDS([0.11 * k + 0.01], [0.0], [[ratio**k]], external_force=[-GRAVITY * ratio**k])
        for k in range(3)
    ]
    system = sk.NonSmoothDynamicalSystem(masses)
    law = sk.NewtonImpactNSL(0.3)
    system.link(sk.Interaction(sk.LagrangianLinearTIR([[1.0]]), law, name="floor"), masses[0])
    for below, above in itertools.pairwise(masses):
        between = sk.LagrangianLinearTIR([[-1.0, 1.0]], [-0.1])
        system.link(sk.Interaction(between, law), below, above)
    run = sk.TimeStepping(system, adaptive(1e-6), 1e-3).run(0.5)
    assert run.accepted_steps.sum() < 5000
    assert run.q[-1] == pytest.approx([0.0, 0.1, 0.2], abs=1e-8)


class Cracking(sk.LagrangianScleronomousR):
    """A floor whose gap raises once, at the tenth call and the next ones."""

    def __init__(self):
        super().__init__(size=1)
        self.calls = 0

    def gap(self, q, out):
        self.calls += 1
        if 30 <= self.calls < 34:
            raise ArithmeticError("cracked")
        out[0] = q[0]

    def jacobian(self, q, out):
        out[0, 0] = 1.0


@pytest.mark.parametrize(
    "scheme", [sk.AdaptiveHalfExplicitOSI(), sk.EventDrivenOSI(), sk.HalfExplicitTrapezoidalOSI()], ids=str
)
def test_a_run_goes_on_after_a_gap_that_raised(scheme):
    ball = sk.LagrangianLinearTIDS([1.0], [0.0], [[1.0]], external_force=[-GRAVITY])
    system = sk.NonSmoothDynamicalSystem([ball])
    system.link(sk.Interaction(Cracking(), sk.NewtonImpactNSL(0.5), name="floor"), ball)
    simulation = sk.TimeStepping(system, scheme, 1e-2)
    raised = 0
    while simulation.t < 0.395:
        try:
            simulation.step()
        except ArithmeticError:
            raised += 1
    assert raised > 0
    assert simulation.q[0] == pytest.approx(1.0 - GRAVITY * simulation.t**2 / 2, abs=1e-12)


@pytest.mark.parametrize("method", ["third-order", "trapezoidal"])
def test_mean_forces_keep_their_laws_and_the_momentum(method):
    mu = 0.01
    system = crank(0.4, 0.0, mu, [0.0] * 3, [150.0, -75.0, 0.0])
    run = sk.TimeStepping(system, adaptive(1e-6, method=method), 1e-5).run(0.05)
    for name in run.contacts:
        force = run[name].force
        assert force[:, 0].min() > -1e-9
        assert (np.abs(force[:, 1]) - mu * force[:, 0]).max() < 1e-8
