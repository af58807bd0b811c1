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

import saltus.kernel as sk

GRAVITY = 9.81  # [m/s²]
MASS = 1.0  # [kg]
HEIGHT = 1.0  # [m]
RESTITUTION = 0.8


def build(restitution: float = RESTITUTION) -> sk.NonSmoothDynamicalSystem:
    """Compose the ball, its floor and the law between them."""
    ball = sk.LagrangianLinearTIDS(q0=[HEIGHT], v0=[0.0], mass=[[MASS]], external_force=[-MASS * GRAVITY])
    ball.add_shape(sk.Disc(0.05), pose=lambda q: (0.0, q[0] + 0.05, 0.0))
    system = sk.NonSmoothDynamicalSystem([ball])
    system.link(
        sk.Interaction(sk.LagrangianLinearTIR([[1.0]]), sk.NewtonImpactNSL(restitution), name="floor"), ball
    )
    return system


def rest_time(restitution: float = RESTITUTION) -> float:
    """When the last of infinitely many impacts is over [s]."""
    return sqrt(2 * HEIGHT / GRAVITY) * (1 + restitution) / (1 - restitution)


def main() -> None:
    """Print when the ball comes to rest and what carries it then."""
    trajectory = sk.TimeStepping(build(), sk.HalfExplicitTrapezoidalOSI(), time_step=1e-4).run(until=5.0)
    floor = trajectory["floor"]
    last = trajectory.t[trajectory.impulsive].max()
    print(f"last impact at t = {last:.4f} s, exactly {rest_time():.4f} s")
    print(f"then the floor carries {floor.force[-1, 0]:.6f} N, exactly {MASS * GRAVITY:.6f} N")


if __name__ == "__main__":
    main()
