"""The rotor with half-explicit schemes and with Moreau-Jean: steps, accuracy of the orbit, cost, pictures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from time import process_time
from typing import TYPE_CHECKING

import matplotlib.pyplot as plt
import numpy as np
import saltus.kernel as sk
from saltus import plot
from saltus.examples.figure import panels, sheet
from saltus.examples.rotor.animation import animate
from saltus.examples.rotor.rotor import CONTACT, END, STABILISED, TIME_STEP, Parameters, build
from saltus.io import Trajectory

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from saltus.typing import FloatArray

SUBSTEPS = "HalfExplicitTrapezoidalOSI(impulsive_substeps=10"
START = f"{SUBSTEPS})"  #: closed at the start of the step
PREDICTED = f"{SUBSTEPS},activity=predicted)"  #: (75)-(77)
MOREAU = "MoreauJeanOSI"
SHORT = {
    START: "half-explicit",
    PREDICTED: "half-explicit, predicted",
    STABILISED: "half-explicit, stabilised",
    MOREAU: "Moreau-Jean",
}
REFERENCE_STEP = 5e-7  #: of the stabilised scheme [s]
SAMPLE = 4e-5  #: orbits are compared at its multiples, which every step divides [s]
STEPS = {START: (1e-5, TIME_STEP, 2.5e-6, 1.25e-6), MOREAU: (2e-5, 1e-5, TIME_STEP, 2.5e-6, 1.25e-6)}
PAPER = {"impulsive": 1.3, "ratio": 0.32}  #: [%], [1]
P = Parameters()
FRUSTUM, BEARING = P.freedoms + 7, P.freedoms + 14  # where their coordinates begin


@dataclass(frozen=True)
class Run:
    """One run until END and what it took."""

    scheme: str
    time_step: float  #: [s]
    trajectory: Trajectory
    seconds: float  #: of the processor, which other programs do not lengthen much

    @cached_property
    def orbit(self) -> FloatArray:
        """Disc's centre in the plane of the bearing's ring, at the multiples of SAMPLE (rows, 2) [m]."""
        sampled = self.trajectory.step % round(SAMPLE / self.time_step) == 0
        found: FloatArray = orbit(self.trajectory)[sampled]
        return found

    @property
    def impulsive(self) -> float:
        """Share of the steps that are impulsive [%]."""
        return 100 * float(self.trajectory.impulsive[1:].mean())

    @property
    def energy_defect(self) -> float:
        """What the balance T − T_0 = work of h, λ and Λ lacks, at most, over T at the end [1]."""
        r = self.trajectory
        work = np.cumsum(r.work_forces + r.work_lambda + r.work_impulse)
        kinetic = r.kinetic_energy
        return float(np.abs(kinetic - kinetic[0] - work).max() / kinetic[-1])

    @property
    def opening(self) -> tuple[float, float]:
        """Of the welds: largest distance [m] and angle [rad]."""
        welds = [self.trajectory[f"{name} weld"].gap for name in ("flywheel", "frustum")]
        gaps = np.abs(np.concatenate(welds))
        return float(gaps[:, :3].max()), float(gaps[:, 3:].max())

    def error(self, reference: Run) -> float:
        """Root mean square of the distance of the orbits [m]."""
        apart = np.linalg.norm(self.orbit - reference.orbit, axis=1)
        return float(np.sqrt(np.mean(apart**2)))


def orbit(trajectory: Trajectory) -> FloatArray:
    """Disc's centre across the bearing's axis, along the bearing's second and third axis (rows, 2) [m]."""

    def axes(first: int) -> FloatArray:
        turns = [sk.rotation_matrix(p) for p in trajectory.q[:, first + 3 : first + 7]]
        return np.array(turns).reshape(-1, 3, 3)

    along = 0.5 * P.frustum_half_length
    of_frustum, of_bearing = axes(FRUSTUM), axes(BEARING)
    centre = trajectory.q[:, FRUSTUM : FRUSTUM + 3] + along * of_frustum[:, :, 0]
    apart = centre - trajectory.q[:, BEARING : BEARING + 3]
    found: FloatArray = np.einsum("tij,ti->tj", of_bearing, apart)[:, 1:]
    return found


