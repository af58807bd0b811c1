"""Models whose motion is known, by an ordinary differential equation or a formula."""

from __future__ import annotations

from collections.abc import Callable
from math import cos, hypot, sin, sqrt
from typing import TYPE_CHECKING

import numpy as np
from scipy.integrate import solve_ivp

import saltus.kernel as sk

if TYPE_CHECKING:
    from saltus.typing import FloatArray

GRAVITY = 9.81  # [m/s²]
RADIUS, START, RATE = 0.8, 0.3, 3.0  # swing: [m], [rad], [rad/s]
SUNKEN = RADIUS + 1e-4  # of a point in the bowl [m]
MU = 0.3
SLIDE = 0.2  # while a point slides in the bowl: at 0.25 s it nearly stands still [s]
SLEDGE = [0.3, 0.0, 1.0, 2.0]  # x, y [m], their rates [m/s]
SPRINGS = [20.0, 60.0]  # along x and y [N/m]
TOP_INERTIA = np.array([0.05, 0.06, 0.02])  # about its centre of mass [kg m²]
TOP_ARM = np.array([0.0, 0.0, 0.5])  # from the tip to there [m]
TOP_START = np.array([cos(0.2), sin(0.2), 0.0, 0.0, 0.5, -0.3, 25.0])  # quaternion, Ω [rad/s]


def ball(height: float, restitution: float, velocity: float = 0.0) -> sk.NonSmoothDynamicalSystem:
    """A ball of 1 kg over a floor."""
    body = sk.LagrangianLinearTIDS([height], [velocity], [[1.0]], external_force=[-GRAVITY])
    system = sk.NonSmoothDynamicalSystem([body])
    system.link(
        sk.Interaction(sk.LagrangianLinearTIR([[1.0]]), sk.NewtonImpactNSL(restitution), name="floor"), body
    )
    return system


def exact_ball(height: float, restitution: float, until: float) -> float:
    """Its height between the first and the second impact."""
    fall = sqrt(2 * height / GRAVITY)
    flight = until - fall
    return restitution * GRAVITY * fall * flight - 0.5 * GRAVITY * flight**2


def oscillator(q: float, v: float) -> sk.NonSmoothDynamicalSystem:
    """q̈ = −q."""
    return sk.NonSmoothDynamicalSystem([sk.LagrangianLinearTIDS([q], [v], [[1.0]], [[1.0]])])


def block_at_a_wall(restitution: float) -> sk.NonSmoothDynamicalSystem:
    """A block that slides on a floor without friction, q = (x, z), and meets a wall after 10.5 ms."""
    block = sk.LagrangianLinearTIDS([0.0, -1e-4], [1.0, 0.0], np.eye(2), external_force=[0.0, -GRAVITY])
    system = sk.NonSmoothDynamicalSystem([block])
    for name, row, offset in (("floor", [0.0, 1.0], 0.0), ("wall", [-1.0, 0.0], 0.0105)):
        relation = sk.LagrangianLinearTIR([row], [offset])
        system.link(sk.Interaction(relation, sk.NewtonImpactNSL(restitution), name=name), block)
    return system


