"""Figures 10 and 11 of the paper: the ball in a box under oblique gravity, Δt = 5e-3 s, until 2 s."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import saltus.kernel as sk
from saltus import plot
from saltus.examples.ball_in_box.ball_in_box import TIME_STEP, build
from saltus.examples.figure import SHORT, PaperFigure, Quantity, panels

if TYPE_CHECKING:
    from saltus.io import Trajectory

END = 2.0  #: [s]
ACCELERATION, VELOCITY = "DMinusAccelerationOSI", "HalfExplicitTrapezoidalOSI"
SIDES = {"left": "C0", "bottom": "C1", "right": "C2", "top": "C3"}
NEAR = 0.025  #: what is seen of the gaps near the sides [m]
SAME = 1e-12  #: gaps that differ by less coincide [m]
COMMON = "ball in a box, ε = 0.3, Δt = 5e-3 s"


def run(scheme: str) -> Trajectory:
    """The run that these figures look at."""
    return sk.TimeStepping(build("oblique"), scheme, TIME_STEP).run(END)


def figure_10() -> PaperFigure:
    """Energy on velocity level: kept in flight, lost at impacts.

    The only rises are those of a ball that a side stops within a step after an impact at v⁺ < γΔt: it is
    lifted by ½Δt v⁺ against the gravity γ and loses ½mv⁺². They are at most m(γΔt)²/8 = 0.3 mJ.
    """
    trajectory = run(VELOCITY)
    with panels(["Total energy (grey: impacts)"], f"Fig. 10: {COMMON}, {SHORT[VELOCITY]}", 3.2) as (
        picture,
        axes,
    ):
        plot.energy(axes[0], trajectory)
    change = np.diff(trajectory.energy)
    flight = ~trajectory.impulsive[1:] & (trajectory.closed[1:] == 0) & (trajectory.closed[:-1] == 0)
    return PaperFigure(
        "Total energy of the bouncing ball in a box for half-explicit timestepping on velocity level",
        (
            Quantity(VELOCITY, "energy at the start", trajectory.energy[0], "J"),
            Quantity(VELOCITY, "energy at the end", trajectory.energy[-1], "J"),
            Quantity(VELOCITY, "largest change in a step of flight", np.abs(change[flight]).max(), "J"),
            Quantity(VELOCITY, "largest rise in a step", change.max(), "J"),
        ),
        picture,
    )


def figure_11() -> PaperFigure:
    """Gaps on both levels: the same curves, until contact lasts.

    From then on the acceleration level keeps the velocity that the last impact left, below γΔt, and the
    ball sinks; the velocity level stops it.
    """
    runs = {scheme: run(scheme) for scheme in (ACCELERATION, VELOCITY)}
    with panels(["Gaps of the ball", "Near the sides"], f"Fig. 11: {COMMON}") as (picture, (whole, near)):
        for scheme, style in ((VELOCITY, "-"), (ACCELERATION, "--")):
            for side, color in SIDES.items():
                for ax in (whole, near):
                    label = f"{side}, {SHORT[scheme]}"
                    ax.plot(runs[scheme].t, runs[scheme][side].gap, style, color=color, label=label)
        for ax in (whole, near):
            ax.axhline(0.0, color="black", linewidth=0.6)
            ax.set_ylabel("gap $g_N$ [m]")
        near.set_ylim(-NEAR, NEAR)
        whole.legend(loc="center right", ncols=2)
    return PaperFigure(
        "Normal gap functions of the bouncing ball in a box for half-explicit timestepping on acceleration "
        "(dashed) and velocity level (solid)",
        differences(runs[ACCELERATION], runs[VELOCITY]),
        picture,
    )


def differences(acceleration: Trajectory, velocity: Trajectory) -> tuple[Quantity, ...]:
    """How long both coincide, by how much they differ then, and the speeds at rest."""
    sides = [(acceleration[side].gap, velocity[side].gap) for side in SIDES]
    difference = np.max([np.abs(a - v)[:, 0] for a, v in sides], axis=0)
    together = velocity.t[: np.flatnonzero(difference > SAME)[0]]
    both = f"{ACCELERATION}, {VELOCITY}"
    return (
        Quantity(both, "gaps coincide until", together[-1], "s"),
        Quantity(both, "largest difference of the gaps", difference.max(), "m"),
        *(
            Quantity(
                trajectory.provenance.integrator,
                "speed at the end",
                float(np.linalg.norm(trajectory.v[-1])),
                "m/s",
            )
            for trajectory in (acceleration, velocity)
        ),
    )
