"""Pictures of runs. Every panel is a function (axes, trajectory), figures are made of panels."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.collections import LineCollection

from saltus.panels.contacts import (
    chosen,
    forces,
    friction,
    friction_impulses,
    gaps,
    has_tangents,
    impulses,
    mark_impacts,
    sliding,
    states,
    velocities,
)
from saltus.panels.drawing import STYLE, canvas, curves, grid, legend_strip
from saltus.panels.energy import defect, energies, energy, work

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from saltus.io import FirstOrderTrajectory, Trajectory
    from saltus.typing import AxesArray

__all__ = [
    "STYLE",
    "defect",
    "energies",
    "energy",
    "forces",
    "friction",
    "friction_impulses",
    "gaps",
    "grid",
    "impulses",
    "legend_strip",
    "mark_impacts",
    "plot_contacts",
    "plot_energy",
    "plot_first_order",
    "plot_trajectory",
    "positions",
    "shapes",
    "sliding",
    "states",
    "velocities",
    "work",
]


def plot_trajectory(
    trajectory: Trajectory,
    axes: Axes | Sequence[Axes] | AxesArray | None = None,
    contacts: Sequence[str] | None = None,
) -> AxesArray:
    """See `Trajectory.plot`."""
    trajectory = trajectory.loaded()
    names = chosen(trajectory, contacts)
    panels = ["positions", "gaps", "forces", "impulses", "energy"] if names else ["positions", "energy"]
    with canvas(axes, panels) as column:
        positions(column[0], trajectory)
        if names:
            gaps(column[1], trajectory, names)
            forces(column[2], trajectory, names, legend=False)
            impulses(column[3], trajectory, names, legend=False)
        energy(column[-1], trajectory)
    return column


def plot_contacts(
    trajectory: Trajectory,
    axes: Axes | Sequence[Axes] | AxesArray | None = None,
    contacts: Sequence[str] | None = None,
) -> AxesArray:
    """See `Trajectory.plot_contacts`."""
    trajectory = trajectory.loaded()
    names = chosen(trajectory, contacts)
    if not names:
        raise ValueError("expected a run with contacts, or names of some, got none to draw")
    panels = ["gaps", "velocities", "forces", "impulses", "states"]
    tangents = any(has_tangents(trajectory[name]) for name in names)
    if tangents:
        panels += ["sliding", "friction", "friction impulses"]
    with canvas(axes, panels, columns=1 + tangents) as each:
        gaps(each[0], trajectory, names, legend=False)  # the band has the names in their colours
        velocities(each[1], trajectory, names, legend=False)
        forces(each[2], trajectory, names, legend=False)
        impulses(each[3], trajectory, names, legend=False)
        states(each[4], trajectory, names)
        if tangents:
            sliding(each[5], trajectory, names)
            friction(each[6], trajectory, names)
            friction_impulses(each[7], trajectory, names)
    return each


def plot_energy(trajectory: Trajectory, axes: Axes | Sequence[Axes] | AxesArray | None = None) -> AxesArray:
    """See `Trajectory.plot_energy`."""
    trajectory = trajectory.loaded()
    with canvas(axes, ["energies", "work", "defect"]) as column:
        energies(column[0], trajectory)
        work(column[1], trajectory)
        defect(column[2], trajectory)
    return column


def plot_first_order(
    trajectory: FirstOrderTrajectory, axes: Axes | Sequence[Axes] | AxesArray | None = None
) -> AxesArray:
    """See `FirstOrderTrajectory.plot`."""
    panels = [("state", "x", [f"x{k}" for k in range(trajectory.x.shape[1])], trajectory.x)]
    entries = [(name, k) for name, size in trajectory.layout.interactions for k in range(size)]
    if entries:
        labels = [f"{name}[{k}]" for name, k in entries]
        panels += [("output", "y", labels, trajectory.y), ("multiplier", "λ", labels, trajectory.lambda_)]
    with canvas(axes, [what for what, *_ in panels]) as column:
        for (what, symbol, labels, values), ax in zip(panels, column, strict=True):
            curves(ax, trajectory.t, values, labels)
            ax.set_ylabel(f"{what} {symbol}")
    return column


def positions(ax: Axes, trajectory: Trajectory) -> None:
    """Positions q."""
    curves(ax, trajectory.t, trajectory.q, [f"q{k}" for k in range(trajectory.q.shape[1])])
    ax.set_ylabel("position q\n[m or rad]")


def shapes(ax: Axes, trajectory: Trajectory, rows: Sequence[int], plane: str = "xy") -> None:
    """The lines of all shapes in these rows of the run, the last one darkest."""
    if len(plane) != 2 or not set(plane) <= set("xyz"):
        raise ValueError(f"plane must be two of the axes x, y, z, as 'xy', got {plane!r}")
    axes = ["xyz".index(axis) for axis in plane]
    ax.set_aspect("equal")
    for order, row in enumerate(rows):
        shade = 0.3 + 0.7 * (order + 1) / len(rows)
        for index, shape in enumerate(trajectory.shapes):
            lines = shape.in_space(row)[shape.lines][:, :, axes]
            color = "0.3" if shape.system < 0 else f"C{index % 10}"
            ax.add_collection(LineCollection(list(lines), color=color, alpha=shade**2, linewidth=0.6 + shade))
    ax.autoscale_view()
    ax.set_xlabel(f"{plane[0]} [m]")
    ax.set_ylabel(f"{plane[1]} [m]")
