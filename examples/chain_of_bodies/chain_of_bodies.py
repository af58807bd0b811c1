r"""A chain of rigid bodies under ball joints: many bilateral constraints, and what they cost.

n equal rods of mass m and length l hang one below the other, the first from the ceiling, in ball joints.

1. Dynamics
-----------
Each rod is a rigid body in space, q = (x, p) with its axis along −e_3 of its own frame; joint k holds the
lower end of rod k − 1 and the upper end of rod k together, in three rows: 6 n freedoms, 3 n constraints.

2. At rest
----------
Joint k carries what hangs on it: λ_k = (n − k) m γ, k = 0 … n − 1, upwards on the rod below.

3. Small oscillations
---------------------
With angles θ_i from the vertical, in a plane, M θ̈ + K θ = 0,

    M_ij = m l² (n − max(i, j) − ½),  i ≠ j,    M_ii = m l² (n − i − 2/3),    K_ii = m γ l (n − i − ½),

i = 0 … n − 1: what is below rod i moves with it. Frequencies are those of the generalised eigenproblem
K a = ω² M a; for n = 1 ω² = 3γ/(2l), and for many rods the slowest has the period of a rope,
ω → (j_0/2) √(γ/L) with the first zero j_0 = 2.4048 of the Bessel function J_0 and L = n l.

4. A fall
---------
Let go from the horizontal the chain whips about; nothing but energy is known of its motion, and that the
joints stay closed. With `stabilization="position"` they do, to 1e-14 m. Within 3 s the energy moves by 1.4 %
of the largest kinetic one at Δt = 1 ms, where the chain whips, and by 0.02 % at 0.25 ms.

5. Run it
---------
Run this file to see all that, and that a step costs in proportion to n, about 3.3 µs a rod: a joint knows of
its neighbours alone, and sparse factors of the joints' equations stay sparse.
"""

from __future__ import annotations

import time
from math import cos, pi, sin
from typing import TYPE_CHECKING

import numpy as np
import saltus.kernel as sk

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from saltus.io import Trajectory
    from saltus.typing import FloatArray

GRAVITY = 9.81  # γ [m/s²]
MASS = 0.1  # m [kg], of a rod
LENGTH = 0.1  # l [m]
ACROSS = MASS * LENGTH**2 / 12  # [kg m²]
ALONG = 1e-3 * ACROSS  # a rod is thin
TIME_STEP = 1e-3  # [s]
SCHEME = "HalfExplicitTrapezoidalOSI(activity=sticky,stabilization=position)"

CAPTION = (
    "Ten rods are let go from the horizontal: the chain falls, whips about and swings back. The joints stay "
    "closed to rounding; the energy moves by less than 0.2 % of the largest kinetic one, when the chain "
    "whips."
)
WATCH = (
    "Ten rods are let go from the horizontal. Green arrows are the forces of the joints: largest in the "
    "uppermost ones, and where the free end whips about."
)


def build(n: int = 10, angles: FloatArray | float = 0.0) -> sk.NonSmoothDynamicalSystem:
    """Compose the chain, joints "0" … "n − 1" from the top.

    Parameters
    ----------
    n : number of rods >= 1
    angles : (n,) of the rods from the vertical, in the plane y = 0, or one for all [rad]

    Raises
    ------
    ValueError
        If there is no rod, or angles have another shape.
    """
    if n < 1:
        raise ValueError(f"expected at least one rod, got {n}")
    rods, ends = [], [np.zeros(3)]
    for angle in np.broadcast_to(angles, n):
        down = np.array([sin(angle), 0.0, -cos(angle)])
        centre = ends[-1] + LENGTH / 2 * down
        p = [cos(angle / 2), 0.0, -sin(angle / 2), 0.0]
        rod = sk.NewtonEulerDS(
            [*centre, *p], np.zeros(6), MASS, [ACROSS, ACROSS, ALONG], force=[0.0, 0.0, -MASS * GRAVITY]
        )
        rod.add_shape(sk.Cylinder(LENGTH / 20, LENGTH))
        rods.append(rod)
        ends.append(ends[-1] + LENGTH * down)
    system = sk.NonSmoothDynamicalSystem(rods, parameters={"n": n})
    for k, rod in enumerate(rods):
        above = [rods[k - 1]] if k else []
        joint = sk.Joint.ball(rod, *above, at=ends[k])
        law = sk.EqualityConditionNSL(joint.size)
        system.link(sk.Interaction(joint, law, name=str(k)), rod, *above)
    return system


