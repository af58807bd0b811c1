"""Figures 13, 14 and 15 of the paper: the elastic bar hits its obstacle, Δt = 1e-7 s, until 1.5 ms."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import saltus.kernel as sk
from saltus import _core, plot
from saltus.examples.elastic_bar.elastic_bar import (
    CONTACT,
    DAMPING,
    END,
    TIME_STEP,
    Parameters,
    build,
)
from saltus.examples.figure import SHORT, PaperFigure, Quantity, panels
from saltus.io import Layout, Trajectory

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from saltus.typing import FloatArray

VELOCITY, MOREAU = "HalfExplicitTrapezoidalOSI", "MoreauJeanOSI"
EXACT = "exact"  #: of the continuous bar, but Λ and the energy that it takes, which are those of N elements
FROM = 4e-4  #: what is drawn begins here [s]
P = Parameters()


class FirstNode:
    """The rows of a run with q and v of the first node alone: 15 000 rows of 2000 numbers fill 240 MB."""

    def __init__(self, simulation: sk.TimeStepping) -> None:
        self._chunks: list[dict[str, Any]] = []
        self._recording = _core.Recording()
        self._recording.stream(self._keep, 500, 60.0)
        simulation.add_observer(self._recording)

    def _keep(self, first: int, columns: dict[str, Any]) -> None:
        slim = {name: columns[name][:, :1] for name in ("q", "v")}
        self._chunks.append({name: np.array(column) for name, column in {**columns, **slim}.items()})

    @property
    def rows(self) -> int:
        """Their number."""
        self._recording.flush()
        return self._recording.handed_on

    def columns(self) -> Mapping[str, Any]:
        """All columns, name: array."""
        self._recording.flush()
        return {name: np.concatenate([chunk[name] for chunk in self._chunks]) for name in self._chunks[0]}


def run(scheme: str, elements: int, damping: float) -> Trajectory:
    """The run that these figures look at, as the first node sees it."""
    system = build(elements, damping)
    simulation = sk.TimeStepping(system, scheme, TIME_STEP, solver="lemke", record_every=10**9)
    rows = FirstNode(simulation)
    whole = simulation.run(END)
    return Trajectory(rows, Layout(whole.layout.contacts, (1,)), whole.provenance)


def figure_13() -> PaperFigure:
    """50 elements: contact as long as that of the continuous bar, λ about τ, and an impulse."""
    return figure("13", "50 elements", 50, 0.0)


def figure_14() -> PaperFigure:
    """1000 elements: a smaller impulse, and ringing of a higher frequency.

    T + V rises a little after the impact: at ωΔt = 1.8 what the scheme keeps is another energy nearby.
    """
    return figure("14", "1000 elements", 1000, 0.0)


def figure_15() -> PaperFigure:
    """1000 elements with a little damping: hardly any ringing is left."""
    return figure("15", "1000 elements, damping δ = 4.762e-9 s", 1000, DAMPING)


def figure(number: str, what: str, elements: int, damping: float) -> PaperFigure:
    """One of the three."""
    runs = {scheme: run(scheme, elements, damping) for scheme in (VELOCITY, MOREAU)}
    titles = [
        "Gap of the first node (grey: impact)",
        "Its velocity",
        f"Contact force, mean of λ⁺ and λ⁻, {SHORT[VELOCITY]} (dashed: continuous bar)",
        "Moreau-Jean, θ = ½: impulse of a step over Δt",
        f"Impulse, {SHORT[VELOCITY]}",
        f"Total energy, {SHORT[VELOCITY]}",
    ]
    heading = f"Fig. {number}: elastic bar, {what}, Δt = 1e-7 s"
    with panels(titles, heading, 1.6) as (picture, axes):
        draw(axes, runs[VELOCITY], runs[MOREAU])
    return PaperFigure(
        f"Elastic bar with {what} under half-explicit timestepping on velocity level",
        (*exact(elements), *felt(runs[VELOCITY]), *felt(runs[MOREAU])),
        picture,
    )


def draw(axes: list[Axes], velocity_level: Trajectory, moreau: Trajectory) -> None:
    """Gap, velocity, forces of both schemes, impulse and energy."""
    gap, velocity, force, beside, impulse, energy = axes
    t, contact = velocity_level.t, velocity_level[CONTACT]
    gap.plot(t, 1e6 * contact.gap[:, 0], color="C0")
    velocity.plot(t, contact.velocity[:, 0], color="C0", linewidth=0.8)
    force.plot(t, contact.force[:, 0], color="C0", linewidth=0.8)
    beside.plot(moreau.t, moreau[CONTACT].impulse[:, 0] / TIME_STEP, color="C1", linewidth=0.8)
    hits = np.flatnonzero(contact.impulse[:, 0])
    impulse.vlines(t[hits], 0.0, 1e3 * contact.impulse[hits, 0], color="C0")
    impulse.plot(t[hits], 1e3 * contact.impulse[hits, 0], "o", markersize=3.5, color="C0")
    for hit in hits:
        value = 1e3 * contact.impulse[hit, 0]
        impulse.annotate(f"{value:.4g} mN s", (t[hit], value), (6, 0), textcoords="offset points")
    energy.plot(t, 1e3 * velocity_level.energy, color="black")
    energy.ticklabel_format(axis="y", useOffset=False)
    for ax in axes:
        plot.mark_impacts(ax, velocity_level)
    draw_exact(axes)
    gap.axhline(0.0, color="black", linewidth=0.6)
    gap.set_ylabel("gap $g_N$ [µm]")
    velocity.set_ylabel("velocity [m/s]")
    for ax in (force, beside):
        ax.set_ylim(-100, 2300)  # the step of Moreau-Jean in which the node stops can be far above
    force.set_ylabel(r"$\lambda_N$ [N]")
    beside.set_ylabel(r"$P_N/\Delta t$ [N]")
    impulse.set_ylim(0.0, 1.6)
    impulse.set_ylabel(r"$\Lambda_N$ [mN s]")
    energy.set_ylabel("energy [mJ]")
    energy.set_xlim(FROM, END)


def draw_exact(axes: list[Axes]) -> None:
    """What the continuous bar does: it arrives, rests, and leaves as fast as it came."""
    _, velocity, force, beside, _, energy = axes
    start = P.gap / P.v0
    t = [0.0, start, start, start + P.contact_time, start + P.contact_time, END]
    dashed: dict[str, Any] = {"linestyle": "--", "color": "black", "linewidth": 0.8}
    velocity.plot(t, np.array([-1, -1, 0, 0, 1, 1]) * P.v0, **dashed)
    for ax in (force, beside):
        ax.plot(t, np.array([0, 0, 1, 1, 0, 0]) * P.contact_force, **dashed)
    energy.axhline(1e3 * P.energy, **dashed)


def exact(elements: int) -> tuple[Quantity, ...]:
    """What is known exactly."""
    return (
        Quantity(EXACT, "contact lasts", P.contact_time, "s"),
        Quantity(EXACT, "contact force", P.contact_force, "N"),
        Quantity(EXACT, "impulse Λ of these elements", P.impulse(elements), "N s"),
        Quantity(EXACT, "energy lost at the impact", 50 * P.v0 * P.impulse(elements) / P.energy, "%"),
    )


def felt(trajectory: Trajectory) -> tuple[Quantity, ...]:
    """What the obstacle feels: times, forces, impulses, energy.

    Moreau-Jean has impulses alone: that of the first step stands for Λ, those of the others over Δt for λ.
    """
    scheme, t, contact = trajectory.provenance.integrator, trajectory.t, trajectory[CONTACT]
    first = int(np.flatnonzero(trajectory.impulsive)[0])
    force = contact_force(trajectory)
    half = (np.arange(len(t)) > first) & (t <= t[first] + P.contact_time / 2)
    last = int(np.flatnonzero(force > 0)[-1])
    during = force[first + 1 : last + 1]
    start = trajectory.energy[0]
    found = [
        Quantity(scheme, "time of the impact", t[first], "s"),
        Quantity(scheme, "contact lasts", t[last] - t[first], "s"),
        Quantity(scheme, "steps without force in between", int((during <= 0).sum()), "1"),
        Quantity(scheme, "mean force, first half", force[half].mean(), "N"),
        Quantity(scheme, "its standard deviation", force[half].std(), "N"),
        Quantity(scheme, "largest force", during.max(), "N"),
        Quantity(scheme, "impulse Λ", contact.impulse[first, 0], "N s"),
        Quantity(scheme, "energy lost at the impact", -100 * trajectory.work_impulse[first] / start, "%"),
        Quantity(scheme, "energy lost in all", 100 * (1 - trajectory.energy[-1] / start), "%"),
        Quantity(scheme, "largest penetration", trajectory.penetration.max(), "m"),
    ]
    if scheme == VELOCITY:
        speed = np.abs(contact.velocity[first:last])  # in step `last` the contact lets go
        found.append(Quantity(scheme, "largest speed in contact", speed.max(), "m/s"))
        found.append(Quantity(scheme, "impacts", int(trajectory.impulsive.sum()), "1"))
    return tuple(found)


def contact_force(trajectory: Trajectory) -> FloatArray:
    """Of every step (rows,) [N], without Λ."""
    contact = trajectory[CONTACT]
    if trajectory.provenance.integrator == VELOCITY:
        return contact.force[:, 0]
    force: FloatArray = contact.impulse[:, 0] / TIME_STEP
    return force
