"""Panels of energy: what there is, what work went into it, and what the sum of both leaves over."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from saltus.panels.contacts import mark_impacts
from saltus.panels.drawing import curve, legend_strip

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from saltus.io import Trajectory
    from saltus.typing import FloatArray


def energy(ax: Axes, trajectory: Trajectory) -> None:
    """Total energy, or the kinetic one where a system does not know its potential."""
    known = potential_is_known(trajectory)
    curve(ax, trajectory.t, trajectory.energy if known else trajectory.kinetic_energy, color="black")
    mark_impacts(ax, trajectory)
    ax.set_ylabel("total energy [J]" if known else "kinetic energy [J]")


def energies(ax: Axes, trajectory: Trajectory) -> None:
    """Kinetic, potential and total energy; the kinetic one alone where a potential is not known."""
    curve(ax, trajectory.t, trajectory.kinetic_energy, color="C0", label="kinetic T")
    if potential_is_known(trajectory):
        curve(ax, trajectory.t, trajectory.potential_energy, color="C1", label="potential V")
        curve(ax, trajectory.t, trajectory.energy, color="black", label="total T + V")
    mark_impacts(ax, trajectory)
    ax.set_ylabel("energy [J]")
    legend_strip(ax)


def work(ax: Axes, trajectory: Trajectory) -> None:
    """Work since the start, cumulative: of forces h, of λ, of Λ, and the kinetic energy that it makes.

    Between recorded rows that are not of consecutive steps h and λ are not told apart: what they do together
    is what the kinetic energy gains without Λ.
    """
    t, gained = trajectory.t, trajectory.kinetic_energy - trajectory.kinetic_energy[:1]
    shock = np.cumsum(trajectory.work_impulse)
    if every_step(trajectory):
        curve(ax, t, np.cumsum(trajectory.work_forces), color="C2", label="forces h")
        curve(ax, t, np.cumsum(trajectory.work_lambda), color="C4", label="contacts λ")
    else:
        curve(ax, t, gained - shock, color="C2", label="forces h and λ")
    curve(ax, t, shock, color="C3", label="impulses Λ")
    curve(ax, t, gained, linestyle="--", color="C0", label="T − T(0)")
    mark_impacts(ax, trajectory)
    ax.set_ylabel("work since the start [J]")
    legend_strip(ax)


def defect(ax: Axes, trajectory: Trajectory) -> None:
    """What the balance leaves over: T − T(0) less all work, the error of the scheme's quadratures."""
    if every_step(trajectory):
        curve(ax, trajectory.t, balance_defect(trajectory), color="black")
        mark_impacts(ax, trajectory)
    else:
        ax.text(0.5, 0.5, "not every step is recorded", transform=ax.transAxes, ha="center", color="0.4")
    ax.set_ylabel("defect of the balance [J]")


def balance_defect(trajectory: Trajectory) -> FloatArray:
    """T − T(0) − Σ (work of h, λ and Λ), of a run with every step (rows,) [J]."""
    done = trajectory.work_forces + trajectory.work_lambda + trajectory.work_impulse
    left: FloatArray = trajectory.kinetic_energy - trajectory.kinetic_energy[:1] - np.cumsum(done)
    return left


def every_step(trajectory: Trajectory) -> bool:
    """True if every step of the run is recorded."""
    return bool((np.diff(trajectory.step) == 1).all())


def potential_is_known(trajectory: Trajectory) -> bool:
    """True if all systems define their potential energy."""
    return bool(np.isfinite(trajectory.potential_energy).all())
