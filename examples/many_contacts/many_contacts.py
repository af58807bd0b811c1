"""Columns, pyramids and rain of bodies: many contacts, few of which know of each other.

A **column** of n balls of mass m, one freedom each, at rest on each other: contact i carries what lies on it,
an impulse (n − i) m g Δt a step.

A **pyramid** of equal discs, rows of n, n − 1, ..., 1, that starts sliding as a whole with dry friction. The
contacts, found by `neighbours`, keep the normals of the first instant; with n = 44 there are 990 discs and
2882 contacts, more than the discs have freedoms can determine: impulses are not unique, velocities are.

**Rain**: discs over a plane, some of them on it; each slides, rolls and knows of none of the others.

Run this file to see what a step costs.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import numpy as np
import saltus.kernel as sk

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from saltus.io import Trajectory
    from saltus.scene import Place

GRAVITY = 9.81  # [m/s²]
RADIUS = 0.1  # [m]
MASS = 1.0  # [kg]
INERTIA = 0.5 * MASS * RADIUS**2  # [kg m²], of a disc
TIME_STEP = 1e-3  # [s]

CAPTION = (
    "A pyramid of 78 discs that has just begun to slide to the right. Lines join discs that press on each "
    "other, the thicker the larger the force: as the floor brakes the lowest row, the weight is carried "
    "down to the right."
)
WATCH = (
    "A pyramid of 78 discs slides to the right. The floor brakes the lowest row; forces, green, run down "
    "through the pile to the right. Red are the impacts at the start and of contacts that close again."
)


def column(n: int) -> sk.NonSmoothDynamicalSystem:
    """Compose n balls on each other, every contact closed by 1e-9 m."""
    balls = [
        sk.LagrangianLinearTIDS([-1e-9 * (k + 1)], [0.0], [[MASS]], external_force=[-MASS * GRAVITY])
        for k in range(n)
    ]
    system = sk.NonSmoothDynamicalSystem(balls)
    law, ground, pair = sk.NewtonImpactNSL(0.0), [[1.0]], [[-1.0, 1.0]]
    system.link(sk.Interaction(sk.LagrangianLinearTIR(ground), law, name="ball 0"), balls[0])
    for k in range(1, n):
        contact = sk.Interaction(sk.LagrangianLinearTIR(pair), law, name=f"ball {k}")
        system.link(contact, balls[k - 1], balls[k])
    return system


def disc(x: float, y: float, speed: float) -> sk.LagrangianLinearTIDS:
    """A disc that moves horizontally, q = (x, y, angle)."""
    body = sk.LagrangianLinearTIDS(
        [x, y, 0.0],
        [speed, 0.0, 0.0],
        np.diag([MASS, MASS, INERTIA]),
        external_force=[0.0, -MASS * GRAVITY, 0.0],
    )
    body.add_shape(sk.Disc(RADIUS), pose=lambda q: (q[0], q[1], q[2]))
    return body


def floor_contact(law: sk.NonSmoothLaw, name: str) -> sk.Interaction:
    """Between a disc and the floor: gap y − R, tangential velocity ẋ + R φ̇ of the lowest point."""
    contact = sk.Interaction(
        sk.LagrangianLinearTIR([[0.0, 1.0, 0.0], [1.0, 0.0, RADIUS]], [-RADIUS, 0.0]), law, name=name
    )
    contact.show_at(lambda q: ((q[0], q[1] - RADIUS), (0.0, 1.0), (1.0, 0.0)))
    return contact


def between(nx: float, ny: float) -> Place:
    """The middle between two discs, and the directions of their contact."""
    return lambda q: (((q[0] + q[3]) / 2, (q[1] + q[4]) / 2), (nx, ny), (-ny, nx))


def pyramid(rows: int, speed: float = 0.5, mu: float = 0.3) -> sk.NonSmoothDynamicalSystem:
    """Compose the pyramid whose lowest row has so many discs."""
    centres = np.array(
        [
            (2 * RADIUS * k + RADIUS * row, RADIUS + row * np.sqrt(3.0) * RADIUS)
            for row in range(rows)
            for k in range(rows - row)
        ]
    )
    discs = [disc(x, y, speed) for x, y in centres]
    system = sk.NonSmoothDynamicalSystem(discs)
    law = sk.NewtonImpactFrictionNSL(0.0, 0.0, mu, 2)
    for k in range(rows):
        system.link(floor_contact(law, f"floor {k}"), discs[k])
    system.add_shape(sk.Polyline(((-2 * RADIUS, 0.0), (2 * RADIUS * (rows + 1), 0.0))))
    for i, j in sk.neighbours(centres, np.full(len(discs), RADIUS), within=0.01 * RADIUS):
        nx, ny = (centres[i] - centres[j]) / np.linalg.norm(centres[i] - centres[j])
        normal, tangent = (nx, ny, 0.0), (-ny, nx, -RADIUS)
        H = [[*normal, *(-nx, -ny, 0.0)], [*tangent, *(ny, -nx, -RADIUS)]]
        contact = sk.Interaction(sk.LagrangianLinearTIR(H, [-2 * RADIUS, 0.0]), law, name=f"{i} on {j}")
        contact.show_at(between(nx, ny))
        system.link(contact, discs[i], discs[j])
    return system


def rain(n: int, landed: int, mu: float = 0.3) -> sk.NonSmoothDynamicalSystem:
    """Compose n discs over a plane, the first ones on it, the others too high to reach it soon."""
    heights = np.where(np.arange(n) < landed, 0.0, 100.0)
    discs = [disc(3 * RADIUS * k, RADIUS + heights[k], 0.3) for k in range(n)]
    system = sk.NonSmoothDynamicalSystem(discs)
    law = sk.NewtonImpactFrictionNSL(0.0, 0.0, mu, 2)
    for k in range(n):
        system.link(floor_contact(law, f"disc {k}"), discs[k])
    return system


def step_times(
    system: sk.NonSmoothDynamicalSystem, integrator: str, steps: int, tolerance: float = 1e-12
) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Seconds of every step of a simulation, nothing recorded but impulsive steps."""
    simulation = sk.TimeStepping(system, integrator, TIME_STEP, tolerance=tolerance, record_every=10**9)
    seconds = np.empty(steps)
    for k in range(steps):
        start = time.perf_counter()
        simulation.take_step()
        seconds[k] = time.perf_counter() - start
    return seconds


