r"""A pile of discs: contacts of rolling bodies that come and go, and what holds three of them up.

Discs fall into a container and come to rest on each other. Contacts are those of discs (`SphereSphere`) and
of a disc with a line (`SpherePlane`); normals turn as the bodies move, friction makes them roll.

1. Dynamics
-----------
q = (x, y, φ) of each disc, I = m R²/2. For every pair g = |d| − R_i − R_j, for every disc and each of the
floor and two walls g = n·(c − p) − R; the tangential velocity of the contact has both discs' spins. ε = 0.
A pair that is apart costs the computation of its gap and no more.

2. At rest
----------
Forces of many contacts are not unique, their sums are: floor and walls together carry the weight of all
discs, and on each disc forces and moments vanish.

3. Three discs
--------------
Two equal discs lie on the floor a little apart, a third one on both, without any wall. With the angle α of
the contacts' normals from the vertical, sin α = (distance of the lower centres)/(4 R), moments about the
centres demand tangential forces of equal size everywhere, and forces on top and lower discs give

    top contacts:  N = m γ/2,     T = (m γ/2) tan(α/2);
    floor:         N = 3 m γ/2,   T = (m γ/2) tan(α/2).

(2 N cos α + 2 T sin α = m γ and N sin α = T (1 + cos α); cos α + sin α tan(α/2) = 1.) So the pile stands iff

    μ >= tan(α/2),

0.268 if the lower discs nearly touch. Without friction they part at once with γ/(tan α + 2 cot α).

4. Run it
---------
Run this file to see the forces of three discs, and those of 16 in a container, at rest after about 1 s;
`saltus.plot.shapes` draws them. A step with 168 contacts of which 26 are closed takes 0.12 ms. Discs sink in
where they land by speed times Δt, 1.3 mm here, and stay there: stabilisation leaves penetrations alone.
"""

from __future__ import annotations

from math import asin, cos, tan
from typing import TYPE_CHECKING

import numpy as np
import saltus.kernel as sk

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from saltus.io import Trajectory
    from saltus.typing import FloatArray

GRAVITY = 9.81  # γ [m/s²]
DENSITY = 100.0  # [kg/m²]
RADIUS = 0.05  # R of the three discs [m]
MU = 0.4
WIDTH = 0.6  # of the container [m]
TIME_STEP = 1e-3  # [s]
SCHEME = "HalfExplicitTrapezoidalOSI(activity=sticky,stabilization=position)"

CAPTION = (
    "Sixteen discs of different size fall into a container, roll over each other and come to rest; the "
    "spokes show how they have turned. In the end floor and walls carry exactly their weight."
)
WATCH = (
    "Discs fall, roll over each other and come to rest; spokes show how they turn. Contacts that slide "
    "are orange, those that stick blue; in the end nothing slides any more, and the green forces carry "
    "the pile."
)


def disc(x: float, y: float, radius: float) -> sk.LagrangianLinearTIDS:
    """A disc at rest."""
    mass = mass_of(radius)
    body = sk.LagrangianLinearTIDS(
        [x, y, 0.0],
        [0.0, 0.0, 0.0],
        np.diag([mass, mass, mass * radius**2 / 2]),
        external_force=[0.0, -mass * GRAVITY, 0.0],
    )
    body.add_shape(sk.Disc(radius), pose=lambda q: (q[0], q[1], q[2]))
    return body


def mass_of(radius: float) -> float:
    """Mass of a disc [kg]."""
    return float(DENSITY * np.pi * radius**2)


def compose(
    places: FloatArray, radii: FloatArray, lines: dict[str, tuple[FloatArray, FloatArray]], mu: float
) -> sk.NonSmoothDynamicalSystem:
    """Discs at places (n, 2) [m]; contacts "i on j", and "i on line" with lines (point, normal) by name."""
    discs = [disc(x, y, radius) for (x, y), radius in zip(places, radii, strict=True)]
    system = sk.NonSmoothDynamicalSystem(discs, parameters={"mu": mu})
    law = sk.NewtonImpactFrictionNSL(0.0, 0.0, mu, 2)
    for i, radius in enumerate(radii):
        for name, (point, normal) in lines.items():
            contact = sk.SpherePlane(2, radius=radius, point=point, normal=normal)
            system.link(sk.Interaction(contact, law, name=f"{i} on {name}"), discs[i])
        for j in range(i):
            pair = sk.SphereSphere(2, radius1=radius, radius2=radii[j])
            system.link(sk.Interaction(pair, law, name=f"{i} on {j}"), discs[i], discs[j])
    return system


