"""Error against computing time, on the slider crank with impacts and friction until T = 0.1 s.

The error is the largest deviation of θ1 and θ2 [rad] at t = 1, 2, … 100 ms from a run of EventDrivenOSI with
a tolerance of 1e-12; the time is the median of several runs of which nothing is
recorded. Across impacts every scheme with fixed steps is of first order, whatever it does between them,
because an impact counts at the end of the step in which it falls: only steps that end at impacts pay.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from math import exp, log
from typing import TYPE_CHECKING

import matplotlib.pyplot as plt
import numpy as np
from saltus import _core, plot, registry
from saltus.examples.slider_crank.slider_crank import build

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from saltus.typing import FloatArray

END = 0.1  #: [s]
GRID = 1e-3  #: of the times at which positions are compared [s]
REFERENCE = "EventDrivenOSI(rtol=1e-12, velocity_tolerance=1e-5)"  #: its error is below 1e-10
TIME_STEPS = (2e-4, 1e-4, 5e-5, 2e-5, 1e-5, 5e-6, 2e-6, 1e-6, 5e-7, 2e-7)  #: [s]
TOLERANCES = tuple(10.0**-k for k in range(3, 11))
REPEATS = 5  #: of a run, unless it takes long
LONG = 0.2  #: [s]

FIXED = {
    "ExplicitMoreauJeanOSI": "ExplicitMoreauJeanOSI",
    "HalfExplicitTrapezoidalOSI": "HalfExplicitTrapezoidalOSI",
    "HalfExplicitRungeKuttaOSI": "HalfExplicitRungeKuttaOSI(activity=sticky, impact=keep-resting-forces)",
}
ADAPTIVE = ("AdaptiveHalfExplicitOSI", "AdaptiveHalfExplicitOSI(method=trapezoidal)")

Progress = Callable[[str, float], None]
"""What is being computed, and the fraction of it that is done."""


@dataclass(frozen=True)
class Row:
    """One run."""

    integrator: str  #: one of FIXED or ADAPTIVE
    setting: str  #: its Δt, or its tolerance
    error: float  #: in (θ1, θ2) [rad]
    ms: float  #: computing time of the run [ms]


def rows(progress: Progress) -> Iterator[Row]:
    """All runs, from the coarsest to the finest of each integrator."""
    exact, _ = run(registry.make_integrator(REFERENCE), GRID)
    for done, (name, spec) in enumerate(FIXED.items()):
        for dt in TIME_STEPS:
            progress(f"{name}, Δt = {dt:g} s", done / (len(FIXED) + len(ADAPTIVE)))
            yield measure(name, f"time_step={dt:g}", registry.make_integrator(spec), dt, exact)
    for done, spec in enumerate(ADAPTIVE, len(FIXED)):
        for tolerance in TOLERANCES:
            progress(f"{spec}, tolerance {tolerance:g}", done / (len(FIXED) + len(ADAPTIVE)))
            setting = f"rtol=atol={tolerance:g}"
            yield measure(spec, setting, adaptive(spec, tolerance), GRID, exact)


def adaptive(spec: str, tolerance: float) -> _core.OneStepIntegrator:
    """The integrator with this tolerance, absolute and relative."""
    scheme = registry.make_integrator(spec)
    return _core.make_integrator(scheme.name, {**scheme.options, "rtol": tolerance, "atol": tolerance})


def measure(name: str, setting: str, scheme: _core.OneStepIntegrator, dt: float, exact: FloatArray) -> Row:
    """The error of a run, and the time that it takes."""
    positions, seconds = run(scheme, dt)
    times = [seconds]
    while len(times) < REPEATS and sum(times) < LONG:
        times.append(run(scheme, dt)[1])
    error = float(np.abs(positions - exact)[:, :2].max())
    return Row(name, setting, error, 1e3 * statistics.median(times))


def run(scheme: _core.OneStepIntegrator, dt: float) -> tuple[FloatArray, float]:
    """Positions (100, 3) on the grid of times, and the computing time [s]; nothing is recorded."""
    simulation = _core.TimeSteppingBase(build("frictional"), scheme, dt, "auto")
    positions = np.empty((round(END / GRID), 3))
    seconds = 0.0
    for k in range(len(positions)):
        start = time.perf_counter()
        simulation.advance((k + 1) * GRID, None)
        seconds += time.perf_counter() - start
        positions[k] = simulation.q
    return positions, seconds


def error_at(rows: Sequence[Row], integrator: str, ms: float) -> float:
    """The error that an integrator has after this computing time.

    Between its runs on a double logarithmic scale, beyond them along the line of the last two.
    """
    points = sorted((log(row.ms), log(row.error)) for row in rows if row.integrator == integrator)
    k = next((k for k in range(1, len(points) - 1) if points[k][0] >= log(ms)), len(points) - 1)
    (x0, y0), (x1, y1) = points[k - 1], points[k]
    return exp(y0 + (y1 - y0) * (log(ms) - x0) / (x1 - x0))


def picture(rows: Sequence[Row]) -> Figure:
    """Error over computing time, a line for each integrator."""
    with plt.rc_context(plot.STYLE):
        figure, ax = plt.subplots(figsize=(7, 5), layout="constrained")
        for name in dict.fromkeys(row.integrator for row in rows):
            own = [row for row in rows if row.integrator == name]
            ax.loglog([row.ms for row in own], [row.error for row in own], "o-", label=name)
        ax.set_xlabel("computing time [ms]")
        ax.set_ylabel("error in θ1, θ2 [rad]")
        ax.set_title("Slider crank with impacts and friction, 0.1 s", loc="left")
        ax.legend()
    return figure