def run() -> Trajectory:
    """A pyramid of 78 discs that begins to slide."""
    simulation = sk.TimeStepping(pyramid(12), "MoreauJeanOSI(theta=0.5)", TIME_STEP, tolerance=1e-8)
    return simulation.run(0.02)


def picture(shown: Trajectory) -> Figure:
    """Draw the discs, and the forces between them."""
    from matplotlib.patches import Circle
    from saltus.examples.figure import sheet

    centres = shown.q[-1].reshape(-1, 3)[:, :2]
    with sheet(size=(8, 6.5)) as (figure, (ax,)):
        for centre in centres:
            ax.add_patch(Circle(tuple(centre), RADIUS, fill=False, color="0.7"))
        for name in shown.contacts:
            first, _, other = name.partition(" on ")
            start = centres[int(first)] if other else centres[int(name.split()[1])]
            end = centres[int(other)] if other else start - [0.0, RADIUS]
            width = 0.03 * shown[name].impulse[-5:, 0].mean() / TIME_STEP
            ax.plot(*np.array([start, end]).T, color="C3", linewidth=width, solid_capstyle="round")
        ax.axhline(0.0, color="black")
        ax.set_aspect("equal")
        ax.set_xlabel("x [m]")
        ax.set_ylabel("y [m]")
    return figure


def main() -> None:
    """Print what a step costs."""
    theta = "MoreauJeanOSI(theta=0.5)"
    for n in (10, 100, 1000, 10_000):
        print(f"column of {n:5d}: {1e3 * np.median(step_times(column(n), theta, 20)):8.3f} ms a step")
    for landed in (0, 500, 1000):
        median = np.median(step_times(rain(1000, landed), theta, 100))
        print(f"1000 discs, {landed:4d} on the plane: {1e3 * median:.3f} ms a step")
    seconds = 1e3 * step_times(pyramid(44), theta, 20, tolerance=1e-8)
    print(
        f"pyramid of 990 discs: {seconds[0]:.0f} ms the first step, median of 20 steps "
        f"{np.median(seconds):.0f} ms, mean {seconds.mean():.0f} ms"
    )


if __name__ == "__main__":
    main()
