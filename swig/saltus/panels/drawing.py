"""What all pictures share: style, figures of panels, curves with many points, legends, marks of times."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.font_manager import FontProperties

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from saltus.typing import AxesArray, FloatArray, IntArray

MOST_LINES = 12  #: more than that are drawn without a legend
PIECES = 2000  #: of a curve with many rows, each drawn by its extremes: more than a picture has pixels
LEGEND: Any = {"fontsize": "small", "frameon": False}
STYLE: Any = {
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.alpha": 0.25,
    "lines.linewidth": 1.1,
    "legend.fontsize": LEGEND["fontsize"],
    "legend.frameon": LEGEND["frameon"],
}
TIME = "time t [s]"


def grid(rows: int, columns: int = 1, height: float = 2.2) -> tuple[Figure, AxesArray]:
    """A figure and its axes (rows, columns) over a common time axis. The house's style is the caller's."""
    size = (8 if columns == 1 else 12, height * rows)
    figure, axes = plt.subplots(rows, columns, figsize=size, sharex=True, squeeze=False, layout="constrained")
    for ax in axes[-1]:
        ax.set_xlabel(TIME)
    figure.align_ylabels()
    return figure, axes


@contextmanager
def canvas(
    axes: Axes | Sequence[Axes] | AxesArray | None, names: Sequence[str], columns: int = 1
) -> Iterator[AxesArray]:
    """Axes (panels,) to draw these panels into: those given, or of a new figure in the house's style.

    A new figure's panels stand below each other, a column after the other.

    Raises
    ------
    ValueError
        If axes are given, but not one for each panel.
    """
    if axes is None:
        with plt.rc_context(STYLE):
            yield grid(-(-len(names) // columns), columns)[1].T.ravel()
        return
    given = np.ravel(np.array(axes, dtype=object))
    if len(given) != len(names) or not all(isinstance(ax, Axes) for ax in given):
        kinds = ", ".join(sorted({type(ax).__name__ for ax in given}))
        raise ValueError(
            f"expected {len(names)} axes for the panels {', '.join(names)}; got {len(given)} of {kinds}"
        )
    yield given
    for ax in given:
        ax.set_xlabel(TIME)


def curve(ax: Axes, t: FloatArray, values: FloatArray, **style: Any) -> None:
    """Values (rows,) over time, drawn by a few thousand points that show every peak."""
    rows = extremes(values)
    ax.plot(t[rows], values[rows], **style)


def curves(ax: Axes, t: FloatArray, values: FloatArray, labels: Sequence[str]) -> None:
    """The columns of values (rows, n) over time, with a legend if they are not too many."""
    for column, label in zip(values.T, labels, strict=True):
        curve(ax, t, column, label=label)
    if 0 < len(labels) <= MOST_LINES:
        legend_strip(ax, columns=6)


def extremes(values: FloatArray) -> IntArray:
    """Rows of a curve (rows,) that show it: first, last, lowest and highest of each of 2000 pieces."""
    rows = len(values)
    if rows <= 4 * PIECES:
        return np.arange(rows)
    width = rows // PIECES
    start = width * np.arange(PIECES)
    pieces = values[: width * PIECES].reshape(PIECES, width)
    unknown = np.isnan(pieces)
    low = np.where(unknown, np.inf, pieces).argmin(axis=1)
    high = np.where(unknown, -np.inf, pieces).argmax(axis=1)
    rest = np.arange(width * PIECES, rows)
    return np.unique(np.concatenate([start, start + low, start + high, start + width - 1, rest]))


def mark_times(ax: Axes, times: FloatArray) -> None:
    """Thin grey lines over the height of the axes."""
    if len(times) > PIECES:
        pixels = np.floor((times - times[0]) / (times[-1] - times[0]) * PIECES)
        times = times[np.unique(pixels, return_index=True)[1]]
    lines = np.zeros((len(times), 2, 2))
    lines[:, :, 0] = times[:, None]
    lines[:, 1, 1] = 1.0
    marks = LineCollection(
        list(lines), colors="0.8", linewidths=0.5, zorder=0, transform=ax.get_xaxis_transform()
    )
    ax.add_collection(marks, autolim=False)


def legend_strip(ax: Axes, columns: int = 4) -> None:
    """Legend in a strip above the data, of more than two lines above the axes."""
    low, high = ax.get_ylim()
    labels = ax.get_legend_handles_labels()[1]
    columns = fitting_columns(ax, labels, columns)
    lines = -(-len(labels) // columns)
    if lines > 2:
        ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns, borderaxespad=0.2, **LEGEND)
        return
    ax.set_ylim(low, high + (0.05 + 0.15 * lines) * (high - low))
    ax.legend(loc="upper center", ncols=columns, **LEGEND)


def fitting_columns(ax: Axes, labels: Sequence[str], most: int) -> int:
    """Columns of a legend that are about as wide as the axes together, at most so many."""
    size = FontProperties(size=LEGEND["fontsize"]).get_size_in_points() / 72  # [inch]
    entry = size * (0.55 * max(map(len, labels), default=0) + 4.5)  # with its line
    width = ax.get_window_extent().width / ax.figure.dpi
    return max(1, min(most, int(width / entry)))
