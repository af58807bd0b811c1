r"""Dry friction: three motions whose ends are known exactly.

Coulomb's law |λ_T| <= μ λ_N, with λ_T = −μ λ_N against the sliding where there is any, ends motions in finite
time: a body that comes to rest stays there, held by any force that the inequality leaves room for. A scheme
must find the instant, and the force afterwards.

All three bodies are in contact from the start, on a plane y = 0 with the coordinates q = (x, y) or (x, y, φ);
the gap is y, the second row of Wᵀ is the velocity of the contact point along x.

1. A block on a slope
---------------------
A block of mass m slides down a slope of angle α with v0. Gravity has the parts m γ sin α along it and
m γ cos α into it. With μ > tan α the block comes to rest

    after t = v0/a,  s = v0²/(2 a),    a = γ (μ cos α − sin α),

and stays, held by λ_T = −m γ sin α. With μ < tan α it never stops.

2. An oscillator
----------------
On a spring of stiffness k, ω² = k/m, friction moves the equilibrium to ±d, d = μ m γ/k, against the motion.
Every half period π/ω the block turns, at

    x_n = (−1)ⁿ (x_0 − 2 n d),

until |x_n| <= d: there friction holds it. Amplitudes fall along a line, not exponentially.

3. A ball that begins to roll
-----------------------------
A solid ball, I = 2/5 m R², is pushed with v0 and does not turn. Its contact point slides with ẋ + R φ̇, until

    t = 2 v0/(7 μ γ),    v = 5 v0/7;

from then on it rolls without any force, with 5/7 of the energy.

4. Run it
---------
Run this file to see computed and exact numbers. Between the ends of motions the schemes of second order have
errors of Δt², and the end itself is found within a step: the error of the place where a body stops is of
second order, too.
"""

from __future__ import annotations

from math import atan, cos, pi, sin, sqrt
from typing import TYPE_CHECKING

import saltus.kernel as sk

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from saltus.io import Trajectory
    from saltus.typing import FloatArray

GRAVITY = 9.81  # γ [m/s²]
MASS = 2.0  # [kg]
MU = 0.3
SPEED = 2.0  # v0 of block and ball [m/s]
STIFFNESS = 200.0  # of the oscillator [N/m]
OFFSET = MU * MASS * GRAVITY / STIFFNESS  # d [m]
START = 7.5 * OFFSET  # x_0 [m]: the oscillator turns three times and stays at −d/2
RADIUS = 0.1  # of the ball [m]
BLOCK = sk.Box(0.1, 0.06)  # how a block is drawn
TIME_STEP = 1e-3  # [s]
SCHEME = "HalfExplicitTrapezoidalOSI"

CAPTION = (
    "An oscillator on dry ground turns three times, at the exact places, the crosses, and stays where "
    "friction can hold it. Amplitudes fall along a line. The friction force turns with the motion; at rest "
    "it is what the spring asks for."
)
WATCH = (
    "The block on a spring slides to and fro. Its friction, part of the green arrow, leans against the "
    "motion; in the end the contact sticks away from the middle, where friction holds against the spring."
)


def on_plane(body: sk.LagrangianLinearTIDS, tangent: list[float], mu: float) -> sk.NonSmoothDynamicalSystem:
    """The body on the plane y = 0, contact "plane"; `tangent` gives the velocity of its contact point."""
    system = sk.NonSmoothDynamicalSystem([body], parameters={"mu": mu})
    normal = [0.0, 1.0, 0.0][: len(tangent)]
    plane = sk.LagrangianLinearTIR([normal, tangent], [0.0, 0.0])
    contact = sk.Interaction(plane, sk.NewtonImpactFrictionNSL(0.0, 0.0, mu, 2), name="plane")
    contact.show_at(lambda q: ((q[0], q[1]), (0.0, 1.0), (1.0, 0.0)))
    system.link(contact, body)
    system.add_shape(sk.Polyline(((-1.0, 0.0), (1.0, 0.0))))
    return system


def block(slope: float, mu: float = MU) -> sk.NonSmoothDynamicalSystem:
    """A block that slides down a slope of this angle [rad]."""
    weight = [MASS * GRAVITY * sin(slope), -MASS * GRAVITY * cos(slope)]
    body = sk.LagrangianLinearTIDS(
        [0.0, 0.0], [SPEED, 0.0], [[MASS, 0.0], [0.0, MASS]], external_force=weight
    )
    body.add_shape(BLOCK, pose=on_its_foot)
    return on_plane(body, [1.0, 0.0], mu)