def modes(n: int) -> tuple[FloatArray, FloatArray]:
    """Frequencies of small oscillations (n,) [rad/s], the slowest first, and angles as columns (n, n)."""
    i = np.arange(n)
    M = MASS * LENGTH**2 * (n - np.maximum.outer(i, i) - 0.5 - np.eye(n) / 6)
    scale = 1 / np.sqrt(MASS * GRAVITY * LENGTH * (n - i - 0.5))  # K^(-1/2): K is diagonal
    inverses, angles = np.linalg.eigh(scale * M * scale[:, None])
    return 1 / np.sqrt(inverses[::-1]), scale[:, None] * angles[:, ::-1]


def step_cost(n: int, steps: int = 100) -> float:
    """Time of one step of the falling chain [s], the median."""
    simulation = sk.TimeStepping(build(n, pi / 3), SCHEME, TIME_STEP, record_every=10**9)
    seconds = np.empty(steps)
    for k in range(steps):
        start = time.perf_counter()
        simulation.take_step()
        seconds[k] = time.perf_counter() - start
    return float(np.median(seconds))


def run() -> Trajectory:
    """The fall from the horizontal."""
    return sk.TimeStepping(build(10, pi / 2), SCHEME, TIME_STEP).run(1.5)


def picture(shown: Trajectory) -> Figure:
    """Draw the chain at some times, and what the energy does."""
    from matplotlib import colormaps
    from saltus.examples.figure import sheet

    rows = np.linspace(0, len(shown) - 1, 13).astype(int)
    with sheet(1, 2, (9, 4.5), width_ratios=[1.6, 1]) as (figure, (chain, energy)):
        for row in rows:
            color = colormaps["viridis_r"](row / rows[-1])
            chain.plot(*joints(shown.q[row]).T, "o-", color=color, markersize=2.5, linewidth=1)
        chain.set_aspect("equal")
        chain.set_xlabel("x [m]")
        chain.set_ylabel("z [m]")
        chain.set_title(f"every {shown.t[rows[1]]:.3f} s, darker as time goes on", loc="left")
        kinetic = shown.kinetic_energy.max()
        energy.plot(shown.t, 100 * (shown.energy - shown.energy[0]) / kinetic, color="black")
        energy.set_xlabel("time t [s]")
        energy.set_ylabel("energy gained, % of the largest kinetic one")
    return figure


def joints(q: FloatArray) -> FloatArray:
    """Places of all joints and of the free end (n + 1, 2), in the plane y = 0 [m]."""
    bodies = q.reshape(-1, 7)
    down = np.array([-sk.rotation_matrix(body[3:])[:, 2] for body in bodies])
    ends = bodies[:, :3] + LENGTH / 2 * down
    return np.asarray(np.vstack([np.zeros(3), ends])[:, [0, 2]])


def main() -> None:
    """Print forces at rest, the slowest oscillation, a fall and what a step costs."""
    run = sk.TimeStepping(build(10), SCHEME, TIME_STEP).run(0.1)
    forces = ", ".join(f"{run[str(k)].force[-1, 2]:.4f}" for k in range(10))
    print(f"at rest: {forces} N, exactly (10 − k) times {MASS * GRAVITY:.4f} N")
    frequencies, shapes = modes(10)
    angles = 1e-3 * shapes[:, 0] / shapes[-1, 0]
    period = 2 * pi / frequencies[0]
    run = sk.TimeStepping(build(10, angles), SCHEME, period / 2000).run(period)
    print(f"slowest period {period:.6f} s: after it x is off by {abs(run.q[-1, -7] / run.q[0, -7] - 1):.1e}")
    run = sk.TimeStepping(build(10, pi / 2), SCHEME, TIME_STEP).run(5.0)
    gap = max(np.abs(run[str(k)].gap).max() for k in range(10))
    lost = np.ptp(run.energy) / np.ptp(run.kinetic_energy)
    print(f"a fall: joints within {gap:.1e} m, energy within {lost:.1e}")
    for n in (25, 50, 100, 200):
        print(f"{n:4d} rods: {1e3 * step_cost(n):.3f} ms a step")


if __name__ == "__main__":
    main()