def run(scheme: str, time_step: float, *, record_every: int = 1) -> Run:
    """Run until END."""
    simulation = sk.TimeStepping(build(), scheme, time_step, record_every=record_every)
    start = process_time()
    trajectory = simulation.run(END)
    return Run(scheme, time_step, trajectory, process_time() - start)


def reference() -> Run:
    """The run that stands for the truth."""
    return run(STABILISED, REFERENCE_STEP, record_every=round(SAMPLE / REFERENCE_STEP))


def solver_iterations(scheme: str, time_step: float = TIME_STEP) -> int:
    """Of all contact problems of a run. A run of its own: who counts is not timed."""
    counts: list[int] = []
    simulation = sk.TimeStepping(build(), scheme, time_step, record_every=10**9)
    simulation.add_callback(lambda step, t, q, v, report: counts.append(report.solver_iterations))
    simulation.run(END)
    return sum(counts)


def cost_at(error: float, runs: Sequence[Run], truth: Run) -> float:
    """Seconds for an error of the orbit: by the line through log(seconds) over log(error)."""
    errors, seconds = np.log([(r.error(truth), r.seconds) for r in runs]).T
    slope, offset = np.polyfit(errors, seconds, 1)
    return float(np.exp(offset + slope * np.log(error)))


def show(folder: Path | None) -> None:
    """Print the table; draw orbit, contact force and the moving axle into the folder if there is one."""
    truth = reference()
    runs = {scheme: run(scheme, TIME_STEP) for scheme in SHORT}
    print_table(runs, truth)
    series = {
        scheme: [runs[scheme] if dt == TIME_STEP else run(scheme, dt) for dt in steps]
        for scheme, steps in STEPS.items()
    }
    print_costs(series, truth)
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
        for name, picture in (("orbit", draw_orbit(runs)), ("force", draw_forces(runs))):
            picture.savefig(folder / f"rotor-{name}.png", dpi=150)
            plt.close(picture)
            print(folder / f"rotor-{name}.png")
        half = runs[START].trajectory
        print(animate(half, orbit(half), folder / "rotor.gif"))


def print_table(runs: Mapping[str, Run], truth: Run) -> None:
    """All schemes at the paper's step."""
    steps = round(END / TIME_STEP)
    print(f"rotor until {END} s, {steps} steps of {TIME_STEP:g} s")
    print(f"orbits against {SHORT[STABILISED]}, Δt = {REFERENCE_STEP:g} s")
    print(
        f"{'':26}{'impulsive':>10}{'solver':>11}{'time':>8}{'orbit':>10}{'energy':>10}"
        f"{'welds':>10}{'welds':>10}{'penetr.':>10}"
    )
    print(
        f"{'':26}{'% of steps':>10}{'iterations':>11}{'s':>8}{'error m':>10}{'defect':>10}"
        f"{'m':>10}{'rad':>10}{'m':>10}"
    )
    for scheme, r in runs.items():
        distance, angle = r.opening
        print(
            f"{SHORT[scheme]:26}{r.impulsive:10.2f}{solver_iterations(scheme):11d}{r.seconds:8.2f}"
            f"{r.error(truth):10.1e}{r.energy_defect:10.1e}{distance:10.1e}{angle:10.1e}"
            f"{r.trajectory.penetration.max():10.1e}"
        )
    ratio = runs[START].seconds / runs[MOREAU].seconds
    print(f"impulsive steps, paper: {PAPER['impulsive']} %")
    print(f"time, half-explicit over Moreau-Jean: {ratio:.2f} (paper: {PAPER['ratio']})")


def print_costs(series: Mapping[str, Sequence[Run]], truth: Run) -> None:
    """Error and cost over Δt, and the cost of the same error."""
    for scheme, runs in series.items():
        figures = ", ".join(f"{r.time_step:g} s: {r.error(truth):.1e} m in {r.seconds:.2f} s" for r in runs)
        print(f"{SHORT[scheme]}: {figures}")
    error = next(r.error(truth) for r in series[START] if r.time_step == TIME_STEP)
    cost = {scheme: cost_at(error, runs, truth) for scheme, runs in series.items()}
    ratio = cost[START] / cost[MOREAU]
    print(f"time for an error of {error:.1e} m, half-explicit over Moreau-Jean: {ratio:.2f}")


