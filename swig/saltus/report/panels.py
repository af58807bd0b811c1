"""The plots of a page: which columns of a run, under which titles."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from saltus.io import FirstOrderTrajectory, Trajectory
    from saltus.typing import FloatArray

MOST_COORDINATES = 12  #: more are not plotted
MOST_CONTACTS = 24
ROWS = ("N", "T", "T2")  #: of a contact with friction


@dataclass(frozen=True)
class Line:
    """A line of a plot; those of a contact are shown and hidden with it."""

    label: str
    contact: str | None = None
    row: int = 0  #: of the contact


@dataclass(frozen=True)
class Panel:
    """A plot. Its kind is "lines", "stems" for what is zero but at instants, or "log"."""

    title: str
    unit: str
    kind: str
    lines: Sequence[Line]
    values: FloatArray  #: (rows of the run, lines)
    note: str = ""


def panels_of(trajectory: Trajectory, contacts: Sequence[str]) -> list[Panel]:
    """All plots of a run with these contacts."""
    panels = []
    if trajectory.q.shape[1] <= MOST_COORDINATES:
        names = [Line(f"q{k}") for k in range(trajectory.q.shape[1])]
        panels.append(Panel("Positions q", "m or rad", "lines", names, trajectory.q))
    panels += _contact_panels(trajectory, contacts[:MOST_CONTACTS])
    panels.append(_energy(trajectory))
    residual = Panel(
        "Residual of the contact problems",
        "m/s",
        "log",
        [Line("largest of the step")],
        trajectory.residual[:, None],
    )
    return [*panels, residual, _step_size(trajectory)]


def first_order_panels(run: FirstOrderTrajectory) -> list[Panel]:
    """All plots of a first-order run."""
    entries = [Line(f"{name}[{k}]") for name, size in run.layout.interactions for k in range(size)]
    states = [Line(f"x{k}") for k in range(run.x.shape[1])]
    panels = [Panel("States x", "1", "lines", states, run.x)]
    if entries:
        panels.append(Panel("Outputs y", "1", "lines", entries, run.y))
        panels.append(Panel("Multipliers λ", "1", "lines", entries, run.lambda_))
    residual = [Line("largest of the step")]
    return [*panels, Panel("Residual, relative", "1", "log", residual, run.residual[:, None])]


def _contact_panels(trajectory: Trajectory, contacts: Sequence[str]) -> list[Panel]:
    mean = "Mean over the step."
    # a run in which nothing carries does not know whether its scheme has λ
    if not trajectory.told_apart and any(trajectory.reactions(name)[0].any() for name in contacts):
        mean = "The scheme has impulses alone: Λ/Δt where there is no impact."
    read: list[tuple[str, str, str, Callable[[str], FloatArray], str]] = [
        ("Gaps g", "m", "lines", lambda name: trajectory[name].gap, "Closed where g ≤ 0."),
        (
            "Relative velocities γ",
            "m/s",
            "lines",
            lambda name: trajectory[name].velocity,
            "N: normal, positive where it opens; T: tangential.",
        ),
        ("Contact forces λ", "N", "lines", lambda name: trajectory.reactions(name)[0], mean),
        ("Impulses Λ", "N s", "stems", lambda name: trajectory.reactions(name)[1], "At impacts."),
    ]
    panels = []
    for title, unit, kind, values_of, note in read:
        records = [(name, values_of(name)) for name in contacts]
        lines = [
            Line(_label(name, k, values.shape[1]), name, k)
            for name, values in records
            for k in range(values.shape[1])
        ]
        if lines:
            values = np.hstack([values for _, values in records])
            panels.append(Panel(title, unit, kind, lines, values, note))
    return panels


def _label(name: str, row: int, rows: int) -> str:
    if rows == 1:
        return name
    return f"{name} {ROWS[row]}" if rows <= len(ROWS) else f"{name} [{row}]"


def _energy(trajectory: Trajectory) -> Panel:
    kinetic, potential = trajectory.kinetic_energy, trajectory.potential_energy
    if not np.isfinite(potential).all():
        note = "Not every system tells its potential energy."
        return Panel("Kinetic energy", "J", "lines", [Line("kinetic")], kinetic[:, None], note)
    lines = [Line("total"), Line("kinetic"), Line("potential")]
    return Panel("Energy", "J", "lines", lines, np.column_stack([kinetic + potential, kinetic, potential]))


def _step_size(trajectory: Trajectory) -> Panel:
    """Δt, or the mean of the steps that a scheme took itself within it."""
    sizes = trajectory.provenance.time_step / np.maximum(trajectory.accepted_steps, 1)
    note = (
        "Mean of the steps that the scheme chose within Δt." if (trajectory.accepted_steps > 0).any() else ""
    )
    return Panel("Step size", "s", "log" if note else "lines", [Line("Δt")], sizes[:, None], note)
