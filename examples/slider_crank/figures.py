"""Figures 4, 5, 7 and 8 of the paper: the slider crank without friction, ε = 0.4, Δt = 1e-4 s, until 0.1 s.

The motion is symmetric: left and right corners hit a wall together, so one of each pair is drawn.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import saltus.kernel as sk
from saltus import plot
from saltus.examples.figure import SHORT, PaperFigure, Quantity, panels
from saltus.examples.slider_crank.slider_crank import build

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from saltus.io import Trajectory
    from saltus.typing import FloatArray

END = 0.1  #: [s]
TIME_STEP = 1e-4  #: [s]
ACCELERATION, VELOCITY, MOREAU = (
    "DMinusAccelerationOSI",
    "HalfExplicitTrapezoidalOSI",
    "ExplicitMoreauJeanOSI",
)
WALLS = {"upper": "C0", "lower": "C1"}
NEAR = 0.1  #: what is seen of the gaps near the walls [mm]
COMMON = "slider crank without friction, ε = 0.4, Δt = 1e-4 s"


def run(scheme: str) -> Trajectory:
    """The run that all of these figures look at."""
    return sk.TimeStepping(build("frictionless"), scheme, TIME_STEP).run(END)


def figure_4() -> PaperFigure:
    """Gaps on acceleration level: an impact is captured after it happened, and lasting contact drifts."""
    trajectory = run(ACCELERATION)
    titles = [
        "Gaps of the slider's corners (left and right coincide)",
        "Near the walls: penetration and drift",
    ]
    with panels(titles, f"Fig. 4: {COMMON}, {SHORT[ACCELERATION]}") as (picture, (whole, near)):
        for ax in (whole, near):
            draw_gaps(ax, trajectory, "-", "corners")
        near.set_ylim(-NEAR, NEAR)
        plot.legend_strip(whole)
    return PaperFigure(
        "Normal gap functions of the slider for half-explicit timestepping on acceleration level",
        (*penetrations(trajectory), asymmetry(trajectory)),
        picture,
    )


def figure_5() -> PaperFigure:
    """Energy on acceleration level: lost at impacts, but not always decreasing between them."""
    trajectory = run(ACCELERATION)
    rise = np.diff(trajectory.energy, prepend=trajectory.energy[0])
    titles = ["Total energy (grey: impacts)", "Its change since the start without the losses at impacts"]
    with panels(titles, f"Fig. 5: {COMMON}, {SHORT[ACCELERATION]}") as (picture, (whole, between)):
        plot.energy(whole, trajectory)
        smooth = np.cumsum(np.where(trajectory.impulsive, 0.0, rise))
        between.plot(trajectory.t, 1e3 * smooth, color="black")
        plot.mark_impacts(between, trajectory)
        between.set_ylabel("change of energy [mJ]")
    return PaperFigure(
        "Total energy of the slider-crank mechanism for half-explicit timestepping on acceleration level",
        (
            Quantity(ACCELERATION, "energy at the start", trajectory.energy[0], "J"),
            Quantity(ACCELERATION, "energy at the end", trajectory.energy[-1], "J"),
            Quantity(ACCELERATION, "lost in impulsive steps", -rise[trajectory.impulsive].sum(), "J"),
            Quantity(ACCELERATION, "largest rise in a step", rise.max(), "J"),
            Quantity(ACCELERATION, "sum of all rises", rise[rise > 0].sum(), "J"),
        ),
        picture,
    )


def figure_7() -> PaperFigure:
    """Gaps on both levels: the velocity level does not drift."""
    runs = {scheme: run(scheme) for scheme in (ACCELERATION, VELOCITY, MOREAU)}
    titles = [
        "Gaps of the slider's corners (left and right coincide)",
        "Near the walls",
        "Largest penetration of all corners, Moreau-Jean beside",
    ]
    with panels(titles, f"Fig. 7: {COMMON}") as (picture, (whole, near, depth)):
        for scheme, style in ((VELOCITY, "-"), (ACCELERATION, "--")):
            for ax in (whole, near):
                draw_gaps(ax, runs[scheme], style, f"corners, {SHORT[scheme]}")
        near.set_ylim(-NEAR, NEAR)
        plot.legend_strip(whole, columns=2)
        for scheme, style in ((VELOCITY, "k-"), (ACCELERATION, "k--"), (MOREAU, "C3-")):
            depth.plot(runs[scheme].t, 1e3 * runs[scheme].penetration, style, label=SHORT[scheme])
        depth.set_ylabel("penetration [mm]")
        plot.legend_strip(depth)
    return PaperFigure(
        "Normal gap functions of the slider for half-explicit timestepping on acceleration (dashed) and "
        "velocity level (solid)",
        tuple(quantity for trajectory in runs.values() for quantity in penetrations(trajectory)),
        picture,
    )


def figure_8() -> PaperFigure:
    """Multipliers on velocity level: forces λ in lasting contact, impulses Λ at impacts, never both."""
    trajectory = run(VELOCITY)
    titles = [
        "Contact force λ⁺ at the start of a step (grey: impacts)",
        "Contact force λ⁻ at its end",
        "Impulse Λ at its end",
    ]
    with panels(titles, f"Fig. 8: {COMMON}, {SHORT[VELOCITY]}") as (picture, axes):
        draw_multipliers(axes, trajectory)
    return PaperFigure(
        "Lagrange multipliers of the slider-crank mechanism for half-explicit timestepping on velocity level",
        multipliers(trajectory),
        picture,
    )


def draw_gaps(ax: Axes, trajectory: Trajectory, style: str, label: str) -> None:
    """Gap of one corner at each wall [mm]."""
    for wall, color in WALLS.items():
        gap = trajectory[f"{wall} left"].gap[:, 0]
        ax.plot(trajectory.t, 1e3 * gap, style, color=color, label=f"{wall} {label}")
    ax.axhline(0.0, color="black", linewidth=0.6)
    ax.set_ylabel("gap $g_N$ [mm]")


def draw_multipliers(axes: list[Axes], trajectory: Trajectory) -> None:
    """λ⁺, λ⁻ and Λ of one corner at each wall."""
    at_start, at_end, impulse = axes
    for wall, color in WALLS.items():
        corner = trajectory[f"{wall} left"]
        at_start.plot(trajectory.t, corner.lambda_plus[:, 0], color=color, label=f"{wall} corners, each")
        at_end.plot(trajectory.t, corner.lambda_minus[:, 0], color=color)
        hits = np.flatnonzero(corner.impulse[:, 0])
        impulse.vlines(trajectory.t[hits], 0.0, 1e3 * corner.impulse[hits, 0], color=color, linewidth=1.0)
        impulse.plot(trajectory.t[hits], 1e3 * corner.impulse[hits, 0], "o", markersize=3.5, color=color)
    for ax in (at_start, at_end):
        plot.mark_impacts(ax, trajectory)
    plot.legend_strip(at_start)
    at_start.set_ylabel(r"$\lambda_N^+$ [N]")
    at_end.set_ylabel(r"$\lambda_N^-$ [N]")
    impulse.set_ylabel(r"$\Lambda_N$ [mN s]")


def penetrations(trajectory: Trajectory) -> tuple[Quantity, ...]:
    """How deep and when, and how deep where a force λ acts: there contact lasts, and drift shows."""
    scheme = trajectory.provenance.integrator
    depth = trajectory.penetration
    found = [
        Quantity(scheme, "largest penetration", depth.max(), "m"),
        Quantity(scheme, "time of the largest penetration", trajectory.t[depth.argmax()], "s"),
    ]
    contacts = [trajectory[name] for name in trajectory.contacts]
    lasting = [-contact.gap[contact.force[:, 0] > 0.0].min(initial=0.0) for contact in contacts]
    if any(lasting):
        found.append(Quantity(scheme, "largest penetration in lasting contact", max(lasting), "m"))
    return tuple(found)


def asymmetry(trajectory: Trajectory) -> Quantity:
    """Largest difference of the gaps of left and right corners."""
    pairs = [(trajectory[f"{wall} left"].gap, trajectory[f"{wall} right"].gap) for wall in WALLS]
    largest = max(float(np.abs(left - right).max()) for left, right in pairs)
    return Quantity(trajectory.provenance.integrator, "largest difference of left and right", largest, "m")


def multipliers(trajectory: Trajectory) -> tuple[Quantity, ...]:
    """Extremes of the multipliers, and in how many steps they act."""

    def normal(column: str) -> FloatArray:
        return np.column_stack([getattr(trajectory[name], column)[:, 0] for name in trajectory.contacts])

    plus, minus, impulse = normal("lambda_plus"), normal("lambda_minus"), normal("impulse")
    pressed = ((plus > 0.0) | (minus > 0.0)).any(axis=1)
    hit = (impulse > 0.0).any(axis=1)
    scheme = trajectory.provenance.integrator
    return (
        Quantity(scheme, "largest λ⁺ of a corner", plus.max(), "N"),
        Quantity(scheme, "largest λ⁻ of a corner", minus.max(), "N"),
        Quantity(scheme, "largest Λ of a corner", impulse.max(), "N s"),
        Quantity(scheme, "steps with forces", int(pressed.sum()), "1"),
        Quantity(scheme, "steps with impulses", int(hit.sum()), "1"),
        Quantity(scheme, "steps with both", int((pressed & hit).sum()), "1"),
    )
