"""``saltus demo``: the frictional slider crank, its convergence, a picture and a page of the run."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from rich.console import Console

from saltus import plot
from saltus.cli import reproduce
from saltus.cli.out import save, write_json
from saltus.examples.slider_crank import slider_crank
from saltus.examples.slider_crank.convergence import Row
from saltus.io import Trajectory
from saltus.io.files import writable_folder

SCHEME = "HalfExplicitTrapezoidalOSI"
SHORT = {
    "HalfExplicitTrapezoidalOSI": "half-explicit trapezoidal",
    "ExplicitMoreauJeanOSI": "explicit Moreau-Jean",
}


def run(out: Path) -> None:
    """Compute Table 3, then write trajectory, table, picture and page.

    Raises
    ------
    OSError
        If the folder cannot be written; nothing is computed then.
    """
    writable_folder(out)
    rows = reproduce.compute("table3")
    reproduce.print_table("table3", rows)
    finest = min((row for row in rows if row.scheme == SCHEME), key=lambda row: row.dt)
    finest.trajectory.to_hdf5(out / "slider_crank.h5")
    finest.trajectory.report(out / "slider_crank.html", title="Slider crank", caption=slider_crank.WATCH)
    write_json(reproduce.to_json(rows), out / "table3.json")
    save(picture(finest.trajectory, rows), out / "slider_crank.png")
    console = Console(soft_wrap=True)
    for name, what in [
        ("slider_crank.png", "picture"),
        ("slider_crank.html", "the motion, to be watched in a browser"),
        ("slider_crank.h5", f"trajectory, {SHORT[SCHEME]}, Δt = {finest.dt:.0e} s"),
        ("table3.json", "the table above"),
    ]:
        console.print(f"{out / name}  {what}", highlight=False)


def picture(trajectory: Trajectory, rows: Sequence[Row]) -> Figure:
    """Mechanism, gaps, forces, impulses, energy and convergence of the slider crank."""
    with plt.rc_context(plot.STYLE):
        figure, axes = plt.subplots(2, 3, figsize=(14, 6.2), layout="constrained")
        mechanism, gaps, energy, forces, impulses, convergence = axes.flat
        draw_mechanism(mechanism, trajectory)
        for ax, panel, title in [
            (gaps, plot.gaps, "Gaps of the corners: bouncing, then sliding"),
            (forces, plot.forces, "Forces λ: only while a corner stays closed"),
            (impulses, plot.impulses, "Impulses Λ: only at impacts"),
            (energy, plot.energy, "Energy: lost at impacts (grey) and by friction"),
        ]:
            panel(ax, trajectory)
            ax.set_title(title, loc="left")
            ax.set_xlabel("time t [s]")
        draw_convergence(convergence, rows)
        figure.suptitle(
            "Slider crank with impacts and dry friction, half-explicit trapezoidal rule, Δt = 1e-5 s"
        )
        return figure


def draw_mechanism(ax: Axes, trajectory: Trajectory) -> None:
    """Crank, rod and slider in some positions of the first turn."""
    first_turn = np.flatnonzero(trajectory.q[:, 0] < 2 * np.pi)
    plot.shapes(
        ax, trajectory, np.linspace(first_turn[-1] * 0.08, first_turn[-1] * 0.55, 4).astype(int).tolist()
    )
    ax.set_title("Crank, rod and slider in its notch", loc="left")


def draw_convergence(ax: Axes, rows: Sequence[Row]) -> None:
    """Errors over Δt, and the paper's."""
    for index, scheme in enumerate(dict.fromkeys(row.scheme for row in rows)):
        mine = [row for row in rows if row.scheme == scheme]
        steps = [row.dt for row in mine]
        ax.loglog(steps, [row.error for row in mine], "o-", color=f"C{index}", label=SHORT[scheme])
        printed = [(row.dt, row.paper) for row in mine if row.paper is not None]
        ax.loglog(
            *zip(*printed, strict=True), "x", color=f"C{index}", markersize=9, label="  the paper's values"
        )
    ax.set_xlabel("time step Δt [s]")
    ax.set_ylabel("error of the angles, spectral 2-norm")
    ax.set_title("Error against Δt = 1e-7 s (Table 3)", loc="left")
    ax.legend()
