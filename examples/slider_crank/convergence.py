"""Tables 2 and 3 of the paper: errors of the slider crank over the time step.

An error is the spectral 2-norm of the 3 x N matrix of differences of q over the N steps of a run until
T = 0.1 s. It grows with the square root of N, so that orders are taken from error / √N.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import asin, cos, log, sin, sqrt
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import saltus.kernel as sk
from saltus._core import SliderCrankParameters
from saltus.examples.slider_crank.slider_crank import Guidance, SliderCrank, build
from scipy.integrate import solve_ivp

if TYPE_CHECKING:
    from saltus.io import Trajectory
    from saltus.typing import FloatArray

END = 0.1  #: [s]
TIME_STEPS = (1e-3, 1e-4, 1e-5)  #: [s]
SCHEMES = ("ExplicitMoreauJeanOSI", "HalfExplicitTrapezoidalOSI")
REFERENCE_STEP = 1e-7  #: of Table 3 [s]

Progress = Callable[[str, float], None]
"""What is being computed, and the fraction of it that is done."""


@dataclass(frozen=True)
class Row:
    """One entry of a table."""

    scheme: str
    variant: str
    dt: float  #: [s]
    error: float  #: spectral 2-norm
    normalised: float  #: error / √N
    paper: float | None  #: printed in the paper
    order: float | None  #: from error / √N of this Δt and the one before
    us_per_step: float  #: computing time, almost nothing recorded [µs]
    trajectory: Trajectory


def paper_values(table: str) -> dict[str, dict[str, float]]:
    """The values printed in the paper, {scheme: {Δt: error}}, and the ratio of costs."""
    text = (Path(__file__).parent / "paper_values.json").read_text()
    values: dict[str, dict[str, float]] = json.loads(text)[table]
    return values


def table2(progress: Progress) -> Iterator[Row]:
    """Bilateral slider crank against minimal coordinates, with four corners and with equalities."""
    steps = round(END / min(TIME_STEPS))
    times: FloatArray = min(TIME_STEPS) * np.arange(1.0, steps + 1)
    reference = bilateral_reference(times)
    for variant in ("c=0", "equality"):
        yield from rows("table2", variant, variant, reference, progress)


def table3(progress: Progress) -> Iterator[Row]:
    """Unilateral slider crank with friction against the half-explicit scheme at Δt = 1e-7 s."""
    yield from rows("table3", "frictional", "friction", frictional_reference(progress), progress)


def rows(
    table: str, guidance: Guidance, variant: str, reference: FloatArray, progress: Progress
) -> Iterator[Row]:
    """All schemes and time steps of one variant; reference (N, 3) at the multiples of the finest Δt."""
    printed = paper_values(table)
    for scheme in SCHEMES:
        before: Row | None = None
        for dt in TIME_STEPS:
            progress(f"{scheme}, {variant}, Δt = {dt:g} s", 0.0)
            trajectory, cost = run(guidance, scheme, dt)
            stride = round(dt / min(TIME_STEPS))
            error = float(np.linalg.norm(trajectory.q[1:] - reference[stride - 1 :: stride], 2))
            normalised = error / sqrt(len(trajectory) - 1)
            order = None if before is None else log(before.normalised / normalised) / log(before.dt / dt)
            paper = printed[scheme].get(f"{dt:.5f}".rstrip("0"))
            before = Row(scheme, variant, dt, error, normalised, paper, order, cost, trajectory)
            yield before


def run(guidance: Guidance, scheme: str, dt: float) -> tuple[Trajectory, float]:
    """The whole trajectory, and the computing time per step [µs] of a second run that records little."""
    trajectory = sk.TimeStepping(build(guidance), scheme, dt).run(END)
    bare = sk.TimeStepping(build(guidance), scheme, dt, record_every=10**9)
    start = time.perf_counter()
    bare.run(END)
    return trajectory, (time.perf_counter() - start) / bare.steps * 1e6


def frictional_reference(progress: Progress) -> FloatArray:
    """Positions (N, 3) at the multiples of the finest Δt, half-explicit with Δt = 1e-7 s."""
    stride = round(min(TIME_STEPS) / REFERENCE_STEP)
    simulation = sk.TimeStepping(
        build("frictional"), "HalfExplicitTrapezoidalOSI", REFERENCE_STEP, record_every=stride
    )
    label = f"reference, Δt = {REFERENCE_STEP:g} s"
    trajectory = simulation.run(END, lambda t: progress(label, t / END))
    positions: FloatArray = trajectory.q[(trajectory.step % stride == 0) & (trajectory.step > 0)]
    return positions


def bilateral_reference(times: FloatArray) -> FloatArray:
    """Positions (len(times), 3) of the bilateral mechanism: one freedom, tolerance 1e-12.

    θ2 follows from l1 sin θ1 + l2 sin θ2 = 0, so v = (1, k, 0) ω1 with k = −(l1 cos θ1)/(l2 cos θ2), and
    Newton's equations are projected on this direction.
    """
    p = SliderCrankParameters()
    model = SliderCrank([0.0, 0.0, 0.0], [0.0, 0.0, 0.0], p)
    M, h = np.zeros((3, 3)), np.zeros(3)

    def rod(theta1: float) -> float:
        return -asin(p.l1 / p.l2 * sin(theta1))

    def motion(t: float, y: FloatArray) -> list[float]:
        theta1, omega1 = y
        theta2 = rod(theta1)
        k = -(p.l1 * cos(theta1)) / (p.l2 * cos(theta2))
        dk = (p.l1 * sin(theta1) - p.l1 * cos(theta1) * sin(theta2) * k / cos(theta2)) / (p.l2 * cos(theta2))
        direction = np.array([1.0, k, 0.0])
        q = np.array([theta1, theta2, 0.0])
        model.mass(q, M)
        model.forces(t, q, direction * omega1, h)
        bend = np.array([0.0, dk * omega1**2, 0.0])
        return [omega1, float(direction @ (h - M @ bend) / (direction @ M @ direction))]

    solution = solve_ivp(
        motion, (0.0, times[-1]), [0.0, 150.0], method="DOP853", rtol=1e-12, atol=1e-12, t_eval=times
    )
    theta1 = solution.y[0]
    positions: FloatArray = np.column_stack([theta1, [rod(x) for x in theta1], np.zeros_like(theta1)])
    return positions
