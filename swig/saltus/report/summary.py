"""What a page says of a run in words and numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from saltus.io import FirstOrderTrajectory, Trajectory

Lines = list[list[str]]


def summary_of(trajectory: Trajectory) -> dict[str, Lines]:
    """Pairs of what and how much, under headings."""
    return {
        "run": _run(trajectory),
        "certificate": _certificate(trajectory),
        "provenance": _provenance(trajectory),
    }


def first_order_summary(run: FirstOrderTrajectory) -> dict[str, Lines]:
    """The same of a first-order run."""
    t, worst = run.t, int(np.argmax(run.residual))
    return {
        "run": [*_span(run), ["states", str(run.x.shape[1])], ["outputs", str(run.y.shape[1])]],
        "certificate": [["largest residual, relative", f"{run.residual[worst]:.1e} at {t[worst]:.6g} s"]],
        "provenance": _provenance(run),
    }


def _span(run: Trajectory | FirstOrderTrajectory) -> Lines:
    return [
        ["time", f"{run.t[0]:.12g} s to {run.t[-1]:.12g} s"],
        ["steps", f"{int(run.step[-1])} of {run.provenance.time_step:g} s"],
    ]


def _run(trajectory: Trajectory) -> Lines:
    lines = [
        *_span(trajectory),
        ["steps with an impact", str(int(trajectory.impacts.sum()))],
        ["contacts", str(len(trajectory.contacts))],
    ]
    if len(trajectory) - 1 != int(trajectory.step[-1]):
        lines.append(["recorded rows", str(len(trajectory))])
    return lines


def _certificate(trajectory: Trajectory) -> Lines:
    """How far the run can be trusted."""
    t, residual, depth = trajectory.t, trajectory.residual, trajectory.penetration
    worst, deepest = int(np.argmax(residual)), int(np.argmax(depth))
    lines = [
        ["largest residual of a contact problem", f"{residual[worst]:.1e} m/s at {t[worst]:.6g} s"],
        ["largest penetration", f"{depth[deepest]:.2e} m at {t[deepest]:.6g} s"],
    ]
    energy = trajectory.energy
    if np.isfinite(energy).all():
        work = trajectory.work_forces + trajectory.work_lambda + trajectory.work_impulse
        defect = trajectory.kinetic_energy - trajectory.kinetic_energy[0] - np.cumsum(work)
        lines += [
            ["energy at the start and at the end", f"{energy[0]:.6g} J, {energy[-1]:.6g} J"],
            ["work of the impulses", f"{trajectory.work_impulse.sum():.4g} J"],
            ["work of the contact forces", f"{trajectory.work_lambda.sum():.4g} J"],
        ]
        if trajectory.provenance.record_every == 1:
            lines.append(["largest defect of the energy balance", f"{np.abs(defect).max():.1e} J"])
    return lines


def _provenance(trajectory: Trajectory | FirstOrderTrajectory) -> Lines:
    p = trajectory.provenance
    options = ", ".join(f"{name}={_short(value)}" for name, value in p.options.items())
    lines = [
        ["integrator", f"{p.integrator}({options})"],
        ["time step Δt", f"{p.time_step:g} s"],
        ["contact solver", p.solver],
        ["Saltus", p.version],
        ["computed", p.created],
    ]
    return lines + [[f"parameter {name}", _short(value)] for name, value in p.parameters.items()]


def _short(value: Any) -> str:
    text = f"{value:g}" if isinstance(value, float) else str(value)
    return text if len(text) <= 120 else text[:117] + "..."
