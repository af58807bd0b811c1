"""Panels of contacts: gaps, velocities, forces, impulses, and a band of their states.

Each draws the contacts of these names, or, if there are many and none are named, those that pressed most.
Tangential quantities are signed in the plane, and lengths in space.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
from matplotlib.patches import Patch

from saltus.io.contact_states import ContactState
from saltus.panels.drawing import (
    LEGEND,
    MOST_LINES,
    PIECES,
    curve,
    extremes,
    fitting_columns,
    legend_strip,
    mark_times,
)

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from matplotlib.axes import Axes

    from saltus.io import ContactRecord, Trajectory
    from saltus.typing import FloatArray, StateArray

MOST_CONES = 4  #: more contacts than that are drawn without their friction cones
MOST_NAMES = 40  #: more contacts than that have no names beside the band
COLORS = {
    ContactState.OPEN: "#eeeeee",
    ContactState.CLOSED: "#999999",
    ContactState.STICK: "#0072b2",
    ContactState.SLIP: "#e69f00",
    ContactState.IMPACT: "#c2185b",
    ContactState.HELD: "#b9a7d6",
}


def chosen(trajectory: Trajectory, contacts: Sequence[str] | None) -> list[str]:
    """Names of the contacts to draw: those asked for, else the 12 that pressed most, in their order.

    Raises
    ------
    KeyError
        If there is none of a name.
    """
    if contacts is not None:
        names = [contacts] if isinstance(contacts, str) else list(contacts)
        for name in names:
            trajectory[name]
        return names
    return trajectory.busiest_contacts(MOST_LINES)


def mark_impacts(ax: Axes, trajectory: Trajectory) -> None:
    """Grey lines at the impacts."""
    mark_times(ax, trajectory.t[trajectory.impacts])


def gaps(
    ax: Axes, trajectory: Trajectory, contacts: Sequence[str] | None = None, *, legend: bool = True
) -> None:
    """Gap g of every contact, in a unit that suits the largest."""
    names = chosen(trajectory, contacts)
    largest = max((np.abs(trajectory[name].gap).max(initial=0.0) for name in names), default=0.0)
    unit, scale = _length(largest)
    for contact, style in _styled(trajectory, names):
        _normal(ax, trajectory.t, contact, scale * contact.gap, style)
    ax.axhline(0.0, color="black", linewidth=0.6)
    ax.set_ylabel(f"gap g [{unit}]")
    _finish(ax, trajectory, names, legend)


def velocities(
    ax: Axes, trajectory: Trajectory, contacts: Sequence[str] | None = None, *, legend: bool = True
) -> None:
    """Normal velocity γ_N of every contact."""
    names = chosen(trajectory, contacts)
    for contact, style in _styled(trajectory, names):
        _normal(ax, trajectory.t, contact, contact.velocity, style)
    mark_impacts(ax, trajectory)
    ax.set_ylabel("velocity γ_N [m/s]")
    _finish(ax, trajectory, names, legend)


def forces(
    ax: Axes, trajectory: Trajectory, contacts: Sequence[str] | None = None, *, legend: bool = True
) -> None:
    """Normal force of every contact, the mean over the step, under Moreau-Jean Λ/Δt but for impacts."""
    names = chosen(trajectory, contacts)
    carries = False
    for contact, style in _styled(trajectory, names):
        force = trajectory.reactions(contact.name)[0]
        carries |= bool(force.any())
        _normal(ax, trajectory.t, contact, force, style)
    mark_impacts(ax, trajectory)
    ax.set_ylabel(f"force {_force(trajectory, carries, 'N')} [N]")
    _finish(ax, trajectory, names, legend)


def impulses(
    ax: Axes, trajectory: Trajectory, contacts: Sequence[str] | None = None, *, legend: bool = True
) -> None:
    """Normal impulse Λ of every contact where there is one, of an equality with more rows their length.

    Under Moreau-Jean those at impacts.
    """
    names = chosen(trajectory, contacts)
    for contact, style in _styled(trajectory, names):
        impulse = trajectory.reactions(contact.name)[1][:, : contact.gap.shape[1]]
        _stems(ax, trajectory.t, impulse[:, 0] if impulse.shape[1] == 1 else _length_of(impulse), style)
    ax.set_ylabel("impulse Λ_N [N s]")
    _finish(ax, trajectory, names, legend)


def sliding(ax: Axes, trajectory: Trajectory, contacts: Sequence[str] | None = None) -> None:
    """Tangential velocity γ_T of every contact with friction."""
    names = chosen(trajectory, contacts)
    for contact, style in _with_tangents(trajectory, names):
        curve(ax, trajectory.t, _tangential(contact, contact.velocity), **style)
    mark_impacts(ax, trajectory)
    ax.set_ylabel(_tangent_label(trajectory, names, "velocity", "γ_T", "m/s"))


def friction(ax: Axes, trajectory: Trajectory, contacts: Sequence[str] | None = None) -> None:
    """Tangential force of every contact with friction, and the cone |λ_T| ≤ μ λ_N of a few."""
    names, t = chosen(trajectory, contacts), trajectory.t
    carries = False
    drawn = list(_with_tangents(trajectory, names))
    for contact, style in drawn:
        force = trajectory.reactions(contact.name)[0]
        carries |= bool(force.any())
        curve(ax, t, _tangential(contact, force), **style)
        if len(drawn) <= MOST_CONES:
            limit = (contact.law.friction or 0.0) * force[:, 0]
            rows = extremes(limit)
            lower = 0.0 if _in_space(contact) else -limit[rows]
            ax.fill_between(t[rows], lower, limit[rows], color=style["color"], alpha=0.15, linewidth=0)
    mark_impacts(ax, trajectory)
    ax.set_ylabel(_tangent_label(trajectory, names, "friction", _force(trajectory, carries, "T"), "N"))


def friction_impulses(ax: Axes, trajectory: Trajectory, contacts: Sequence[str] | None = None) -> None:
    """Tangential impulse of every contact with friction, where there is one."""
    names = chosen(trajectory, contacts)
    for contact, style in _with_tangents(trajectory, names):
        _stems(ax, trajectory.t, _tangential(contact, trajectory.reactions(contact.name)[1]), style)
    ax.set_ylabel(_tangent_label(trajectory, names, "impulse", "Λ_T", "N s"))


def states(ax: Axes, trajectory: Trajectory, contacts: Sequence[str] | None = None) -> None:
    """A band for each contact, coloured by its state over time."""
    names = chosen(trajectory, contacts)
    for index, name in enumerate(names):
        _band(ax, trajectory.t, trajectory[name].states, index)
    _count(ax, trajectory, names, "left")
    ax.grid(False)
    spare = max(0.0, 1.5 - len(names) / 2)  # above and below one or two bands
    ax.set_ylim(len(names) - 0.4 + spare, -0.6 - spare)
    if len(names) <= MOST_NAMES:
        ax.set_yticks(range(len(names)), [label(name) for name in names])
        for index, text in enumerate(ax.get_yticklabels()):
            text.set_color(f"C{index % 10}")
    else:
        ax.set_yticks([])
    seen = {code for name in names for code in np.unique(trajectory[name].states).tolist()}
    _legend_of_states(ax, [state for state in ContactState if state in seen])


def _band(ax: Axes, t: FloatArray, states: StateArray, index: int) -> None:
    hits = t[states == ContactState.IMPACT]
    low, high = index - 0.4, index + 0.4
    ax.vlines(hits[extremes(hits)], low, high, color=COLORS[ContactState.IMPACT], linewidth=0.8)
    start, end, state = _phases(t, states)
    for code in np.unique(state):
        spans = np.column_stack([start, end - start])[state == code]
        color = COLORS[ContactState(int(code))]
        ax.broken_barh(spans, (low, high - low), color=color, linewidth=0, zorder=1.5)


def _legend_of_states(ax: Axes, states: Sequence[ContactState]) -> None:
    names = [state.name.lower() for state in states]
    ax.legend(
        handles=[Patch(color=COLORS[state], label=name) for state, name in zip(states, names, strict=True)],
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        ncols=fitting_columns(ax, names, len(ContactState)),
        borderaxespad=0.2,
        **LEGEND,
    )


def _phases(t: FloatArray, states: StateArray) -> tuple[FloatArray, FloatArray, StateArray]:
    """Start, end and state of the intervals between which the state changes; row k ends the k-th step."""
    if len(states) > 4 * PIECES:
        width = -(-len(states) // PIECES)
        pieces = np.arange(0, len(states), width)
        counts = [np.add.reduceat(states == kind, pieces, dtype=np.int64) for kind in ContactState]
        states = np.argmax(counts, axis=0).astype(np.int8)  # of most of a piece's rows
        t = t[np.append(pieces, len(t) - 1)]
    else:
        states = states[1:]
    changes = np.flatnonzero(np.diff(states)) + 1
    first = np.concatenate([[0], changes]).astype(np.int64)[: len(states)]
    last = np.append(changes, len(states))[: len(states)]
    return t[first], t[last], states[first]


def label(name: str) -> str:
    """A name as matplotlib shows it as it is: no formulas, and none that legends leave out."""
    shown = name.replace("$", r"\$")
    return f" {shown}" if shown.startswith("_") else shown


def _styled(trajectory: Trajectory, names: Sequence[str]) -> Iterator[tuple[ContactRecord, dict[str, str]]]:
    """The contacts with a colour and a name each; every other line is dashed and leaves one below visible."""
    for index, name in enumerate(names):
        dashes = ("-", "--", ":", "-.")[index % 2 + 2 * (index // 10 % 2)]
        yield trajectory[name], {"color": f"C{index % 10}", "linestyle": dashes, "label": label(name)}


def _with_tangents(
    trajectory: Trajectory, names: Sequence[str]
) -> Iterator[tuple[ContactRecord, dict[str, str]]]:
    """Those with tangential rows, styled as among all."""
    return ((contact, style) for contact, style in _styled(trajectory, names) if has_tangents(contact))


def has_tangents(contact: ContactRecord) -> bool:
    """True if it has rows besides those with a gap."""
    return bool(contact.velocity.shape[1] > contact.gap.shape[1])


def _normal(
    ax: Axes, t: FloatArray, contact: ContactRecord, values: FloatArray, style: dict[str, str]
) -> None:
    """Its first rows, under one name."""
    for k in range(contact.gap.shape[1]):
        curve(ax, t, values[:, k], **(style if k == 0 else {**style, "label": "_"}))


def _tangential(contact: ContactRecord, values: FloatArray) -> FloatArray:
    """The row behind the normal one, or the length of two of them."""
    rows = values[:, contact.gap.shape[1] :]
    return _length_of(rows) if _in_space(contact) else rows[:, 0]


def _in_space(contact: ContactRecord) -> bool:
    return bool(contact.velocity.shape[1] - contact.gap.shape[1] > 1)


def _length_of(rows: FloatArray) -> FloatArray:
    length: FloatArray = np.sqrt(np.square(rows).sum(axis=1))
    return length


def _stems(ax: Axes, t: FloatArray, values: FloatArray, style: dict[str, str]) -> None:
    rows = np.flatnonzero(values)
    rows = rows[extremes(values[rows])]
    ax.vlines(t[rows], 0.0, values[rows], color=style["color"], linewidth=1.0)
    ax.plot(t[rows], values[rows], "o", markersize=3.5, color=style["color"], label=style["label"])


def _length(largest: float) -> tuple[str, float]:
    """Unit in which it is of handy size, and how many of it make a metre."""
    if largest == 0.0 or largest >= 0.1:
        return "m", 1.0
    return ("mm", 1e3) if largest >= 1e-4 else ("µm", 1e6)


def _force(trajectory: Trajectory, carries: bool, direction: str) -> str:
    """Symbol of what is drawn: a run in which nothing carries does not know whether its scheme has λ."""
    return f"Λ_{direction}/Δt" if carries and not trajectory.told_apart else f"λ_{direction}"


def _tangent_label(
    trajectory: Trajectory, names: Sequence[str], quantity: str, symbol: str, unit: str
) -> str:
    space = any(_in_space(trajectory[name]) for name in names)
    return f"{quantity} |{symbol}| [{unit}]" if space else f"{quantity} {symbol} [{unit}]"


def _finish(ax: Axes, trajectory: Trajectory, names: Sequence[str], legend: bool) -> None:
    """A legend, and of how many contacts these are."""
    if not legend:
        return
    if 0 < len(names) <= MOST_LINES:
        legend_strip(ax)
    _count(ax, trajectory, names, "right")


def _count(ax: Axes, trajectory: Trajectory, names: Sequence[str], side: Literal["left", "right"]) -> None:
    if len(names) < len(trajectory.contacts):
        text = f"{len(names)} of {len(trajectory.contacts)} contacts"
        ax.set_title(text, loc=side, fontsize="small", color="0.4")