def sledge() -> sk.NonSmoothDynamicalSystem:
    """A point of 2 kg that slides on the plane z = 0, q = (x, y, z); springs turn it off its line."""
    body = sk.LagrangianLinearTIDS(
        [*SLEDGE[:2], -1e-4],
        [*SLEDGE[2:], 0.0],
        2 * np.eye(3),
        np.diag([*SPRINGS, 0.0]),
        external_force=[0.0, 0.0, -2 * GRAVITY],
    )
    system = sk.NonSmoothDynamicalSystem([body])
    relation = sk.LagrangianLinearTIR([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    law = sk.NewtonImpactFrictionNSL(0.0, 0.0, MU, 3)
    system.link(sk.Interaction(relation, law, name="plane"), body)
    return system


def exact_sledge(until: float) -> tuple[FloatArray, FloatArray]:
    """Its q and v while it slides."""

    def rates(t: float, y: FloatArray) -> list[float]:
        speed = hypot(y[2], y[3])
        slow = [-k * x / 2 - MU * GRAVITY * v / speed for k, x, v in zip(SPRINGS, y[:2], y[2:], strict=True)]
        return [y[2], y[3], *slow]

    y = _integrate(rates, SLEDGE, until)
    return np.append(y[:2], -1e-4), np.append(y[2:], 0.0)


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


def _on_circle(law: sk.NonSmoothLaw, radius: float, start: float = START) -> sk.NonSmoothDynamicalSystem:
    q, v = _swing_state(start, RATE)
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
    return _on_circle(sk.NewtonImpactFrictionNSL(0.0, 0.0, MU, 2), SUNKEN)


def smooth_bowl() -> sk.NonSmoothDynamicalSystem:
    """The same without friction."""
    return _on_circle(sk.NewtonImpactNSL(0.0), SUNKEN)


def touching_bowl(mu: float) -> sk.NonSmoothDynamicalSystem:
    """A point that slides from the bottom of the bowl, where g = 0 to the last bit; an impact would show."""
    restitution = 0.5
    law = sk.NewtonImpactFrictionNSL(restitution, 0.0, mu, 2) if mu else sk.NewtonImpactNSL(restitution)
    return _on_circle(law, RADIUS, start=0.0)


def _swing_state(angle: float, rate: float) -> tuple[FloatArray, FloatArray]:
    return np.array([sin(angle), -cos(angle)]), rate * np.array([cos(angle), sin(angle)])


def exact_swing(
    mu: float, radius: float, until: float, start: float = START
) -> tuple[FloatArray, FloatArray]:
    """Q and v of pendulum and bowl by an ordinary differential equation of the angle."""

    def rates(t: float, y: FloatArray) -> list[float]:
        pressure = radius * y[1] ** 2 + GRAVITY * cos(y[0])
        return [y[1], -(GRAVITY * sin(y[0]) + mu * pressure * np.sign(y[1])) / radius]

    angle, rate = _integrate(rates, [start, RATE], until)
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


def top() -> sk.NonSmoothDynamicalSystem:
    """A heavy top, a body in space whose tip a ball joint holds at the origin."""
    q, v = _top_state(TOP_START)
    body = sk.NewtonEulerDS(q, v, 1.0, TOP_INERTIA, force=[0.0, 0.0, -GRAVITY])
    system = sk.NonSmoothDynamicalSystem([body])
    tip = sk.Joint.ball(body, at=[0.0, 0.0, 0.0])
    system.link(sk.Interaction(tip, sk.EqualityConditionNSL(tip.size), name="tip"), body)
    return system


def exact_top(until: float) -> tuple[FloatArray, FloatArray]:
    """Its q and v by Euler's equations about the tip."""
    about_tip = TOP_INERTIA + (TOP_ARM @ TOP_ARM - TOP_ARM**2)

    def rates(t: float, y: FloatArray) -> FloatArray:
        (w, x), omega = (y[0], y[1:4]), y[4:]
        weight = sk.rotation_matrix(y[:4]).T @ [0.0, 0.0, -GRAVITY]
        moment = np.cross(TOP_ARM, weight) - np.cross(omega, about_tip * omega)
        return np.concatenate(
            [[-x @ omega / 2], (w * omega + np.cross(x, omega)) / 2, moment / about_tip]  # ½ p ∘ (0, Ω)
        )

    end = solve_ivp(rates, (0.0, until), TOP_START, method="DOP853", rtol=1e-13, atol=1e-13).y[:, -1]
    return _top_state(end)


def _top_state(y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Position and velocity of the body with attitude and angular velocity y = (p, Ω)."""
    rotation, omega = sk.rotation_matrix(y[:4]), y[4:]
    v = np.concatenate([rotation @ np.cross(omega, TOP_ARM), omega])
    return np.concatenate([rotation @ TOP_ARM, y[:4]]), v