def on_its_foot(q: FloatArray) -> tuple[float, float, float]:
    """Where a block is drawn."""
    return q[0], q[1] + BLOCK.height / 2, 0.0


def block_at_rest(slope: float, mu: float = MU) -> tuple[float, float]:
    """When [s] and where [m] it comes to rest. Raises ValueError if it never does."""
    deceleration = GRAVITY * (mu * cos(slope) - sin(slope))
    if deceleration <= 0.0:
        raise ValueError(f"with mu = {mu} a block does not stop on a slope beyond {atan(mu):.4f} rad")
    return SPEED / deceleration, SPEED**2 / (2 * deceleration)


def oscillator() -> sk.NonSmoothDynamicalSystem:
    """A block on a spring, let go at x_0."""
    body = sk.LagrangianLinearTIDS(
        [START, 0.0],
        [0.0, 0.0],
        [[MASS, 0.0], [0.0, MASS]],
        [[STIFFNESS, 0.0], [0.0, 0.0]],
        external_force=[0.0, -MASS * GRAVITY],
    )
    body.add_shape(BLOCK, pose=on_its_foot)
    return on_plane(body, [1.0, 0.0], MU)


def turning_points() -> list[tuple[float, float]]:
    """When [s] and where [m] the oscillator turns; at the last of them it stays."""
    half_period = pi * sqrt(MASS / STIFFNESS)
    points: list[tuple[float, float]] = []
    x = START
    while abs(x) > OFFSET:
        x = -x + (2 * OFFSET if x > 0 else -2 * OFFSET)
        points.append((half_period * (len(points) + 1), x))
    return points


def ball() -> sk.NonSmoothDynamicalSystem:
    """A ball that slides first and rolls later, q = (x, y, φ)."""
    inertia = 0.4 * MASS * RADIUS**2
    body = sk.LagrangianLinearTIDS(
        [0.0, 0.0, 0.0],
        [SPEED, 0.0, 0.0],
        [[MASS, 0.0, 0.0], [0.0, MASS, 0.0], [0.0, 0.0, inertia]],
        external_force=[0.0, -MASS * GRAVITY, 0.0],
    )
    body.add_shape(sk.Disc(RADIUS), pose=lambda q: (q[0], q[1] + RADIUS, q[2]))
    return on_plane(body, [1.0, 0.0, RADIUS], MU)


def rolling() -> tuple[float, float]:
    """When the ball begins to roll [s], and how fast [m/s]."""
    return 2 * SPEED / (7 * MU * GRAVITY), 5 * SPEED / 7


def run() -> Trajectory:
    """The oscillator, until it stays."""
    return sk.TimeStepping(oscillator(), SCHEME, TIME_STEP).run(1.5)


def picture(shown: Trajectory) -> Figure:
    """Draw position and friction force."""
    from saltus.examples.figure import sheet

    with sheet(2, 1, (8, 5), sharex=True) as (figure, (place, friction)):
        place.plot(shown.t, shown.q[:, 0])
        place.plot(*zip(*turning_points(), strict=True), "kx", label="turns, exactly")
        place.axhspan(-OFFSET, OFFSET, color="0.9", label="friction can hold")
        place.set_ylabel("position x [m]")
        place.legend(loc="upper right")
        friction.plot(shown.t, shown["plane"].force[:, 1])
        for side in (-1, 1):
            friction.axhline(side * MU * MASS * GRAVITY, color="black", linestyle="--", linewidth=0.8)
        friction.set_ylabel("friction λ_T [N]")
        friction.set_xlabel("time t [s]")
    return figure


def main() -> None:
    """Print computed and exact numbers."""
    run = sk.TimeStepping(block(slope=0.2), SCHEME, TIME_STEP).run(3.0)
    stop, place = block_at_rest(slope=0.2)
    print(f"block: at rest at {run.q[-1, 0]:.6f} m, exactly {place:.6f} m after {stop:.4f} s")
    print(f"    held by {run['plane'].force[-1, 1]:.6f} N, exactly {-MASS * GRAVITY * sin(0.2):.6f} N")
    run = sk.TimeStepping(oscillator(), SCHEME, TIME_STEP).run(2.0)
    for t, x in turning_points():
        print(f"oscillator: {run.q[round(t / TIME_STEP), 0]:+.6f} m, exactly {x:+.6f} m at {t:.4f} s")
    run = sk.TimeStepping(ball(), SCHEME, TIME_STEP).run(0.5)
    start, speed = rolling()
    print(f"ball: {run.v[-1, 0]:.6f} m/s, exactly {speed:.6f} m/s from {start:.4f} s on")


if __name__ == "__main__":
    main()
