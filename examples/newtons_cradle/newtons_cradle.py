r"""Newton's cradle: a row of balls, and what an impact law says of all contacts at once.

n equal balls of mass m hang in a row on strings of length l. One is drawn aside and let go. A cradle on a
desk throws out the last ball, and the others stay nearly at rest. Newton's law does that if there are gaps
between the balls, be they as small as they may; if the balls touch, it does something else.

1. Dynamics
-----------
Small displacements q_i along the row, each from the ball's own place, obey

    m q̈_i + m ω² q_i = forces of the neighbours,    ω² = g/l,    g_i = q_{i+1} − q_i + δ,

where δ is the gap between balls that hang still. They all swing with one period, T = 2π/ω. The first ball
starts at q_1 = −A, and arrives with v0 = A ω after T/4.

2. Gaps: one impact after the other
-----------------------------------
In an impact of two balls with u1 > u2 Newton's law g_i' ⁺ = −ε g_i' ⁻ gives

    u1⁺ = (u1 + u2)/2 − ε (u1 − u2)/2,    u2⁺ = (u1 + u2)/2 + ε (u1 − u2)/2.

With ε = 1 they exchange their velocities: v0 passes to the last ball in n − 1 impacts. With ε < 1 each
ball keeps a share, and is hit again by those behind it.

3. No gaps: all contacts at once
--------------------------------
If the balls touch, g_i = 0, the law (56)-(59) holds in all contacts together, Λ_i >= 0 complementary to
g_i'⁺ + ε g_i'⁻ >= 0. The first contact closes with v0, the others have g_i'⁻ = 0 and stay closed: all balls
but the first leave as one body. With the momentum that is

    v_1⁺ = v0 (1 + ε)/n − ε v0,    v_2⁺ = … = v_n⁺ = v0 (1 + ε)/n,

for ε = 1 without loss of energy: of three balls the first comes back with v0/3. Half a period later all
balls are at their places again, and the same law lets the first one go out alone, as it came.

Neither is wrong: rigid balls that touch do not say in which order waves run through them. But the second
is not stable. With Δt = 1e-4 s rounding opens a gap of 1e-19 m between the second and the third of three
balls in the fourth period, and from then on impacts come one after the other. An author who wants the
cradle of the desk gives the balls gaps, and one who wants touching balls to stay together makes them one
body.

4. What is left in the end
--------------------------
With ε < 1 all balls swing together in the end, as Newton's cradles do: with the first momentum, which all of
them share, and so with 1/n of the energy. If ε = 0 and the balls touch, that is so after one impact.

Run this file to see both.
"""

from __future__ import annotations

from math import pi, sqrt
from typing import TYPE_CHECKING

import saltus.kernel as sk

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from saltus.io import Trajectory
    from saltus.scene import Place

GRAVITY = 9.81  # [m/s²]
MASS = 0.05  # [kg], of a ball
LENGTH = 0.15  # [m], of the strings
OMEGA = sqrt(GRAVITY / LENGTH)  # [rad/s]
AMPLITUDE = 0.03  # [m]: how far the first ball is drawn aside
SPEED = AMPLITUDE * OMEGA  # [m/s]: v0, a quarter of a period later
PERIOD = 2 * pi / OMEGA  # [s]
TIME_STEP = 1e-4  # [s]
RADIUS = 0.01  # [m]

CAPTION = (
    "Five balls with gaps of 0.1 mm. The first one falls onto the others, and the last one leaves; half a "
    "period later it comes back. Lines are the ways of the balls, each from its own place; the others stay "
    "nearly at rest."
)
WATCH = (
    "The first ball falls onto the others, and in a cascade of impacts from left to right the last one "
    "takes all of its velocity."
)


def build(balls: int = 5, gap: float = 1e-4, restitution: float = 1.0) -> sk.NonSmoothDynamicalSystem:
    """Compose the cradle; contact "1" is that of the first ball with the second.

    Parameters
    ----------
    balls : n > 1
    gap : δ >= 0 [m], between balls that hang still
    restitution : ε of all contacts

    Raises
    ------
    ValueError
        If there are less than two balls, the gap is negative, or restitution is not in [0, 1].
    """
    if balls < 2 or not 0.0 <= gap < float("inf"):
        raise ValueError(f"expected at least 2 balls and a gap >= 0, got {balls} and {gap}")
    hanging = []
    for k in range(balls):
        start = -AMPLITUDE if k == 0 else 0.0
        ball = sk.LagrangianLinearTIDS([start], [0.0], [[MASS]], [[MASS * OMEGA**2]])
        place = k * (2 * RADIUS + gap)
        ball.add_shape(sk.Disc(RADIUS), pose=pose_at(place))
        ball.add_shape(sk.Polyline(((0.0, 0.0), (0.0, LENGTH))), pose=string_at(place))
        hanging.append(ball)
    system = sk.NonSmoothDynamicalSystem(
        hanging, parameters={"balls": balls, "gap": gap, "restitution": restitution}
    )
    law = sk.NewtonImpactNSL(restitution)
    for k in range(1, balls):
        contact = sk.Interaction(sk.LagrangianLinearTIR([[-1.0, 1.0]], [gap]), law, name=str(k))
        contact.show_at(touching(RADIUS + (k - 1) * (2 * RADIUS + gap)))
        system.link(contact, hanging[k - 1], hanging[k])
    return system


def pose_at(place: float) -> sk.Pose:
    """Where a ball is drawn that hangs at this place [m]."""
    return lambda q: (place + q[0], 0.0, 0.0)


def string_at(place: float) -> sk.Pose:
    """Its string, for a small angle."""
    return lambda q: (place + q[0], 0.0, q[0] / LENGTH)


def touching(place: float) -> Place:
    """The right end of a ball; λ pushes it to the left."""
    return lambda q: ((place + q[0], 0.0), (-1.0, 0.0))


def together(balls: int, restitution: float) -> list[float]:
    """Velocities over v0 after an impact of the first ball against the others, which touch."""
    others = (1 + restitution) / balls
    return [others - restitution] + [others] * (balls - 1)


def run() -> Trajectory:
    """Two periods, with gaps."""
    return sk.TimeStepping(build(), "HalfExplicitTrapezoidalOSI", TIME_STEP).run(2 * PERIOD)


def picture(shown: Trajectory) -> Figure:
    """Draw the ways of the balls."""
    from saltus import plot
    from saltus.examples.figure import sheet

    with sheet(size=(8, 4.5)) as (figure, (ax,)):
        for k, way in enumerate(shown.q.T):
            ax.plot(shown.t, 1e3 * (way + 2 * RADIUS * k), label=f"ball {k + 1}")
        ax.set_xlabel("time t [s]")
        ax.set_ylabel("place along the row [mm]")
        plot.legend_strip(ax, columns=5)
    return figure


def main() -> None:
    """Print what the balls have of the momentum after the first swing's last impact."""
    for gap, time_step in ((0.0, TIME_STEP), (1e-4, 0.1 * TIME_STEP)):
        for restitution in (1.0, 0.8):
            system = build(gap=gap, restitution=restitution)
            run = sk.TimeStepping(system, "HalfExplicitTrapezoidalOSI", time_step).run(0.3 * PERIOD)
            after = run.v[run.impulsive][-1]
            shares = ", ".join(f"{share:.3f}" for share in after / after.sum())
            print(f"gap {gap:g} m, ε = {restitution}, {run.impulsive.sum()} impulsive steps: {shares}")
            if gap == 0.0:
                exact = ", ".join(f"{share:.3f}" for share in together(5, restitution))
                print(f"    exactly: {exact}")


if __name__ == "__main__":
    main()
