r"""A rocking block: corners that take turns, the loss in between, and when it tips over.

A plane block of mass m, half-width b and half-height h stands on rough ground. Tilted and let go, it rocks
from one lower corner to the other, less and less, and stands still after finite time: Housner's block.

1. Dynamics
-----------
q = (x, y, φ), the centre and the angle. The lower corners are points of the block, C_i = (±b, −h) in its
frame, on the line y = 0:

    m ẍ = Σ λ_T,   m ÿ = −m γ + Σ λ_N,   (1/3) m R² φ̈ = moments,   R² = b² + h²,   tan a = b/h.

ε = 0, and friction is large enough that no corner slips.

2. About a corner
-----------------
Let θ = |φ|. With ψ = a − θ, the angle of the diagonal from the vertical, the block is an inverted pendulum,

    ψ̈ = p² sin ψ,    p² = 3 γ/(4 R),    θ̇² = 2 p² (cos(a − θ0) − cos(a − θ)).

Let go at θ0 it is upright after an elliptic integral, with k = cos²((a − θ0)/2),

    t(θ0) = (K(k) − F(asin(cos(a/2)/√k) | k))/p,

for slender blocks Housner's acosh(1/(1 − θ0/a))/p. From the ground it tips over iff ω² > 2 p² (1 − cos a).

3. The change of corners
------------------------
The angular momentum about the new corner is kept, the old one opens without an impulse:

    ω⁺ = r ω⁻,    r = 1 − (3/2) sin² a,    Λ_T/Λ_N = 3 sin a cos a/(4 − 3 sin² a) <= μ.

If r <= 0, tan a >= √2, the block stops at once, on both corners. Else cos(a − θ) − cos a is multiplied by r²
from turn to turn. Near the end so is θ, and the times by r: it stands still after finite time.

4. Run it
---------
Run this file to see turns, times and the end, computed and exact. The corner that the block turns about stays
closed for hundreds of steps while its W changes: `activity="sticky"` remembers that it was closed, where it
would drift open and come back as an impact, and `stabilization="position"` takes back what it drifts. With
`impact="keep-resting-forces"` the corner that was closed before goes on to carry its force in the step of an
impact; (55) leaves it out, and with Δt = 1 ms the third turn is by a fifth too low. `impulsive_substeps`
takes the end of the fall in steps of Δt/10.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import acosh, asin, atan2, cos, hypot, pi, sin, sqrt
from typing import TYPE_CHECKING

import numpy as np
import saltus.kernel as sk
from scipy.special import ellipk, ellipkinc

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from saltus.io import Trajectory

GRAVITY = 9.81  # γ [m/s²]
MASS = 2.0  # [kg]
HALF_WIDTH = 0.1  # b [m]
HALF_HEIGHT = 0.2  # h [m]
MU = 0.7
TILT = 0.25  # θ0 [rad]
TIME_STEP = 1e-3  # [s]
SCHEME = (
    "HalfExplicitTrapezoidalOSI(activity=sticky,stabilization=position,"
    "impact=keep-resting-forces,impulsive_substeps=10)"
)

CAPTION = (
    "The block rocks from corner to corner, less and less, and stands still after finite time, the dashed "
    "line. Crosses are the exact turns."
)
WATCH = (
    "The block rocks from corner to corner. At each change one corner hits, red, while the other leaves; "
    "then the corner sticks and carries the block, until both do."
)


@dataclass(frozen=True)
class Block:
    """Half-width b and half-height h [m], and what follows from them."""

    b: float = HALF_WIDTH
    h: float = HALF_HEIGHT

    @property
    def a(self) -> float:
        """Angle of the diagonal from the vertical [rad]."""
        return atan2(self.b, self.h)

    @property
    def p(self) -> float:
        """Rate of the inverted pendulum [1/s]."""
        return sqrt(0.75 * GRAVITY / hypot(self.b, self.h))

    @property
    def ratio(self) -> float:
        """The ratio r = ω⁺/ω⁻, zero for a block that stops at once."""
        return max(0.0, 1 - 1.5 * sin(self.a) ** 2)

    @property
    def impact_friction(self) -> float:
        """Λ_T/Λ_N at the change of corners."""
        return 3 * sin(self.a) * cos(self.a) / (4 - 3 * sin(self.a) ** 2)

    @property
    def tipping_rate(self) -> float:
        """The ω that tips it over from the ground [rad/s]."""
        return self.rate(self.a)

    def rate(self, tilt: float) -> float:
        """ω at the ground of a block that turns, or was let go, at this tilt θ0 [rad/s]."""
        return self.p * sqrt(2 * (cos(self.a - tilt) - cos(self.a)))

    def fall(self, tilt: float) -> float:
        """t(θ0): from a turn at this tilt to the ground [s]."""
        k = cos((self.a - tilt) / 2) ** 2
        start = float(ellipkinc(asin(cos(self.a / 2) / sqrt(k)), k))
        return (float(ellipk(k)) - start) / self.p

    def housner_fall(self, tilt: float) -> float:
        """The same for small angles [s]."""
        return acosh(1 / (1 - tilt / self.a)) / self.p

    def next_turn(self, tilt: float) -> float:
        """The tilt of the turn after one at this tilt [rad]."""
        return self.a - float(np.arccos(cos(self.a) + self.ratio**2 * (cos(self.a - tilt) - cos(self.a))))


def build(
    tilt: float = TILT, rate: float = 0.0, mu: float = MU, block: Block | None = None
) -> sk.NonSmoothDynamicalSystem:
    """Compose the block, contacts "left" and "right".

    Parameters
    ----------
    tilt : θ0 [rad]; it stands on the right corner, which is at (b, 0)
    rate : θ̇ at the start [rad/s]

    Raises
    ------
    ValueError
        If the tilt is not in [0, π/2).
    """
    if not 0.0 <= tilt < pi / 2:
        raise ValueError(f"tilt must be in [0, pi/2), got {tilt}")
    block = block or Block()
    # the centre, seen from the right corner; φ = −θ
    away = (-block.b * cos(tilt) + block.h * sin(tilt), block.b * sin(tilt) + block.h * cos(tilt))
    body = sk.LagrangianLinearTIDS(
        [block.b + away[0], away[1], -tilt],
        [rate * away[1], -rate * away[0], -rate],
        np.diag([MASS, MASS, MASS * (block.b**2 + block.h**2) / 3]),
        external_force=[0.0, -MASS * GRAVITY, 0.0],
    )
    body.add_shape(sk.Box(2 * block.b, 2 * block.h), pose=lambda q: (q[0], q[1], q[2]))
    system = sk.NonSmoothDynamicalSystem([body], parameters={"tilt": tilt, "rate": rate, "mu": mu})
    system.add_shape(sk.Polyline(((-4 * block.b, 0.0), (4 * block.b, 0.0))))
    law = sk.NewtonImpactFrictionNSL(0.0, 0.0, mu, 2)
    for name, side in (("left", -1), ("right", 1)):
        corner = sk.SpherePlane(
            2, radius=0.0, centre=[side * block.b, -block.h], point=[0.0, 0.0], normal=[0.0, 1.0]
        )
        system.link(sk.Interaction(corner, law, name=name), body)
    return system


@dataclass(frozen=True)
class Turns:
    """Changes of corners, and the turn after each."""

    impacts: list[float]  #: [s]
    turns: list[float]  #: [s]
    tilts: list[float]  #: θ of the turns [rad]
    end: float  #: when it stands still [s]


def exact(block: Block, tilt: float = TILT) -> Turns:
    """All of them, down to tilts of 1e-12 rad."""
    t, impacts, turns, tilts = block.fall(tilt), [], [], []
    while block.ratio > 0.0 and tilt > 1e-12:
        tilt = block.next_turn(tilt)
        impacts.append(t)
        t += block.fall(tilt)
        turns.append(t)
        tilts.append(tilt)
        t += block.fall(tilt)
    return Turns(impacts, turns, tilts, t)


def run() -> Trajectory:
    """All of its rocking."""
    return sk.TimeStepping(build(), SCHEME, TIME_STEP).run(1.5)


def picture(shown: Trajectory) -> Figure:
    """Draw the block while it falls, and its tilt."""
    from saltus import plot
    from saltus.examples.figure import sheet

    known = exact(Block())
    with sheet(1, 2, (9, 4), width_ratios=[1, 2]) as (figure, (block, tilt)):
        plot.shapes(block, shown, [0, int(known.impacts[0] / TIME_STEP), int(known.turns[0] / TIME_STEP)])
        block.axhline(0.0, color="black")
        tilt.plot(shown.t, shown.q[:, 2])
        turns = [(-1) ** k * angle for k, angle in enumerate(known.tilts)]
        tilt.plot(known.turns, turns, "kx", label="exactly")
        tilt.axvline(known.end, color="black", linestyle="--", linewidth=0.8)
        tilt.set_xlabel("time t [s]")
        tilt.set_ylabel("angle φ [rad]")
        tilt.legend()
    return figure


def main() -> None:
    """Print turns and times, computed and exact."""
    block = Block()
    known = exact(block)
    run = sk.TimeStepping(build(), SCHEME, TIME_STEP).run(3.0)
    hits = np.flatnonzero(run.impulsive)
    for k in range(4):
        row, after = hits[k], hits[k + 1]
        tilt = np.abs(run.q[row:after, 2]).max()
        print(
            f"corner {k + 1}: {run.t[row]:.4f} s, exactly {known.impacts[k]:.4f} s; "
            f"turns at {tilt:.6f}, exactly {known.tilts[k]:.6f} rad"
        )
    moving = np.flatnonzero(np.abs(run.v).max(axis=1) > 1e-12)[-1]
    print(f"stands still at {run.t[moving]:.4f} s, exactly {known.end:.4f} s")
    print(f"first fall {block.fall(TILT):.4f} s, by Housner's formula {block.housner_fall(TILT):.4f} s")


if __name__ == "__main__":
    main()
