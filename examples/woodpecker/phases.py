"""A period of the woodpecker toy from phase to phase: the map u → P(u) and its fixed point.

Between events it is known which contact is closed and which way it slides, and the equations are linear: with
w = W_N + s μ W_T, s = ±1 against the sliding,

    M v̇ = f − K q + w λ_N,    λ_N = −W_Nᵀ M⁻¹ (f − K q)/(W_Nᵀ M⁻¹ w),

and an impact gives M (v⁺ − v⁻) = w Λ_N, Λ_N = −(1 + ε) W_Nᵀ v⁻/(W_Nᵀ M⁻¹ w). The order of phases near the
limit cycle is that of `PHASES`; that impacts press and that their contacts slide as assumed is asserted.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from saltus.examples.woodpecker.woodpecker import (
    CONTACTS,
    HALF_SLEEVE,
    MU,
    PLAY,
    WEIGHT,
    K,
    M,
    sliding_angle,
)
from scipy.integrate import solve_ivp

if TYPE_CHECKING:
    from saltus.typing import FloatArray


@dataclass(frozen=True)
class Phase:
    """What holds until an event, and the event."""

    closed: str | None  #: the contact that slides
    friction: int  #: s of this contact: 1 while it slides down
    until: str  #: "opens", "sticks", "slides" or the contact that hits
    hit: int = 0  #: s of the impact


PHASES = (
    Phase("lower", 1, "opens"),
    Phase(None, 0, "upper", 1),
    Phase(None, 0, "beak", -1),
    Phase(None, 0, "upper", -1),
    Phase("upper", -1, "opens"),
    Phase(None, 0, "lower", 1),
    Phase(None, 0, "lower", 1),
    Phase("lower", 1, "sticks"),
    Phase("lower", 0, "slides"),  # jammed
)


@dataclass(frozen=True)
class Event:
    """The end of a phase."""

    t: float  #: [s]
    q: FloatArray  #: (3,)
    v: FloatArray  #: (3,), after the impact
    impulse: float  #: Λ_N of the impact, or 0 [N s]


@dataclass(frozen=True)
class Cycle:
    """The limit cycle."""

    rate: float  #: u [rad/s], the fixed point
    slope: float  #: P'(u): what is left of a deviation after a period
    period: float  #: [s]
    drop: float  #: [m] a period
    events: tuple[Event, ...]  #: ends of the phases


def directions(contact: str, friction: int) -> tuple[FloatArray, FloatArray]:
    """W_N and w = W_N + s μ W_T (3,)."""
    normal, tangent = np.array(CONTACTS[contact].normal), np.array(CONTACTS[contact].tangent)
    return normal, normal + friction * MU * tangent


def normal_force(phase: Phase, q: FloatArray) -> float:
    """λ_N of the contact that slides [N]."""
    assert phase.closed is not None
    normal, w = directions(phase.closed, phase.friction)
    lift = np.linalg.solve(M, normal)
    return float(-lift @ (WEIGHT - K @ q) / (lift @ w))


def sliding_velocity(phase: Phase, v: FloatArray) -> float:
    """γ_T of the contact that slides [m/s]."""
    assert phase.closed is not None
    return float(np.dot(CONTACTS[phase.closed].tangent, v))


def rates(phase: Phase, x: FloatArray) -> FloatArray:
    """ẋ of x = (q, v)."""
    q, v = x[:3], x[3:]
    force = WEIGHT - K @ q
    if phase.until == "slides":  # the bird alone
        return np.array([0.0, 0.0, v[2], 0.0, 0.0, force[2] / M[2, 2]])
    if phase.closed is not None:
        force = force + directions(phase.closed, phase.friction)[1] * normal_force(phase, q)
    return np.concatenate([v, np.linalg.solve(M, force)])


def distance_to_event(phase: Phase, x: FloatArray) -> float:
    """What falls to zero at the end of the phase."""
    if phase.until == "opens":
        return normal_force(phase, x[:3])
    if phase.until == "sticks":
        return -sliding_velocity(phase, x[3:])
    if phase.until == "slides":
        return sliding_angle() - x[2] if x[5] > 0 else 1.0
    contact = CONTACTS[phase.until]
    return contact.offset + float(np.dot(contact.normal, x[:3]))


def take(phase: Phase, start: Event) -> Event:
    """Follow a phase from the end of the one before."""

    def event(_: float, x: FloatArray) -> float:
        return distance_to_event(phase, x)

    event.terminal, event.direction = True, -1  # type: ignore[attr-defined]
    solution = solve_ivp(
        lambda _, x: rates(phase, x),
        (start.t, start.t + 0.2),
        np.concatenate([start.q, start.v]),
        "DOP853",
        events=event,
        rtol=1e-12,
        atol=1e-14,
        max_step=5e-3,
    )
    assert solution.status == 1, f"{phase} does not end"
    t, q, v = float(solution.t[-1]), solution.y[:3, -1], solution.y[3:, -1]
    if phase.until == "sticks":
        return Event(t, q, np.array([0.0, 0.0, v[2]]), 0.0)
    if phase.until in ("opens", "slides"):
        return Event(t, q, v, 0.0)
    return hit(phase, t, q, v)


def hit(phase: Phase, t: float, q: FloatArray, v: FloatArray) -> Event:
    """Apply the impact at the end of a phase."""
    normal, w = directions(phase.until, phase.hit)
    change = np.linalg.solve(M, w)
    impulse = float(-(1 + CONTACTS[phase.until].restitution) * normal @ v / (normal @ change))
    after = v + change * impulse
    slides = np.dot(CONTACTS[phase.until].tangent, after)
    assert impulse > 0, f"{phase} hits nothing"
    assert slides * phase.hit <= 0, f"{phase} slides the other way, or sticks"
    return Event(t, q, after, impulse)


def period(rate: float) -> tuple[Event, ...]:
    """All events of a period that starts with this rate u [rad/s]; u of the next is ``[-1].v[2]``."""
    now = Event(0.0, np.array([0.0, -PLAY / HALF_SLEEVE, sliding_angle()]), np.array([0.0, 0.0, rate]), 0.0)
    events = []
    for phase in PHASES:
        now = take(phase, now)
        events.append(now)
    return tuple(events)


def limit_cycle(rate: float = 17.574666) -> Cycle:
    """Find the fixed point of the map by the secant method, from this rate [rad/s]."""
    other = rate + 0.02
    excess = [period(u)[-1].v[2] - u for u in (rate, other)]
    for _ in range(20):
        slope = (excess[1] - excess[0]) / (other - rate)
        rate, other = other, other - excess[1] / slope
        events = period(other)
        excess = [excess[1], float(events[-1].v[2]) - other]
        if abs(excess[1]) < 1e-9:
            break
    step = 1e-3
    slope = float(period(other + step)[-1].v[2] - period(other - step)[-1].v[2]) / (2 * step)
    return Cycle(other, slope, events[-1].t, -float(events[-1].q[0]), events)
