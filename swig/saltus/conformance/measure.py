"""What is measured of an integrator, and the verdict about it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from math import sqrt
from typing import TYPE_CHECKING

import numpy as np

import saltus.kernel as sk
from saltus import _core
from saltus.conformance.models import GRAVITY, ball, bowl, exact_top, oscillator, top

if TYPE_CHECKING:
    from saltus.typing import FloatArray

SLACK = 0.2  # of an order below its claim

# Steps of the coarsest of four runs, each with half the Δt of the one before, by the order that is claimed:
# the finest of a high order would otherwise measure rounding, soonest where the motion is a mere swing.
STEPS, FREE_STEPS, SWING_STEPS = 125, {3: 60, 4: 40, 5: 30, 6: 12}, {3: 60, 4: 20, 5: 6, 6: 2}
TURN_STEPS = {3: 60, 4: 100, 5: 40, 6: 24}  # of a slide on a curve, which is slow in the end

PHASES = 1000  # of an impact in its step
SPEED, RESTITUTION, STEP = 4.0, 0.3, 1e-4  # of the ball that meets the floor in them: [m/s], [-], [s]


@dataclass(frozen=True)
class Finding:
    """What is measured of an integrator, and what was expected; a mere figure expects nothing."""

    quantity: str
    measured: float
    expected: str = ""
    ok: bool = True
    note: str = ""

    def __str__(self) -> str:
        verdict = ("ok" if self.ok else "BAD") if self.expected else ""
        remarks = [f"expected {self.expected}"] if self.expected else []
        remarks += [self.note] if self.note else []
        return f"{verdict:<3}  {self.quantity:<50} {self.measured:10.4g}  {', '.join(remarks)}".rstrip()


def end(
    system: sk.NonSmoothDynamicalSystem, scheme: sk.OneStepIntegrator, dt: float, until: float
) -> tuple[FloatArray, FloatArray]:
    """Q and v at the end of a run that is neither recorded nor warned about."""
    simulation = _core.TimeSteppingBase(system, scheme, float(dt), "auto")
    simulation.advance(until, None)
    return simulation.q, simulation.v


# ---- Orders


def slope(steps: FloatArray, errors: FloatArray) -> float:
    """The order that errors show over Δt."""
    return float(np.polyfit(np.log(steps), np.log(np.maximum(errors, 1e-300)), 1)[0])


def slopes(
    make: Callable[[], sk.OneStepIntegrator],
    build: Callable[[], sk.NonSmoothDynamicalSystem],
    exact: tuple[FloatArray, FloatArray],
    until: float,
    coarsest: int,
) -> Iterator[tuple[str, float]]:
    """Of the errors in q and v at the end of a run."""
    steps = until / (coarsest * np.array([1, 2, 4, 8]))
    errors = []
    for dt in steps:
        q, v = end(build(), make(), dt, until)
        errors.append((np.linalg.norm(q - exact[0]), np.linalg.norm(v - exact[1])))
    for symbol, column in zip("qv", np.array(errors).T, strict=True):
        yield symbol, slope(steps, column)


def orders(
    what: str,
    claim: int,
    make: Callable[[], sk.OneStepIntegrator],
    build: Callable[[], sk.NonSmoothDynamicalSystem],
    exact: tuple[FloatArray, FloatArray],
    until: float,
    coarsest: Mapping[int, int] = SWING_STEPS,
) -> Iterator[Finding]:
    """The slopes against the claim."""
    for symbol, order in slopes(make, build, exact, until, coarsest.get(claim, STEPS)):
        yield Finding(f"order of {symbol}, {what}", order, f">= {claim - SLACK:.1f}", order >= claim - SLACK)


def in_space(claim: int, make: Callable[[], sk.OneStepIntegrator]) -> Iterator[Finding]:
    """Orders of a body in space on a joint, if the scheme takes velocities that are not q̇."""
    what, until = "top on a ball joint", 0.2
    try:
        yield from orders(what, claim, make, top, exact_top(until), until, {3: 100, 4: 30, 5: 20, 6: 6})
    except ValueError as error:
        yield Finding(what, float("nan"), note=f"refused: {error}")


# ---- Impacts


def impact_law(make: Callable[[], sk.OneStepIntegrator]) -> Finding:
    """|v⁺/v⁻ + ε| of the first impact, v⁻ being the speed of the fall; steps make an error of a few g Δt."""
    restitution, dt, height = 0.6, 1e-4, 0.2
    run = sk.TimeStepping(ball(height, restitution), make(), dt).run(0.3)
    after = float(run.v[np.flatnonzero(run.impulsive)[0], 0])
    fall = sqrt(2 * GRAVITY * height)
    bound = 3 * GRAVITY * dt / fall
    error = abs(after / fall - restitution)
    return Finding("restitution 0.6: deviation", error, f"<= {bound:.1e}", error <= bound)


def phases(make: Callable[[], sk.OneStepIntegrator], *, holds: bool) -> Iterator[Finding]:
    """Restitution wherever in a step a ball meets the floor, and how far it sinks in.

    Measured by velocities, v⁺ over the speed of free fall: the height of the next flight would bring in the
    penetration. One system a ball: an impact takes λ from all contacts of its system (55).
    """
    scheme = make()
    found = [_meet(scheme, k) for k in range(PHASES)]
    ratios, depths = np.array(found).T
    name = f"restitution {RESTITUTION}, {PHASES} phases"
    for kind, value, slack in (
        ("mean", ratios.mean(), 5e-4),
        ("lowest", ratios.min(), 1e-3),
        ("highest", ratios.max(), 1e-3),
    ):
        ok = bool(abs(value - RESTITUTION) <= slack)
        claim = f"{RESTITUTION} ± {slack:.0e}" if holds else ""
        yield Finding(f"{name}: {kind}", float(value), claim, ok or not holds)
    yield Finding("penetration at an impact / (speed Δt): largest", float(depths.max() / (SPEED * STEP)))


def _meet(scheme: sk.OneStepIntegrator, phase: int) -> tuple[float, float]:
    """v⁺ over the speed of free fall, and the penetration [m], of a ball that starts ten steps above."""
    height = STEP * SPEED * (10.0 + (phase + 0.5) / PHASES)
    simulation = _core.TimeSteppingBase(ball(height, RESTITUTION, -SPEED), scheme, STEP, "auto")
    depth = 0.0
    while simulation.v[0] <= 0.0 and simulation.steps < 30:
        simulation.take_step()
        depth = max(depth, -float(simulation.q[0]))
    return simulation.v[0] / (SPEED + GRAVITY * simulation.t), depth


# ---- Rest


def rest(make: Callable[[], sk.OneStepIntegrator], *, forces: bool) -> Iterator[Finding]:
    """What carries a plastic ball after it has fallen, and whether it still moves."""
    dt = 1e-3
    run = sk.TimeStepping(ball(0.05, 0.0), make(), dt).run(0.5)
    floor, weight = run["floor"], GRAVITY
    speed = abs(float(run.v[-1, 0]))
    yield Finding("ball at rest: speed", speed, "<= 1e-9", speed <= 1e-9)
    force, impulse = float(floor.force[-1, 0]), float(floor.impulse[-1, 0])
    error = max(abs(force - weight), abs(impulse)) if forces else max(abs(force), abs(impulse - weight * dt))
    what = "λ = m g, Λ = 0" if forces else "λ = 0, Λ = m g Δt"
    yield Finding(f"ball at rest: deviation from {what}", error, "<= 1e-9", error <= 1e-9)


# ---- Stability


def stability_limit(make: Callable[[], sk.OneStepIntegrator]) -> Finding:
    """Largest ω Δt up to which q̈ = −ω² q does not grow.

    Weak instability has no limit: what is let pass decides where it begins.
    """
    name, scheme = "stability limit of ω Δt, no damping", make()
    limits = [_largest_bounded(scheme, growth) for growth in (1e-10, 1e-12)]
    if limits[0] == MOST:
        return Finding(name, MOST, note="or more")
    if limits[1] < 0.99 * limits[0]:
        return Finding(name, 0.0, note=f"none: grows, by 1e-10 a step at {limits[0]:.1e}")
    return Finding(name, limits[0])


MOST, FINEST = 4.0, 0.01  # ω Δt of the scan and its resolution, before it is refined


def _largest_bounded(scheme: sk.OneStepIntegrator, growth: float) -> float:
    """Where the scan first meets more growth in a step, by bisection; MOST if nowhere."""
    stable = 0.0
    for unstable in np.arange(FINEST, MOST + 0.5 * FINEST, FINEST):
        if not spectral_radius(scheme, unstable) <= 1.0 + growth:
            break
        stable = float(unstable)
    else:
        return MOST
    for _ in range(40):
        middle = 0.5 * (stable + unstable)
        if spectral_radius(scheme, middle) <= 1.0 + growth:
            stable = middle
        else:
            unstable = middle
    return stable


def spectral_radius(scheme: sk.OneStepIntegrator, omega_dt: float) -> float:
    """Of the step of an oscillator with ω = 1, from (1, 0) and from (0, ω); NaN if it cannot be taken."""
    columns = []
    for start in ((1.0, 0.0), (0.0, 1.0)):
        simulation = _core.TimeSteppingBase(oscillator(*start), scheme, float(omega_dt), "auto")
        try:
            simulation.take_step()
        except sk.SimulationError:
            return float("nan")
        columns.append((simulation.q[0], simulation.v[0]))
    (a, c), (b, d) = columns
    # Not the trace squared less the determinant, whose digits cancel near a double eigenvalue.
    discriminant = 0.25 * (a - d) ** 2 + b * c
    return sqrt(a * d - b * c) if discriminant < 0 else abs(0.5 * (a + d)) + sqrt(discriminant)


# ---- The rest


def refusal(make: Callable[[], sk.OneStepIntegrator]) -> Finding:
    """Friction must be refused with ValueError."""
    try:
        sk.TimeStepping(bowl(), make(), 1e-3)
    except ValueError as error:
        return Finding("friction refused by name", 1.0, "1", "friction" in str(error))
    return Finding("friction refused by name", 0.0, "1", False)


def repeats(make: Callable[[], sk.OneStepIntegrator]) -> Finding:
    """Two runs at the same time, step by step in turn, and one alone: to the last bit."""
    scheme = make()
    one, two = (sk.TimeStepping(ball(0.05, 0.5), scheme, 1e-3) for _ in range(2))
    for _ in range(300):
        one.step()
        two.step()
    alone = sk.TimeStepping(ball(0.05, 0.5), make(), 1e-3).run(0.3)
    runs = (one.trajectory, two.trajectory)
    same = all(np.array_equal(run.q, alone.q) and np.array_equal(run.v, alone.v) for run in runs)
    return Finding("equal runs to the last bit", float(same), "1", same)
