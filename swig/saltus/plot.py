"""Pictures of runs. Every panel is a function (axes, trajectory), figures are made of panels."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from saltus.io import FirstOrderTrajectory, Trajectory
    from saltus.typing import FloatArray

MOST_LINES = 12  #: more contacts than that are drawn without a legend
STYLE: Any = {
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.alpha": 0.25,
    "lines.linewidth": 1.1,
    "legend.fontsize": 8,
    "legend.frameon": False,
}


def plot_trajectory(trajectory: Trajectory) -> Figure:
    """Positions, gaps, forces, impulses and energy over time; grey lines mark impacts."""
    with plt.rc_context(STYLE):
        panels = [positions]
        if trajectory.contacts:
            panels += [gaps, forces, impulses]
        panels.append(energy)
        figure, axes = plt.subplots(
            len(panels), 1, figsize=(8, 2.2 * len(panels)), sharex=True, squeeze=False, layout="constrained"
        )
        for panel, ax in zip(panels, axes[:, 0], strict=True):
            panel(ax, trajectory)
        axes[-1, 0].set_xlabel("time t [s]")
        return figure


def plot_first_order(trajectory: FirstOrderTrajectory) -> Figure:
    """States, and of models with relations outputs and multipliers, over time."""
    panels = [("state", "x", [f"x{k}" for k in range(trajectory.x.shape[1])], trajectory.x)]
    entries = [(name, k) for name, size in trajectory.layout.interactions for k in range(size)]
    if entries:
        labels = [f"{name}[{k}]" for name, k in entries]
        panels += [("output", "y", labels, trajectory.y), ("multiplier", "λ", labels, trajectory.lambda_)]
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(
            len(panels), 1, figsize=(8, 2.2 * len(panels)), sharex=True, squeeze=False, layout="constrained"
        )
        for (what, symbol, labels, values), ax in zip(panels, axes[:, 0], strict=True):
            _lines(ax, trajectory.t, values, labels)
            ax.set_ylabel(f"{what} {symbol}")
        axes[-1, 0].set_xlabel("time t [s]")
        return figure


def _lines(ax: Axes, t: FloatArray, values: FloatArray, labels: Sequence[str]) -> None:
    lines = ax.plot(t, values)
    if len(lines) <= MOST_LINES:
        ax.legend(lines, labels, loc="upper right", ncols=4)


def positions(ax: Axes, trajectory: Trajectory) -> None:
    """Positions q."""
    _lines(ax, trajectory.t, trajectory.q, [f"q{k}" for k in range(trajectory.q.shape[1])])
    ax.set_ylabel("position q\n[m or rad]")


def gaps(ax: Axes, trajectory: Trajectory) -> None:
    """Gap g of every contact."""
    for index, name in enumerate(trajectory.contacts):
        ax.plot(trajectory.t, trajectory[name].gap * 1e3, _line(index), label=name)
    ax.axhline(0.0, color="black", linewidth=0.6)
    ax.set_ylabel("gap g [mm]")
    _legend(ax, trajectory)


def forces(ax: Axes, trajectory: Trajectory) -> None:
    """Normal force of every contact, the mean of λ⁺ and λ⁻."""
    for index, name in enumerate(trajectory.contacts):
        ax.plot(trajectory.t, trajectory[name].force[:, 0], _line(index), label=name)
    mark_impacts(ax, trajectory)
    ax.set_ylabel("force λ_N [N]")
    _legend(ax, trajectory)


def impulses(ax: Axes, trajectory: Trajectory) -> None:
    """Normal impulse Λ of every contact, where there is one."""
    for index, name in enumerate(trajectory.contacts):
        impulse = trajectory[name].impulse[:, 0]
        rows = np.flatnonzero(impulse)
        color = f"C{index % 10}"
        ax.vlines(trajectory.t[rows], 0.0, impulse[rows], color=color, linewidth=1.0)
        ax.plot(trajectory.t[rows], impulse[rows], "o", markersize=3.5, color=color, label=name)
    ax.set_ylabel("impulse Λ_N [N s]")
    _legend(ax, trajectory)


def energy(ax: Axes, trajectory: Trajectory) -> None:
    """Total energy, or the kinetic one where a system does not know its potential."""
    known = bool(np.isfinite(trajectory.energy).all())
    ax.plot(trajectory.t, trajectory.energy if known else trajectory.kinetic_energy, color="black")
    mark_impacts(ax, trajectory)
    ax.set_ylabel("total energy [J]" if known else "kinetic energy [J]")


def shapes(ax: Axes, trajectory: Trajectory, rows: Sequence[int], plane: str = "xy") -> None:
    """The lines of all shapes in these rows of the run, the last one darkest."""
    axes = ["xyz".index(axis) for axis in plane]
    ax.set_aspect("equal")
    for order, row in enumerate(rows):
        shade = 0.3 + 0.7 * (order + 1) / len(rows)
        for index, shape in enumerate(trajectory.shapes):
            lines = shape.in_space(row)[shape.lines][:, :, axes]
            ax.add_collection(
                LineCollection(list(lines), color=f"C{index % 10}", alpha=shade**2, linewidth=0.6 + shade)
            )
    ax.autoscale_view()
    ax.set_xlabel(f"{plane[0]} [m]")
    ax.set_ylabel(f"{plane[1]} [m]")


def mark_impacts(ax: Axes, trajectory: Trajectory) -> None:
    """Grey lines at the impulsive steps."""
    times = trajectory.t[trajectory.impulsive]
    if len(times) < len(trajectory) / 2:  # where every step is one, marks say nothing
        for t in times:
            ax.axvline(t, color="0.8", linewidth=0.5, zorder=0)


def _line(index: int) -> str:
    """Every other line is dashed, so that one on top of another leaves it visible."""
    return "-" if index % 2 == 0 else "--"


def legend_strip(ax: Axes, columns: int = 4) -> None:
    """Legend in a strip above the data."""
    low, high = ax.get_ylim()
    lines = -(-len(ax.get_legend_handles_labels()[1]) // columns)
    ax.set_ylim(low, high + (0.05 + 0.15 * lines) * (high - low))
    ax.legend(loc="upper center", ncols=columns)


def _legend(ax: Axes, trajectory: Trajectory) -> None:
    if 0 < len(trajectory.contacts) <= MOST_LINES:
        legend_strip(ax)