def draw_orbit(runs: Mapping[str, Run]) -> Figure:
    """Way of the disc's centre in the ring, for two schemes; impacts are marked."""
    with plt.rc_context(plot.STYLE):
        picture, axes = plt.subplots(1, 2, figsize=(9, 5), layout="constrained", sharex=True, sharey=True)
        picture.suptitle(f"Rotor: frustum in the bearing until {END} s, Δt = {TIME_STEP:g} s")
        for ax, scheme in zip(axes, (START, MOREAU), strict=True):
            draw_way(ax, runs[scheme].trajectory)
            ax.set_title(SHORT[scheme], loc="left")
        axes[0].set_ylabel("vertical [µm]")
    return picture


def draw_way(ax: Axes, trajectory: Trajectory) -> None:
    """One orbit, darker as time goes on."""
    way, angle = 1e6 * orbit(trajectory), np.linspace(0, 2 * np.pi, 200)
    ax.plot(
        1e6 * P.clearance * np.cos(angle), 1e6 * P.clearance * np.sin(angle), color="black", linewidth=0.8
    )
    points = ax.scatter(way[:, 0], way[:, 1], c=1e3 * trajectory.t, s=1.5, cmap="viridis_r")
    if trajectory.impulsive.mean() < 0.5:
        hits = way[trajectory.impulsive]
        ax.plot(*hits.T, "o", color="C3", markersize=4, fillstyle="none", label="impact")
        ax.legend(loc="upper right")
    ax.figure.colorbar(points, ax=ax, location="bottom", label="time [ms]", shrink=0.8)
    ax.set_aspect("equal")
    ax.set_xlabel("horizontal [µm]")


def draw_run(trajectory: Trajectory) -> Figure:
    """One run alone: orbit, gap, contact force and impulses."""
    with sheet(1, 2, (10, 5)) as (picture, (ring, beside)):
        draw_way(ring, trajectory)
        beside.remove()
        column = picture.add_gridspec(3, 2)
        axes = [picture.add_subplot(column[k, 1]) for k in range(3)]
        draw_contact(axes, trajectory)
        axes[2].set_xlim(axes[0].get_xlim())
        axes[2].set_xlabel("time t [ms]")
    return picture


def draw_contact(axes: Sequence[Axes], trajectory: Trajectory) -> None:
    """Gap, contact force and impulses over the time."""
    contact, t = trajectory[CONTACT], 1e3 * trajectory.t
    axes[0].plot(t, 1e6 * contact.gap[:, 0], linewidth=0.8)
    axes[0].set_ylabel("$g$ [µm]")
    axes[1].plot(t, contact.force[:, 0], linewidth=0.8)
    axes[1].set_ylabel(r"$\lambda_N$ [N]")
    hits = trajectory.impulsive
    axes[2].vlines(t[hits], 0, 1e3 * contact.impulse[hits, 0], color="C3")
    axes[2].set_ylabel(r"$\Lambda_N$ [mN s]")


def draw_forces(runs: Mapping[str, Run]) -> Figure:
    """Gap, contact force and impulses of the half-explicit scheme, and impulses of Moreau-Jean over Δt."""
    titles = [
        "Gap of the frustum in the bearing",
        f"Contact force, {SHORT[START]}: mean of λ⁺ and λ⁻",
        f"Impulses Λ, {SHORT[START]}",
        "Moreau-Jean: impulse of a step over Δt",
    ]
    with panels(titles, f"Rotor: contact in the journal bearing, Δt = {TIME_STEP:g} s", 1.7) as (
        picture,
        axes,
    ):
        half, moreau = runs[START].trajectory, runs[MOREAU].trajectory
        draw_contact(axes, half)
        axes[3].plot(1e3 * moreau.t, moreau[CONTACT].impulse[:, 0] / TIME_STEP, color="C1", linewidth=0.8)
        axes[3].set_ylabel(r"$P_N/\Delta t$ [N]")
        axes[3].set_ylim(0, 1.2 * half[CONTACT].force[:, 0].max())
        axes[3].set_xlabel("time t [ms]")
    return picture
