"""Figures of what schemes do not do well: to choose by, without a verdict."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import hypot

import numpy as np

import saltus.kernel as sk
from saltus.conformance.measure import STEPS, Finding, end, slope, slopes
from saltus.conformance.models import (
    GRAVITY,
    RADIUS,
    SUNKEN,
    ball,
    block_at_a_wall,
    exact_ball,
    exact_sledge,
    exact_swing,
    pendulum,
    sledge,
    smooth_bowl,
)

DT = 1e-3  # [s]


def defects(make: Callable[[], sk.OneStepIntegrator], *, friction: bool) -> Iterator[Finding]:
    """All of them, one after the other."""
    yield across_impacts(make)
    if friction:
        what, build, exact = "sliding that turns in space", sledge, exact_sledge(0.25)
    else:
        what, build, exact = "lasting contact", smooth_bowl, exact_swing(0.0, SUNKEN, 0.25)
    for symbol, order in slopes(make, build, exact, 0.25, STEPS):
        yield Finding(f"order of {symbol}, {what}", order)
    yield from drift(make)
    yield after_bounces(make)
    yield closed_at_the_start(make)
    yield impact_elsewhere(make)


def across_impacts(make: Callable[[], sk.OneStepIntegrator]) -> Finding:
    """Slope of the mean error in q of balls that have bounced once; its mean, since the phase decides it."""
    restitution, until, heights = 0.5, 0.15, 0.05 * np.linspace(1.0, 1.3, 20)
    steps, errors = until / np.array([75, 150, 300]), []
    for dt in steps:
        ends = [end(ball(h, restitution), make(), dt, until)[0][0] for h in heights]
        exact = [exact_ball(h, restitution, until) for h in heights]
        errors.append(np.abs(np.subtract(ends, exact)).mean())
    return Finding("order of q, across an impact", slope(steps, np.array(errors)))


def drift(make: Callable[[], sk.OneStepIntegrator]) -> Iterator[Finding]:
    """Of a bilateral constraint, a pendulum in cartesian coordinates, after 0.25 s."""
    run = sk.TimeStepping(pendulum(), make(), DT).run(0.25)
    q, v = run.q[-1], run.v[-1]
    yield Finding("bilateral constraint, Δt = 1 ms: |g| [m]", abs(RADIUS - hypot(*q)))
    yield Finding("bilateral constraint, Δt = 1 ms: |ġ| [m/s]", abs(float(q @ v)) / hypot(*q))


def after_bounces(make: Callable[[], sk.OneStepIntegrator]) -> Finding:
    """A ball with ε = 1/2 lies still after 0.3 s, after bounces without number."""
    run = sk.TimeStepping(ball(0.05, 0.5), make(), DT).run(0.6)
    return Finding("ball after its bounces: speed [m/s]", abs(float(run.v[-1, 0])))


def closed_at_the_start(make: Callable[[], sk.OneStepIntegrator]) -> Finding:
    """What a contact that is closed and approaches at t0 makes of that velocity; its law says 0.9."""
    run = sk.TimeStepping(ball(-1e-4, 0.9, -1.0), make(), DT).run(DT)
    return Finding("closed at t0, restitution 0.9: -v⁺/v⁻", float(run.v[-1, 0]) + 0.0)


def impact_elsewhere(make: Callable[[], sk.OneStepIntegrator]) -> Finding:
    """With which speed a block leaves the floor that it rests on when it hits a wall."""
    restitution = 0.5
    run = sk.TimeStepping(block_at_a_wall(restitution), make(), DT).run(0.02)
    jump = float(run.v[:, 1].max()) / (restitution * GRAVITY * DT)
    return Finding("jump of a block at rest by an impact / (ε g Δt)", jump)
