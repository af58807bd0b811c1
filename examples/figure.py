"""What a figure of the paper shows, drawn again, and the numbers that can be read off it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from saltus import plot

#: how the schemes are called in legends
SHORT = {
    "DMinusAccelerationOSI": "acceleration level",
    "HalfExplicitTrapezoidalOSI": "velocity level",
    "ExplicitMoreauJeanOSI": "explicit Moreau-Jean",
}


@dataclass(frozen=True)
class Quantity:
    """One number behind a figure."""

    scheme: str
    quantity: str
    value: float
    unit: str


@dataclass(frozen=True)
class PaperFigure:
    """A figure of the paper: its caption, the numbers behind it and the picture."""

    caption: str
    quantities: tuple[Quantity, ...]
    picture: Figure

    def value(self, scheme: str, quantity: str) -> float:
        """The number of that name. Raises KeyError if there is none."""
        for entry in self.quantities:
            if (entry.scheme, entry.quantity) == (scheme, quantity):
                return entry.value
        raise KeyError(f"no {quantity!r} of {scheme!r} in {self.caption!r}")


@contextmanager
def panels(titles: Sequence[str], heading: str, height: float = 2.4) -> Iterator[tuple[Figure, list[Axes]]]:
    """Panels over a common time axis, one below the other; what is drawn inside takes the house's style."""
    with plt.rc_context(plot.STYLE):
        picture, axes = plot.grid(len(titles), height=height + 0.6 / len(titles))
        picture.suptitle(heading)
        column = list(axes[:, 0])
        for ax, title in zip(column, titles, strict=True):
            ax.set_title(title, loc="left")
        yield picture, column


@contextmanager
def sheet(
    rows: int = 1, columns: int = 1, size: tuple[float, float] = (8, 4), **grid: Any
) -> Iterator[tuple[Figure, list[Axes]]]:
    """Axes of a picture, row by row; what is drawn inside takes the house's style."""
    with plt.rc_context(plot.STYLE):
        picture, axes = plt.subplots(rows, columns, figsize=size, squeeze=False, layout="constrained", **grid)
        yield picture, list(axes.flat)
