"""Error against computing time: which integrator to choose for which motion.

The error is the largest deviation of the coordinates that are looked at, at a hundred times of a run, from a
reference; the time is the median of several runs of which nothing is recorded. Across impacts every scheme
with fixed steps is of first order, whatever it does between them, because an impact counts at the end of the
step in which it falls: only steps that end at impacts pay. Between impacts the order pays, and under stiff
forces only what is implicit.

``saltus reproduce work-precision`` measures the slider crank, ``python -m
saltus.examples.work_precision.work_precision`` all of the motions, for docs/choosing.md.
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
import saltus.kernel as sk
from saltus import _core, plot, registry
from saltus.examples.elastic_bar.elastic_bar import build as elastic_bar
from saltus.examples.heavy_top.heavy_top import build as heavy_top
from saltus.examples.rocking_block.rocking_block import build as rocking_block
from saltus.examples.rolling_sphere.rolling_sphere import build as rolling_sphere
from saltus.examples.slider_crank.slider_crank import build as slider_crank

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from saltus.typing import FloatArray

TIMES = 100  #: at which positions are compared
REPEATS = 5  #: of a run, unless it takes long
LONG = 0.2  #: [s]
EVENTS = "EventDrivenOSI(rtol={rtol:g}, velocity_tolerance=1e-5)"
ADAPTIVE = ("AdaptiveHalfExplicitOSI", "AdaptiveHalfExplicitOSI(method=trapezoidal)")
STICKY = "activity=sticky, impact=keep-resting-forces"
MOREAU, IMPLICIT, TRAPEZOIDAL, THIRD, HEM5, GALERKIN = (
    "ExplicitMoreauJeanOSI",
    "MoreauJeanOSI",
    "HalfExplicitTrapezoidalOSI",
    f"HalfExplicitRungeKuttaOSI({STICKY})",
    f"HalfExplicitRungeKuttaOSI(tableau=HEM5, {STICKY})",
    "DMinusGalerkinOSI(stages=3, activity=sticky)",
)

Progress = Callable[[str, float], None]
"""What is being computed, and the fraction of it that is done."""


@dataclass(frozen=True)
class Study:
    """A motion, and how it is integrated."""

    title: str
    build: Callable[[], sk.NonSmoothDynamicalSystem]
    until: float  #: [s]
    time_steps: tuple[float, ...]  #: of schemes with fixed steps [s]
    fixed: tuple[str, ...] = (MOREAU, IMPLICIT, TRAPEZOIDAL, THIRD, HEM5, GALERKIN)
    tolerances: tuple[float, ...] = (1e-4, 1e-6, 1e-8)
    event_driven: tuple[float, ...] = (1e-6, 1e-10)  #: its tolerances
    reference: str = EVENTS.format(rtol=1e-12)
    looked_at: int | None = None  #: so many of the first coordinates; None: all


CRANK = Study(
    "slider crank with impacts and friction, 0.1 s",
    lambda: slider_crank("frictional"),
    0.1,
    (2e-4, 1e-4, 5e-5, 2e-5, 1e-5, 5e-6, 2e-6, 1e-6, 5e-7, 2e-7),
    (MOREAU, TRAPEZOIDAL, THIRD),
    tuple(10.0**-k for k in range(3, 11)),
    (),
    looked_at=2,  # θ1 and θ2
)
STUDIES = (
    Study(
        "slider crank led by equality constraints, 0.1 s",
        lambda: slider_crank("equality"),
        0.1,
        (2e-4, 1e-4, 2e-5),
    ),
    Study("heavy top on a ball joint, 1 s", lambda: heavy_top(1.0), 1.0, (5e-3, 1e-3, 2e-4)),
    Study("sphere that slides, then rolls, 1 s", rolling_sphere, 1.0, (5e-3, 1e-3, 2e-4)),
    Study("block that rocks until it stands, 1.5 s", rocking_block, 1.5, (5e-3, 1e-3, 2e-4)),
    Study(
        "elastic bar of 50 elements that hits a wall, 1.5 ms",
        elastic_bar,
        1.5e-3,
        (3e-6, 1e-6, 1e-7),
        tolerances=(1e-7, 1e-9, 1e-10),
        event_driven=(),
        reference="AdaptiveHalfExplicitOSI(rtol=1e-12, atol=1e-12)",
    ),
)


@dataclass(frozen=True)
class Row:
    """One run."""

    integrator: str
    setting: str  #: its Δt, or its tolerance
    error: float  #: of the coordinates, [rad] of the slider crank
    ms: float  #: computing time of the run [ms]; infinite if it ends early


def rows(study: Study, progress: Progress) -> Iterator[Row]:
    """All runs, from the coarsest to the finest of each integrator."""
    grid = study.until / TIMES
    exact, _ = run(study, registry.make_integrator(study.reference), grid)
    runs = [
        (spec, f"time_step={dt:g}", registry.make_integrator(spec), dt)
        for spec in study.fixed
        for dt in study.time_steps
    ]
    for spec in ADAPTIVE:
        for tolerance in study.tolerances:
            runs.append((spec, f"rtol=atol={tolerance:g}", with_tolerance(spec, tolerance), grid))
    for rtol in study.event_driven:
        spec = EVENTS.format(rtol=rtol)
        runs.append(("EventDrivenOSI", f"rtol={rtol:g}", registry.make_integrator(spec), grid))
    for done, (name, setting, scheme, dt) in enumerate(runs):
        progress(f"{study.title}: {name}, {setting}", done / len(runs))
        yield measure(study, name, setting, scheme, dt, exact)


def with_tolerance(spec: str, tolerance: float) -> _core.OneStepIntegrator:
    """The integrator with this tolerance, absolute and relative."""
    scheme = registry.make_integrator(spec)
    return _core.make_integrator(scheme.name, {**scheme.options, "rtol": tolerance, "atol": tolerance})


def measure(
    study: Study, name: str, setting: str, scheme: _core.OneStepIntegrator, dt: float, exact: FloatArray
) -> Row:
    """The error of a run, and the time that it takes."""
    label = name.partition("(")[0] if name == THIRD else name
    try:
        positions, seconds = run(study, scheme, dt)
    except sk.SimulationError:
        return Row(label, setting, float("inf"), float("inf"))
    times = [seconds]
    while len(times) < REPEATS and sum(times) < LONG:
        times.append(run(study, scheme, dt)[1])
    error = float(np.abs(positions - exact).max())
    return Row(label, setting, error, 1e3 * statistics.median(times))


def run(study: Study, scheme: _core.OneStepIntegrator, dt: float) -> tuple[FloatArray, float]:
    """Positions at the times of comparison, and the computing time [s]; nothing is recorded."""
    simulation = _core.TimeSteppingBase(study.build(), scheme, dt, "auto")
    positions, seconds = [], 0.0
    for k in range(1, TIMES + 1):
        until = k * study.until / TIMES
        start = time.perf_counter()
        simulation.advance(until, None)
        seconds += time.perf_counter() - start
        positions.append(simulation.q[: study.looked_at])
    return np.array(positions), seconds


def error_at(rows: Sequence[Row], integrator: str, ms: float) -> float:
    """The error that an integrator has after this computing time.

    Between its runs on a double logarithmic scale, beyond them along the line of the last two.
    """
    points = sorted((log(row.ms), log(row.error)) for row in rows if row.integrator == integrator)
    k = next((k for k in range(1, len(points) - 1) if points[k][0] >= log(ms)), len(points) - 1)
    (x0, y0), (x1, y1) = points[k - 1], points[k]
    return exp(y0 + (y1 - y0) * (log(ms) - x0) / (x1 - x0))


def picture(study: Study, rows: Sequence[Row]) -> Figure:
    """Error over computing time, a line for each integrator."""
    with plt.rc_context(plot.STYLE):
        figure, ax = plt.subplots(figsize=(7, 5), layout="constrained")
        for name in dict.fromkeys(row.integrator for row in rows):
            own = [row for row in rows if row.integrator == name]
            ax.loglog([row.ms for row in own], [row.error for row in own], "o-", label=name)
        ax.set_xlabel("computing time [ms]")
        ax.set_ylabel("largest error of the coordinates")
        ax.set_title(study.title[0].upper() + study.title[1:], loc="left")
        ax.legend()
    return figure


def main() -> None:
    """Print all studies, a line for each integrator: setting, error, ms."""
    for study in (CRANK, *STUDIES):
        print(f"\n{study.title}")
        found = list(rows(study, lambda _what, _done: None))
        for name in dict.fromkeys(row.integrator for row in found):
            cells = [
                f"{r.setting.rpartition('=')[2]}: {r.error:.0e} in {r.ms:.2g} ms"
                for r in found
                if r.integrator == name
            ]
            print(f"  {name:<60} {'; '.join(cells)}")


if __name__ == "__main__":
    main()
