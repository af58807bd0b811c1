r"""A ball on a string that goes slack, and on a rod that does not.

A ball of mass m hangs on a string of length l and is pushed with v0 at the bottom. If that is more than
√(2 γ l) and less than √(5 γ l), it rises above its suspension, the string goes slack, the ball falls along a
parabola, and with a jerk the string is taut again. A rod in its place would hold the ball on its circle.

1. Dynamics
-----------
In cartesian coordinates q = (x, y) about the suspension

    m q̈ = (0, −m γ) + W λ,    g = l − |q|,    W = (∂g/∂q)ᵀ = −q/|q|.

The string is a contact: g >= 0, it pulls with λ >= 0, and λ g = 0. ε = 0: a jerk takes the velocity along
the string. The rod is the equality g = 0, its λ may push.

2. What is known exactly
------------------------
While the string is taut the energy tells the speed, and the angle ψ from the bottom the force:

    v² = v0² − 2 γ l (1 − cos ψ),    λ = m (v²/l + γ cos ψ).

λ = 0 is at the angle α from the top with cos α = (v0² − 2 γ l)/(3 γ l), where v² = γ l cos α. With
v0² = 4.4 γ l it is 4/5. The time until then is an elliptic integral,

    t1 = 2 l/v0 F((π − α)/2 | 4 γ l/v0²).

The parabola from there has the circle's curvature, so that three of the four points that it shares with the
circle are one; since the angles of all four add up to 2π, the fourth is at 3 α on the other side of the top.
There, after 2 l sin 2α/√(γ l cos α), comes the jerk. On the rod the ball goes round, v0² > 4 γ l, and
the rod pushes near the top.

3. Run it
---------
Run this file to see both. While the string is taut the scheme lets g drift, by 6e-8 m at Δt = 1 ms, here to
the side that keeps the contact closed. HalfExplicitRungeKuttaOSI drifts to the other side at once, and
loses the string for a step: it needs `activity="sticky"`, which remembers what was closed.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import acos, cos, pi, sin, sqrt
from typing import TYPE_CHECKING

import numpy as np
import saltus.kernel as sk
from scipy.special import ellipkinc

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from saltus.io import Trajectory
    from saltus.typing import FloatArray

GRAVITY = 9.81  # γ [m/s²]
MASS = 0.5  # [kg]
LENGTH = 0.8  # l [m]
SPEED = sqrt(4.4 * GRAVITY * LENGTH)  # v0 [m/s]
TIME_STEP = 1e-3  # [s]
SCHEME = "HalfExplicitTrapezoidalOSI"

CAPTION = (
    "The ball swings up on its string, blue, until the string goes slack; it falls along a parabola, red, "
    "until the string is taut again with a jerk, at the exact place, the cross. Beside it, the force of the "
    "string, which falls to zero where it goes slack."
)
WATCH = (
    "Green is the force of the taut string. On the way up it falls to zero: the string is slack, and the "
    "ball flies freely inside of its reach, the grey circle, until the string is taut with a jerk, the "
    "red arrow."
)


class Reach(sk.LagrangianScleronomousR):
    """What is left of the string's length, g = l − |q| [m]."""

    def __init__(self) -> None:
        super().__init__(size=1)

    def gap(self, q: FloatArray, out: FloatArray) -> None:
        """The gap g [m]."""
        out[0] = LENGTH - np.hypot(q[0], q[1])

    def jacobian(self, q: FloatArray, out: FloatArray) -> None:
        """∂g/∂q."""
        out[0] = -q / np.hypot(q[0], q[1])

    def curvature(self, q: FloatArray, v: FloatArray, out: FloatArray) -> None:
        """(dWᵀ/dt) v: what is across the string of v, squared, over its length [m/s²]."""
        r = np.hypot(q[0], q[1])
        out[0] = -((q[0] * v[1] - q[1] * v[0]) ** 2) / r**3


@dataclass(frozen=True)
class Jerk:
    """The string is taut again."""

    t: float  #: [s]
    angle: float  #: from the top, on the side that the ball flies to [rad]
    impulse: float  #: [N s]
    speed: float  #: of the ball afterwards, along the circle [m/s]


