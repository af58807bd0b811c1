"""The picture of ``saltus converge``: errors over the time step."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from saltus import plot
from saltus.compare import Comparison, Row

LEAST_ERROR = 1e-12  #: below that it is rounding

#: what is drawn, and whose slopes are orders
ERRORS: dict[str, Callable[[Row], float | None]] = {
    "q": lambda row: row.normalised,
    "v": lambda row: row.error_v,
    "impulses": lambda row: row.impulse_error,
}
TITLES = {
    "q": "Positions: spectral norm / √N",
    "v": "Velocities away from jumps, scaled",
    "impulses": "Impulses of impacts, scaled",
}


def orders(found: Comparison) -> dict[str, float | None]:
    """Slopes of the errors over the time step, None where there are not two of them."""
    slopes: dict[str, float | None] = {}
    for what in ERRORS:
        steps, errors = series(found, what)
        slopes[what] = float(np.polyfit(np.log(steps), np.log(errors), 1)[0]) if len(steps) > 1 else None
    return slopes


def series(found: Comparison, what: str) -> tuple[list[float], list[float]]:
    """Time steps and errors of the runs that reached their end, as far as errors are more than rounding."""
    pairs = [(row.time_step, ERRORS[what](row)) for row in found.rows if not row.ended]
    told = [(step, error) for step, error in pairs if error is not None and error > LEAST_ERROR]
    return [step for step, _ in told], [error for _, error in told]


def draw(found: Sequence[Comparison]) -> Figure:
    """A panel for each kind of error, a line for each integrator with its order."""
    with plt.rc_context(plot.STYLE):
        figure, axes = plt.subplots(1, len(ERRORS), figsize=(13, 4.6), layout="constrained")
        for ax, what in zip(axes, ERRORS, strict=True):
            for index, comparison in enumerate(found):
                steps, errors = series(comparison, what)
                order = orders(comparison)[what]
                name = comparison.rows[0].integrator
                label = name if order is None else f"{name}, order {order:.2f}"
                ax.loglog(steps, errors, "o-", color=f"C{index % 10}", label=label)
            draw_slopes(ax, [series(comparison, what) for comparison in found])
            ax.set_title(TITLES[what], loc="left")
            ax.set_xlabel("time step Δt [s]")
        axes[0].set_ylabel("error")
        first = found[0]
        own = len({comparison.reference for comparison in found}) > 1
        who = "each integrator's own run" if own else first.reference
        figure.suptitle(
            f"{first.model} until {first.until:g} s against {who} with Δt = {first.reference_step:g} s"
        )
        return figure


def draw_slopes(ax: Axes, lines: Sequence[tuple[list[float], list[float]]]) -> None:
    """Grey lines of slope 1 and 2 through the largest error, and a legend below the data."""
    points = [(step, error) for steps, errors in lines for step, error in zip(steps, errors, strict=True)]
    if not points:
        ax.text(0.5, 0.5, "nothing to compare", transform=ax.transAxes, ha="center", color="0.5")
        return
    low, high = min(step for step, _ in points), max(step for step, _ in points)
    top = max(error for _, error in points)
    bottom = min(error for _, error in points)
    for slope, style in ((1, "--"), (2, ":")):
        ends = np.array([low, high])
        ax.loglog(ends, 1.5 * top * (ends / high) ** slope, style, color="0.6", linewidth=0.8, zorder=0)
        at = high * (low / high) ** 0.5
        ax.annotate(f"{slope}", (at, 1.5 * top * (at / high) ** slope), color="0.4", fontsize=8)
    ax.set_ylim(bottom=0.03 * bottom)
    ax.legend(loc="lower right")
