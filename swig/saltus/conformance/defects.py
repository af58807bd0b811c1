"""Figures of what schemes do not do well: to choose by, with a verdict only where an option mends it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from math import hypot
from typing import Any

import numpy as np

import saltus.kernel as sk
from saltus import _core
from saltus.conformance.measure import (
    SLACK,
    STEPS,
    SWING_STEPS,
    TURN_STEPS,
    Finding,
    end,
    slope,
    slopes,
)
from saltus.conformance.models import (
    GRAVITY,
    MU,
    RADIUS,
    SLIDE,
    SUNKEN,
    ball,
    block_at_a_wall,
    exact_ball,
    exact_sledge,
    exact_swing,
    pendulum,
    sledge,
    smooth_bowl,
    touching_bowl,
)

DT = 1e-3  # [s]


@dataclass(frozen=True)
class Mended:
    """Which of the defects the options of a scheme mend."""

    opening: bool  #: a contact whose gap drifts open keeps its force, and the scheme its order
    drift: bool  #: of positions from bilateral constraints
    jump: bool  #: of a body at rest when another contact is hit

    @staticmethod
    def by(options: Mapping[str, Any]) -> Mended:
        """What these options promise."""
        drift = options.get("stabilization") == "position"
        opening = drift or options.get("activity") == "sticky"
        return Mended(opening, drift, options.get("impact") == "keep-resting-forces")


def defects(
    make: Callable[[], sk.OneStepIntegrator], *, friction: bool, order_sliding: int, forces: bool
) -> Iterator[Finding]:
    """All of them, one after the other."""
    mended = Mended.by(make().options)
    yield from across_impacts(make)
    if friction:
        what, build, exact = "sliding that turns in space", sledge, exact_sledge(0.25)
        expected = f">= {order_sliding - SLACK:.1f}"
    else:
        what, build, exact = "lasting contact", smooth_bowl, exact_swing(0.0, SUNKEN, 0.25)
        expected = ""
    for symbol, order in slopes(make, build, exact, 0.25, TURN_STEPS.get(order_sliding, STEPS)):
        ok = not expected or order >= order_sliding - SLACK
        yield Finding(f"order of {symbol}, {what}", order, expected, ok)
    if forces:
        yield from from_touch(make, MU if friction else 0.0, order_sliding, holds=mended.opening)
    yield from lasting_defects(make)


def lasting_defects(make: Callable[[], sk.OneStepIntegrator]) -> Iterator[Finding]:
    """Those that are no matter of an order."""
    mended = Mended.by(make().options)
    yield from drift(make, holds=mended.drift)
    yield after_bounces(make)
    yield closed_at_the_start(make)
    yield impact_elsewhere(make, holds=mended.jump)


def across_impacts(make: Callable[[], sk.OneStepIntegrator]) -> Iterator[Finding]:
    """Mean error in q of balls that have bounced once, since the phase decides each; and its slope."""
    restitution, until, heights = 0.5, 0.15, 0.05 * np.linspace(1.0, 1.3, 20)
    steps, errors = np.array([2.0, 1.0, 0.5]) * DT, []
    for dt in steps:
        ends = [end(ball(h, restitution), make(), dt, until)[0][0] for h in heights]
        exact = [exact_ball(h, restitution, until) for h in heights]
        errors.append(np.abs(np.subtract(ends, exact)).mean())
    yield Finding("order of q, across an impact", slope(steps, np.array(errors)))
    yield Finding("error of q across an impact, Δt = 1 ms [m]", float(errors[1]))


def from_touch(
    make: Callable[[], sk.OneStepIntegrator], mu: float, claim: int, *, holds: bool
) -> Iterator[Finding]:
    """Orders in sliding from g = 0, where rounding or a drift can open the contact, and how often it does."""
    coarsest = SWING_STEPS.get(claim, STEPS)
    exact, impacts = exact_swing(mu, RADIUS, SLIDE, start=0.0), 0
    for symbol, order in slopes(make, lambda: touching_bowl(mu), exact, SLIDE, coarsest):
        expected = f">= {claim - SLACK:.1f}" if holds else ""
        yield Finding(
            f"order of {symbol}, sliding from g = 0", order, expected, not holds or order >= claim - SLACK
        )
    for steps in coarsest * np.array([1, 2, 4, 8]):
        simulation = _core.TimeSteppingBase(touching_bowl(mu), make(), SLIDE / float(steps), "auto")
        impulsive = [simulation.take_step().impulsive for _ in range(steps)]
        impacts += sum(impulsive[1:])
    name = "sliding from g = 0: impacts in four runs"
    yield Finding(name, impacts, "0" if holds else "", not holds or impacts == 0)


def drift(make: Callable[[], sk.OneStepIntegrator], *, holds: bool) -> Iterator[Finding]:
    """Of a bilateral constraint, a pendulum in cartesian coordinates, after 0.25 s."""
    run = sk.TimeStepping(pendulum(), make(), DT).run(0.25)
    q, v = run.q[-1], run.v[-1]
    gap, bound = abs(RADIUS - hypot(*q)), 1e-12
    expected = f"<= {bound:.0e}" if holds else ""
    yield Finding("bilateral constraint, Δt = 1 ms: |g| [m]", gap, expected, not holds or gap <= bound)
    yield Finding("bilateral constraint, Δt = 1 ms: |ġ| [m/s]", abs(float(q @ v)) / hypot(*q))


def after_bounces(make: Callable[[], sk.OneStepIntegrator]) -> Finding:
    """A ball with ε = 1/2 lies still after 0.3 s, after bounces without number."""
    name, simulation = "ball after its bounces: speed [m/s]", sk.TimeStepping(ball(0.05, 0.5), make(), DT)
    try:
        return Finding(name, abs(float(simulation.run(0.6).v[-1, 0])))
    except sk.SimulationError as error:
        if "velocity_tolerance" not in str(error):
            raise
        return Finding(name, float("nan"), note="refused: they accumulate")


def closed_at_the_start(make: Callable[[], sk.OneStepIntegrator]) -> Finding:
    """What a contact that is closed and approaches at t0 makes of that velocity; its law says 0.9."""
    run = sk.TimeStepping(ball(-1e-4, 0.9, -1.0), make(), DT).run(DT)
    return Finding("closed at t0, restitution 0.9: -v⁺/v⁻", float(run.v[-1, 0]) + 0.0)


def impact_elsewhere(make: Callable[[], sk.OneStepIntegrator], *, holds: bool) -> Finding:
    """With which speed a block leaves the floor that it rests on when it hits a wall."""
    restitution = 0.5
    run = sk.TimeStepping(block_at_a_wall(restitution), make(), DT).run(0.02)
    jump = float(run.v[:, 1].max()) / (restitution * GRAVITY * DT)
    ok = not holds or abs(jump) <= 1e-9
    return Finding("jump of a block at rest by an impact / (ε g Δt)", jump, "<= 1e-9" if holds else "", ok)