def build(link: str = "string") -> sk.NonSmoothDynamicalSystem:
    """Compose the ball on a "string" or a "rod". Raises ValueError if it is something else."""
    if link not in ("string", "rod"):
        raise ValueError(f"link must be string or rod, got {link!r}")
    ball = sk.LagrangianLinearTIDS(
        [0.0, -LENGTH], [SPEED, 0.0], MASS * np.eye(2), external_force=[0.0, -MASS * GRAVITY]
    )
    ball.add_shape(sk.Disc(0.03), pose=lambda q: (q[0], q[1], 0.0))
    system = sk.NonSmoothDynamicalSystem([ball], parameters={"link": link})
    law = sk.NewtonImpactNSL(0.0) if link == "string" else sk.EqualityConditionNSL(1)
    system.add_shape(sk.Disc(0.01))
    angles = 2 * pi * np.arange(65) / 64
    system.add_shape(sk.Polyline(tuple((LENGTH * sin(a), LENGTH * cos(a)) for a in angles)))  # its reach
    contact = sk.Interaction(Reach(), law, name=link)
    contact.show_at(lambda q: (q, -q / np.hypot(q[0], q[1])))
    system.link(contact, ball)
    return system


def tension(y: float) -> float:
    """Force of the taut string or rod at this height [N]."""
    height = y + LENGTH
    return MASS * ((SPEED**2 - 2 * GRAVITY * height) / LENGTH - GRAVITY * y / LENGTH)


def slack() -> tuple[float, float]:
    """When the string goes slack [s], and the angle α from the top [rad]."""
    alpha = acos((SPEED**2 - 2 * GRAVITY * LENGTH) / (3 * GRAVITY * LENGTH))
    parameter = 4 * GRAVITY * LENGTH / SPEED**2
    return 2 * LENGTH / SPEED * float(ellipkinc((pi - alpha) / 2, parameter)), alpha


def jerk() -> Jerk:
    """The end of the parabola."""
    start, alpha = slack()
    speed = sqrt(GRAVITY * LENGTH * cos(alpha))
    flight = 2 * LENGTH * sin(2 * alpha) / speed
    vx, vy = -speed * cos(alpha), speed * sin(alpha) - GRAVITY * flight
    outward = -vx * sin(3 * alpha) + vy * cos(3 * alpha)
    along = -vx * cos(3 * alpha) - vy * sin(3 * alpha)
    return Jerk(start + flight, 3 * alpha, MASS * outward, along)


def run() -> Trajectory:
    """One swing, the flight, and the swing after the jerk."""
    return sk.TimeStepping(build(), SCHEME, TIME_STEP).run(1.3)


def picture(shown: Trajectory) -> Figure:
    """Draw the way of the ball, and the force of the string."""
    from saltus.examples.figure import sheet

    taut, end = shown["string"].force[:, 0] > 0, jerk()
    with sheet(1, 2, (9, 4.4)) as (figure, (way, force)):
        for part, color, label in ((taut, "C0", "taut"), (~taut, "C3", "slack")):
            way.plot(*np.where(part[:, None], shown.q, np.nan).T, color=color, label=label)
        way.plot(-LENGTH * sin(end.angle), LENGTH * cos(end.angle), "kx", markersize=9, label="exactly")
        way.plot(0.0, 0.0, "k.")
        way.set_aspect("equal")
        way.set_xlabel("x [m]")
        way.set_ylabel("y [m]")
        way.legend()
        force.plot(shown.t, shown["string"].force[:, 0])
        force.set_xlabel("time t [s]")
        force.set_ylabel("force λ [N]")
    return figure


def main() -> None:
    """Print when the string goes slack and taut, computed and exact, and the forces of the rod."""
    run = sk.TimeStepping(build(), SCHEME, TIME_STEP).run(2.0)
    string, (start, alpha), end = run["string"], slack(), jerk()
    row = int(np.flatnonzero(string.force[1:, 0] <= 0)[0])
    print(f"slack at {run.t[row]:.4f} s, exactly {start:.4f} s, {alpha:.4f} rad from the top")
    hit = int(np.flatnonzero(run.impulsive)[0])
    print(f"taut at {run.t[hit]:.4f} s, exactly {end.t:.4f} s, {end.angle:.4f} rad from the top")
    print(f"    with {string.impulse[hit, 0]:.4f} N s, exactly {end.impulse:.4f} N s")
    run = sk.TimeStepping(build("rod"), SCHEME, TIME_STEP).run(2.0)
    force = run["rod"].force[1:, 0]
    least, largest = tension(LENGTH), tension(-LENGTH)
    print(f"rod: from {force.min():.3f} to {force.max():.3f} N, exactly {least:.3f} to {largest:.3f} N")


if __name__ == "__main__":
    main()
