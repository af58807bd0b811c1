"""The bent axle as it moves: what the numbers of a run look like."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FuncAnimation, PillowWriter
from saltus import plot
from saltus.examples.rotor.rotor import Parameters
from saltus.io import Trajectory

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D
    from saltus.typing import FloatArray

FRAMES, PER_SECOND = 125, 25  # of the animation
POINTS = 8  #: of an element, at which its centre line is drawn
P = Parameters()


def centre_line(q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Stations s (points,) [m] of the axle, and its deflection in space along y and z there (points, 2) [m].

    Parameters
    ----------
    q : (30,) its coordinates, (α, w, w', u, u') of each node
    """
    length = P.length / P.elements
    x = np.linspace(0.0, 1.0, POINTS, endpoint=False)
    shape = np.array([1 - 3 * x**2 + 2 * x**3, x - 2 * x**2 + x**3, 3 * x**2 - 2 * x**3, x**3 - x**2])
    shape[[1, 3]] *= length  # those of the slopes
    stations, deflection = [], []
    nodes = q.reshape(-1, 5)
    for k, (left, right) in enumerate(zip(nodes, nodes[1:], strict=False)):
        alpha = (1 - x) * left[0] + x * right[0]
        w = np.concatenate([left[1:3], right[1:3]]) @ shape
        u = np.concatenate([left[3:5], right[3:5]]) @ shape
        turned = [np.cos(alpha) * w - np.sin(alpha) * u, np.sin(alpha) * w + np.cos(alpha) * u]
        stations.append(length * (k + x))
        deflection.append(np.transpose(turned))
    return np.concatenate(stations), np.concatenate(deflection)


def animate(trajectory: Trajectory, way: FloatArray, path: Path) -> Path:
    """Write the axle from two sides and the frustum in its ring as an animated GIF.

    Parameters
    ----------
    trajectory : of the rotor
    way : (rows, 2) of the disc's centre in the ring [m]
    path : of the file, which is replaced
    """
    rows = np.linspace(0, len(trajectory.t) - 1, FRAMES).round().astype(int)
    lines = [centre_line(trajectory.q[row, : P.freedoms]) for row in rows]
    bent = 1e6 * np.array([deflection for _, deflection in lines])
    with plt.rc_context(plot.STYLE):
        picture = plt.figure(figsize=(8, 4.2), dpi=80, layout="constrained")
        sides = picture.subplot_mosaic([["y", "ring"], ["z", "ring"]], width_ratios=[1.7, 1.0])
        heading = picture.suptitle("")
        drawn = []
        for k, side in enumerate("yz"):
            sides[side].set(xlim=(0, 1e3 * P.length), ylim=(bent[..., k].min() - 20, bent[..., k].max() + 20))
            sides[side].set(xlabel="x [mm]", ylabel=f"{side} [µm]")
            sides[side].axvline(1e3 * P.flywheel_at, color="0.8", linewidth=6, zorder=0)
            drawn += sides[side].plot([], [], linewidth=2)
        dot, trace = draw_ring(sides["ring"], 1e6 * P.clearance)

        def show(frame: int) -> None:
            heading.set_text(f"Rotor, t = {1e3 * trajectory.t[rows[frame]]:.1f} ms")
            for k, line in enumerate(drawn):
                line.set_data(1e3 * lines[frame][0], bent[frame, :, k])
            dot.set_data(*(1e6 * way[rows[frame], None].T))
            trace.set_data(*(1e6 * way[: rows[frame] + 1].T))

        show(0)
        picture.draw_without_rendering()
        picture.set_layout_engine("none")  # it would be found again for every frame
        FuncAnimation(picture, show, frames=FRAMES).save(path, PillowWriter(PER_SECOND))
        plt.close(picture)
    return path


def draw_ring(ax: Axes, clearance: float) -> tuple[Line2D, Line2D]:
    """The circle in which the disc's centre can move; the lines of its place and of its way."""
    angle = np.linspace(0, 2 * np.pi, 200)
    ax.plot(clearance * np.cos(angle), clearance * np.sin(angle), color="black", linewidth=0.8)
    [trace] = ax.plot([], [], linewidth=0.6, color="C1")
    [dot] = ax.plot([], [], "o", color="C3")
    ax.set(aspect="equal", xlabel="horizontal [µm]", ylabel="vertical [µm]", title="frustum in the ring")
    return dot, trace
