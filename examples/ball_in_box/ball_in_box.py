r"""The bouncing ball in a box, Section 5.2 of the paper.

A ball without friction falls in a box until it lies still. The model is linear, so that nothing of what
is seen comes from the geometry: the energy never grows, and the schemes on acceleration and on velocity
level give the same motion.

1. Dynamics
-----------
The centre :math:`q = (x, y)` of a ball of mass m moves under gravity γ in the direction d,

    m q̈ = m γ d + W λ.

The paper's text has d = −(cos π/6, sin π/6): the box stands obliquely, and the ball comes to rest in its
lower left corner, on two contacts. Table 4 has d = (0, −1): it comes to rest on the bottom.

2. Contacts
-----------
Between the ball, of radius R, and the four sides of a box of width a and height b are the gaps

    g_left = x − R,    g_right = a − R − x,    g_bottom = y − R,    g_top = b − R − y,

each of them linear in q, g = H q + b. Newton's impact law with ε = 0.3 acts in each.

3. What is known exactly
------------------------
x and y do not know of each other. In each the ball falls over the distance D = 1 m under the share γ_n of
gravity, hits after t1 = √(2 D/γ_n), flies for 2 εᵏ t1 after the k-th impact, infinitely often, and is at
rest from t1 (1 + ε)/(1 − ε) on. A scheme that captures events takes the last of these flights as one.

4. Run it
---------
A linear model needs no class of its own: `build()` composes it of a linear system and linear relations.
Run this file to see the impacts. ball_in_box.cpp is the same in C++.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from math import cos, pi, sin
from typing import TYPE_CHECKING, Literal

import numpy as np
import saltus.kernel as sk

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from saltus.io import Trajectory
    from saltus.scene import Place
    from saltus.typing import FloatArray

Gravity = Literal["oblique", "down"]
DIRECTIONS: dict[Gravity, tuple[float, float]] = {
    "oblique": (-cos(pi / 6), -sin(pi / 6)),
    "down": (0.0, -1.0),
}
TIME_STEP = 5e-3  #: of the paper [s]

CAPTION = (
    "The ball falls obliquely in its box, bounces off the left wall and off the bottom, each time less, and "
    "lies still in the corner. Each gap closes at its own times: the two directions do not know of each "
    "other."
)
WATCH = (
    "The ball falls obliquely, bounces off the left side and the bottom, and comes to rest in the corner, "
    "where both sides go on pressing: the green arrows."
)


@dataclass(frozen=True)
class Parameters:
    """Table 4."""

    a: float = 4.0  #: width of the box [m]
    b: float = 4.0  #: height of the box [m]
    R: float = 1.0  #: radius of the ball [m]
    m: float = 1.0  #: mass [kg]
    gravity: float = 9.81  #: γ [m/s²]
    restitution: float = 0.3  #: ε of all four contacts
    x0: float = 2.0  #: start, at rest [m]
    y0: float = 2.0  #: [m]


def build(gravity: Gravity = "oblique") -> sk.NonSmoothDynamicalSystem:
    """Compose the model with the parameters and initial conditions of Table 4.

    Parameters
    ----------
    gravity : its direction, "oblique" as in the text of the paper or "down" as in Table 4

    Raises
    ------
    ValueError
        If there is no such direction.
    """
    if gravity not in DIRECTIONS:
        raise ValueError(f"gravity must be one of {', '.join(DIRECTIONS)}, got {gravity!r}")
    p = Parameters()
    weight = [p.m * p.gravity * d for d in DIRECTIONS[gravity]]
    ball = sk.LagrangianLinearTIDS([p.x0, p.y0], [0.0, 0.0], p.m * np.eye(2), external_force=weight)
    ball.add_shape(sk.Disc(p.R), pose=lambda q: (q[0], q[1], 0.0))
    system = sk.NonSmoothDynamicalSystem([ball], parameters={**asdict(p), "direction of gravity": gravity})
    for name, normal, offset in [
        ("left", [1.0, 0.0], -p.R),
        ("right", [-1.0, 0.0], p.a - p.R),
        ("bottom", [0.0, 1.0], -p.R),
        ("top", [0.0, -1.0], p.b - p.R),
    ]:
        side = sk.LagrangianLinearTIR([normal], [offset])
        contact = sk.Interaction(side, sk.NewtonImpactNSL(p.restitution), name=name)
        contact.show_at(rim(np.array(normal), p.R))
        system.link(contact, ball)
    system.add_shape(sk.Box(p.a, p.b), pose=(p.a / 2, p.b / 2, 0.0))
    return system


def rim(normal: FloatArray, radius: float) -> Place:
    """The point of the ball that is nearest to a side with this normal."""
    return lambda q: (q - radius * normal, normal)


def run() -> Trajectory:
    """The fall under oblique gravity."""
    return sk.TimeStepping(build(), "HalfExplicitTrapezoidalOSI", TIME_STEP).run(2.0)


def picture(shown: Trajectory) -> Figure:
    """Draw the ball in its box, and the gaps."""
    from saltus import plot
    from saltus.examples.figure import sheet

    with sheet(1, 2, (9, 4)) as (figure, (box, gaps)):
        plot.shapes(box, shown, [0, 60, 90, 125, 400])
        box.plot(*shown.q.T, "k.", markersize=1.5)
        plot.gaps(gaps, shown)
        gaps.set_xlabel("time t [s]")
    return figure


def main() -> None:
    """Print the impacts of the first two seconds, and the forces at rest."""
    for gravity in DIRECTIONS:
        trajectory = sk.TimeStepping(build(gravity), "HalfExplicitTrapezoidalOSI", TIME_STEP).run(until=2.0)
        print(f"gravity {gravity}: {trajectory.impulsive.sum()} impulsive steps of {len(trajectory) - 1}")
        for name in trajectory.contacts:
            contact = trajectory[name]
            for row in contact.impulse[:, 0].nonzero()[0]:
                print(
                    f"  t = {trajectory.t[row]:.3f} s: {contact.impulse[row, 0]:.3g} N s on the {name} side"
                )
        at_rest = {name: trajectory[name].force[-1, 0] for name in trajectory.contacts}
        shares = [f"{force:.3g} N on the {name} side" for name, force in at_rest.items() if force > 0.0]
        print(f"  at rest: {', '.join(shares)}")


if __name__ == "__main__":
    main()
