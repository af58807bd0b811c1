"""Measure whether an integrator does what its line in the table says.

Orders in free motion, under a bilateral constraint and in sliding friction, from slopes over several Δt
against independent solutions; Newton's impact law; a ball at rest; equal runs to the last bit; refusal of
friction where it is not taken. For integrators of the library, of plugins and of Python classes alike:
``saltus conformance NAME``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import cos, hypot, sin, sqrt
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.integrate import solve_ivp

import saltus.kernel as sk
from saltus import registry

if TYPE_CHECKING:
    from saltus.typing import FloatArray

GRAVITY = 9.81  # [m/s²]
SLACK = 0.2  # of an order below its claim
RADIUS, START, RATE = 0.8, 0.3, 3.0  # swing: [m], [rad], [rad/s]
MU = 0.3


@dataclass(frozen=True)
class Finding:
    """One property of an integrator: what is measured, and what was expected."""

    quantity: str
    measured: float
    expected: str
    ok: bool

    def __str__(self) -> str:
        verdict = "ok " if self.ok else "BAD"
        return f"{verdict}  {self.quantity:<44} {self.measured:10.3g}  expected {self.expected}"


def check(name: str) -> list[Finding]:
    """Measure an integrator with its default options.

    Parameters
    ----------
    name : as in ``saltus.registry``

    Raises
    ------
    ValueError
        If there is no such integrator.
    """
    return list(findings(name))


def findings(name: str) -> Iterator[Finding]:
    """The findings one after the other, as they are measured."""
    make = registry.integrator(name)
    entry = next(e for e in sk.integrators() if e["name"] == make.name)
    claims: dict[str, Any] = entry["properties"]
    yield from orders(
        "free motion", claims["order_free"], make, double_pendulum, exact_double_pendulum(0.5), 0.5
    )
    yield from orders(
        "bilateral constraint", claims["order_bilateral"], make, pendulum, exact_swing(0.0, 0.25), 0.25
    )
    if claims["friction"]:
        yield from orders("sliding", claims["order_sliding"], make, bowl, exact_swing(MU, 0.25), 0.25)
    else:
        yield refusal(make)
    yield impact_law(make)
    yield from rest(make, forces=claims["forces_at_rest"])
    yield repeats(make)


# ---- The measurements


def orders(
    what: str,
    claim: int,
    make: Callable[[], sk.OneStepIntegrator],
    build: Callable[[], sk.NonSmoothDynamicalSystem],
    exact: tuple[FloatArray, FloatArray],
    until: float,
) -> Iterator[Finding]:
    """Slopes of the errors in q and v at the end of a run."""
    steps = until / np.array([125, 250, 500, 1000])
    errors = []
    for dt in steps:
        run = sk.TimeStepping(build(), make(), dt).run(until)
        errors.append((np.linalg.norm(run.q[-1] - exact[0]), np.linalg.norm(run.v[-1] - exact[1])))
    for symbol, column in zip("qv", np.array(errors).T, strict=True):
        slope = float(np.polyfit(np.log(steps), np.log(np.maximum(column, 1e-300)), 1)[0])
        yield Finding(f"order of {symbol}, {what}", slope, f">= {claim - SLACK:.1f}", slope >= claim - SLACK)


def refusal(make: Callable[[], sk.OneStepIntegrator]) -> Finding:
    """Friction must be refused with ValueError."""
    try:
        sk.TimeStepping(bowl(), make(), 1e-3)
    except ValueError as error:
        return Finding("friction refused by name", 1.0, "1", "friction" in str(error))
    return Finding("friction refused by name", 0.0, "1", False)


def impact_law(make: Callable[[], sk.OneStepIntegrator]) -> Finding:
    """|v⁺/v⁻ + ε| of the first impact, v⁻ being the speed of the fall; steps make an error of a few g Δt."""
    restitution, dt, height = 0.6, 1e-4, 0.2
    run = sk.TimeStepping(ball(height, restitution), make(), dt).run(0.3)
    after = run.v[np.flatnonzero(run.impulsive)[0], 0]
    fall = sqrt(2 * GRAVITY * height)
    bound = 3 * GRAVITY * dt / fall
    error = abs(after / fall - restitution)
    return Finding("restitution 0.6: deviation", error, f"<= {bound:.1e}", error <= bound)


def rest(make: Callable[[], sk.OneStepIntegrator], *, forces: bool) -> Iterator[Finding]:
    """What carries a plastic ball after it has fallen, and whether it still moves."""
    dt = 1e-3
    run = sk.TimeStepping(ball(0.05, 0.0), make(), dt).run(0.5)
    floor, weight = run["floor"], GRAVITY
    speed = abs(run.v[-1, 0])
    yield Finding("ball at rest: speed", speed, "<= 1e-9", speed <= 1e-9)
    force, impulse = floor.force[-1, 0], floor.impulse[-1, 0]
    error = max(abs(force - weight), abs(impulse)) if forces else max(abs(force), abs(impulse - weight * dt))
    what = "λ = m g, Λ = 0" if forces else "λ = 0, Λ = m g Δt"
    yield Finding(f"ball at rest: deviation from {what}", error, "<= 1e-9", error <= 1e-9)


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


# ---- Models whose motion is known


def ball(height: float, restitution: float) -> sk.NonSmoothDynamicalSystem:
    """A ball of 1 kg over a floor."""
    body = sk.LagrangianLinearTIDS([height], [0.0], [[1.0]], external_force=[-GRAVITY])
    system = sk.NonSmoothDynamicalSystem([body])
    system.link(
        sk.Interaction(sk.LagrangianLinearTIR([[1.0]]), sk.NewtonImpactNSL(restitution), name="floor"), body
    )
    return system


class DoublePendulum(sk.LagrangianDS):
    """Unit masses on unit rods: M depends on q."""

    def mass(self, q: FloatArray, out: FloatArray) -> None:
        """M(q)."""
        out[0, 0], out[1, 1] = 2.0, 1.0
        out[0, 1] = out[1, 0] = cos(q[0] - q[1])

    def forces(self, t: float, q: FloatArray, v: FloatArray, out: FloatArray) -> None:
        """h(q, v)."""
        s = sin(q[0] - q[1])
        out[0] = -s * v[1] ** 2 - 2 * GRAVITY * sin(q[0])
        out[1] = s * v[0] ** 2 - GRAVITY * sin(q[1])


def double_pendulum() -> sk.NonSmoothDynamicalSystem:
    """A free motion that is not linear."""
    return sk.NonSmoothDynamicalSystem([DoublePendulum([1.0, 0.5], [0.5, -1.0])])


class Circle(sk.LagrangianScleronomousR):
    """A point inside of a circle around the origin: normal row, and with friction the tangential one."""

    def gap(self, q: FloatArray, out: FloatArray) -> None:
        """R − |q|."""
        out[0] = RADIUS - hypot(q[0], q[1])

    def jacobian(self, q: FloatArray, out: FloatArray) -> None:
        """Towards the centre, then along the circle."""
        r = hypot(q[0], q[1])
        out[0, 0], out[0, 1] = -q[0] / r, -q[1] / r
        if self.size == 2:
            out[1, 0], out[1, 1] = -q[1] / r, q[0] / r

    def curvature(self, q: FloatArray, v: FloatArray, out: FloatArray) -> None:
        """(dWᵀ/dt) v."""
        r, area = hypot(q[0], q[1]), q[0] * v[1] - q[1] * v[0]
        out[0] = -area * area / r**3
        if self.size == 2:
            out[1] = -area * (q[0] * v[0] + q[1] * v[1]) / r**3


def _on_circle(law: sk.NonSmoothLaw, radius: float) -> sk.NonSmoothDynamicalSystem:
    q, v = _swing_state(START, RATE)
    weight = [0.0, -2 * GRAVITY]
    point = sk.LagrangianLinearTIDS(radius * q, radius * v, 2 * np.eye(2), external_force=weight)
    system = sk.NonSmoothDynamicalSystem([point])
    system.link(sk.Interaction(Circle(law.size), law, name="circle"), point)
    return system


def pendulum() -> sk.NonSmoothDynamicalSystem:
    """A point on a rod, in cartesian coordinates."""
    return _on_circle(sk.EqualityConditionNSL(1), RADIUS)


def bowl() -> sk.NonSmoothDynamicalSystem:
    """A point that slides in a bowl with friction, from g = −1e-4, so that a drift opens no contact."""
    return _on_circle(sk.NewtonImpactFrictionNSL(0.0, 0.0, MU, 2), RADIUS + 1e-4)


def _swing_state(angle: float, rate: float) -> tuple[FloatArray, FloatArray]:
    return np.array([sin(angle), -cos(angle)]), rate * np.array([cos(angle), sin(angle)])


def exact_swing(mu: float, until: float) -> tuple[FloatArray, FloatArray]:
    """Q and v of pendulum (mu = 0) and bowl by an ordinary differential equation of the angle."""
    radius = RADIUS + (1e-4 if mu else 0.0)

    def rates(t: float, y: FloatArray) -> list[float]:
        pressure = radius * y[1] ** 2 + GRAVITY * cos(y[0])
        return [y[1], -(GRAVITY * sin(y[0]) + mu * pressure * np.sign(y[1])) / radius]

    angle, rate = _integrate(rates, [START, RATE], until)
    q, v = _swing_state(angle, rate)
    return radius * q, radius * v


def exact_double_pendulum(until: float) -> tuple[FloatArray, FloatArray]:
    """Its q and v, M solved by Cramer's rule."""

    def rates(t: float, y: FloatArray) -> list[float]:
        c, s = cos(y[0] - y[1]), sin(y[0] - y[1])
        h0, h1 = -s * y[3] ** 2 - 2 * GRAVITY * sin(y[0]), s * y[2] ** 2 - GRAVITY * sin(y[1])
        det = 2 - c * c
        return [y[2], y[3], (h0 - c * h1) / det, (2 * h1 - c * h0) / det]

    y = _integrate(rates, [1.0, 0.5, 0.5, -1.0], until)
    return y[:2], y[2:]


def _integrate(
    rates: Callable[[float, FloatArray], list[float]], start: list[float], until: float
) -> FloatArray:
    solution = solve_ivp(rates, (0.0, until), start, method="DOP853", rtol=1e-13, atol=1e-13)
    return np.asarray(solution.y[:, -1], dtype=np.float64)