def three_discs(apart: float = 1e-3, mu: float = MU) -> sk.NonSmoothDynamicalSystem:
    """Compose two discs on the floor, 0 and 1, so far apart [m], and disc 2 on both."""
    half = RADIUS + apart / 2
    top = RADIUS + 2 * RADIUS * cos(angle(apart))
    places = np.array([[-half, RADIUS], [half, RADIUS], [0.0, top]])
    system = compose(places, np.full(3, RADIUS), {"floor": (np.zeros(2), np.array([0.0, 1.0]))}, mu)
    system.add_shape(sk.Polyline(((-WIDTH / 2, 0.0), (WIDTH / 2, 0.0))))
    return system


def angle(apart: float) -> float:
    """α of the normals of the top contacts [rad]."""
    return asin((2 * RADIUS + apart) / (4 * RADIUS))


def forces_of_three(apart: float) -> dict[str, tuple[float, float]]:
    """N and |T| of a top contact and of one with the floor [N]."""
    half = mass_of(RADIUS) * GRAVITY / 2
    friction = half * tan(angle(apart) / 2)
    return {"top": (half, friction), "floor": (3 * half, friction)}


def radii_of(rows: int) -> FloatArray:
    """Radii of the discs that fall [m], in no particular order."""
    return np.asarray(0.04 + 0.002 * (7 * np.arange(4 * rows) % 10), dtype=np.float64)


def build(rows: int = 4, mu: float = MU) -> sk.NonSmoothDynamicalSystem:
    """Compose a container into which rows of four discs of different size fall."""
    numbers, radii = np.arange(4 * rows), radii_of(rows)
    shift = 0.02 * np.sin(2.0 * numbers)
    places = np.column_stack([-0.21 + 0.14 * (numbers % 4) + shift, 0.08 + 0.14 * (numbers // 4)])
    lines = {
        "floor": (np.zeros(2), np.array([0.0, 1.0])),
        "left": (np.array([-WIDTH / 2, 0.0]), np.array([1.0, 0.0])),
        "right": (np.array([WIDTH / 2, 0.0]), np.array([-1.0, 0.0])),
    }
    system = compose(places, radii, lines, mu)
    side = WIDTH / 2
    system.add_shape(sk.Polyline(((-side, 2 * side), (-side, 0.0), (side, 0.0), (side, 2 * side))))
    return system


def carried(run: Trajectory) -> tuple[float, float]:
    """Horizontal and vertical force of floor and walls on all discs in the last step [N]."""
    total = np.zeros(2)
    for name in run.contacts:
        line = name.split()[-1]
        contact = run[name]
        normal, tangential = contact.force[-1] + contact.impulse[-1] / run.provenance.time_step
        if line in ("floor", "left", "right"):
            n = {"floor": (0.0, 1.0), "left": (1.0, 0.0), "right": (-1.0, 0.0)}[line]
            total += [normal * n[0] + tangential * n[1], normal * n[1] - tangential * n[0]]
    return float(total[0]), float(total[1])


def run() -> Trajectory:
    """The fall into the container."""
    return sk.TimeStepping(build(), SCHEME, TIME_STEP).run(1.5)


def picture(shown: Trajectory) -> Figure:
    """Draw the discs at the start, on the way and at rest."""
    from saltus import plot
    from saltus.examples.figure import sheet

    with sheet(1, 3, (9, 4), sharey=True) as (figure, axes):
        for ax, time in zip(axes, (0.0, 0.25, 1.5), strict=True):
            plot.shapes(ax, shown, [round(time / TIME_STEP)])
            ax.plot([-WIDTH / 2, -WIDTH / 2, WIDTH / 2, WIDTH / 2], [0.6, 0.0, 0.0, 0.6], "k", linewidth=1.5)
            ax.set_title(f"{time:g} s", loc="left")
        for ax in axes[1:]:
            ax.set_ylabel("")
    return figure


def main() -> None:
    """Print forces, computed and exact, and draw the pile."""
    apart = 1e-3
    run = sk.TimeStepping(three_discs(apart), SCHEME, TIME_STEP).run(0.5)
    known = forces_of_three(apart)
    for name, contact in (("top", "2 on 0"), ("floor", "0 on floor")):
        found, exact = (
            ", ".join(f"{abs(f):.6f}" for f in pair) for pair in (run[contact].force[-1], known[name])
        )
        print(f"{name}: {found} N, exactly {exact} N")
    print(f"    stands with mu >= {tan(angle(apart) / 2):.4f}")
    run = sk.TimeStepping(build(), SCHEME, TIME_STEP).run(3.0)
    speed = np.abs(run.v[-1]).max()
    weight = GRAVITY * sum(mass_of(radius) for radius in radii_of(4))
    across, up = carried(run)
    print(f"pile: fastest {speed:.1e} m/s or rad/s, {run.closed[-1]} contacts closed")
    print(f"    floor and walls carry {up:.6f} N, weight {weight:.6f} N, and across {across:.1e} N")


if __name__ == "__main__":
    main()
