"""A ball that falls, bounces ever faster and comes to rest.

The height q of a ball of mass m above the floor obeys

    m q̈ = −m g + λ,   0 ≤ q,  0 ≤ λ,  q λ = 0,

and at an impact Newton's law (6), q̇⁺ = −ε q̇⁻. Dropped from h0 it hits the floor first at t1 = √(2 h0/g),
flight k lasts 2 εᵏ t1, so that infinitely many impacts are over at t1 (1+ε)/(1−ε). From then on the floor
carries the ball with λ = m g. An event-driven simulation does not get past that point; time-stepping does.

Run this file to see the exact and the computed times.
"""

from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING

import saltus.kernel as sk

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from saltus.io import Trajectory

GRAVITY = 9.81  # [m/s²]
MASS = 1.0  # [kg]
HEIGHT = 1.0  # [m]
RESTITUTION = 0.8

CAPTION = (
    "The ball bounces ever lower and ever faster, and rests from the time on at which infinitely many "
    "impacts are over, the dashed line. Impulses at the impacts and the force that carries the ball "
    "afterwards are told apart."
)
WATCH = (
    "Each bounce is a red impulse, smaller than the one before. After the last of them the green force of "
    "the floor carries the ball."
)


def build(restitution: float = RESTITUTION) -> sk.NonSmoothDynamicalSystem:
    """Compose the ball, its floor and the law between them."""
    ball = sk.LagrangianLinearTIDS(q0=[HEIGHT], v0=[0.0], mass=[[MASS]], external_force=[-MASS * GRAVITY])
    ball.add_shape(sk.Disc(0.05), pose=lambda q: (0.0, q[0] + 0.05, 0.0))
    system = sk.NonSmoothDynamicalSystem([ball])
    floor = sk.Interaction(sk.LagrangianLinearTIR([[1.0]]), sk.NewtonImpactNSL(restitution), name="floor")
    floor.show_at(lambda q: ((0.0, q[0]), (0.0, 1.0)))
    system.link(floor, ball)
    system.add_shape(sk.Polyline(((-0.5, 0.0), (0.5, 0.0))))
    return system


def rest_time(restitution: float = RESTITUTION) -> float:
    """When the last of infinitely many impacts is over [s]."""
    return sqrt(2 * HEIGHT / GRAVITY) * (1 + restitution) / (1 - restitution)


def run() -> Trajectory:
    """All of its bounces."""
    return sk.TimeStepping(build(), "HalfExplicitTrapezoidalOSI", time_step=1e-3).run(until=5.0)


def picture(shown: Trajectory) -> Figure:
    """Draw height, impulses and force."""
    from saltus import plot
    from saltus.examples.figure import sheet

    with sheet(3, 1, (8, 6), sharex=True) as (figure, (height, impulses, forces)):
        height.plot(shown.t, shown.q[:, 0])
        height.set_ylabel("height q [m]")
        plot.impulses(impulses, shown)
        forces.plot(shown.t, shown["floor"].force[:, 0])
        forces.set_ylabel("force λ [N]")
        forces.set_xlabel("time t [s]")
        for ax in (height, impulses, forces):
            ax.axvline(rest_time(), color="black", linestyle="--", linewidth=0.8)
    return figure


def main() -> None:
    """Print when the ball comes to rest and what carries it then."""
    trajectory = sk.TimeStepping(build(), sk.HalfExplicitTrapezoidalOSI(), time_step=1e-4).run(until=5.0)
    floor = trajectory["floor"]
    last = trajectory.t[trajectory.impulsive].max()
    print(f"last impact at t = {last:.4f} s, exactly {rest_time():.4f} s")
    print(f"then the floor carries {floor.force[-1, 0]:.6f} N, exactly {MASS * GRAVITY:.6f} N")


if __name__ == "__main__":
    main()
