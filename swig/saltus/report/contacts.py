"""Contacts on a page: which ones, when they are open, stick, slip or hit, and the arrows in the animation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from saltus.io.contact_states import ContactState

if TYPE_CHECKING:
    from saltus.io import PlaceRecord, Trajectory
    from saltus.typing import FloatArray, IntArray, StateArray

MOST_CONTACTS = 60  #: of the timeline
MOST_CHANGES = 20_000  #: of all contacts, from one state to another
ALWAYS_SHOWN = 12  #: so few are shown in the animation while they are open, too


def rows_of_states(trajectory: Trajectory, contacts: Sequence[str]) -> IntArray:
    """Rows at which the timeline looks: all, or evenly some if there are more changes than it can carry."""
    total = len(trajectory)
    changes = sum(int(np.count_nonzero(np.diff(trajectory[name].states))) for name in contacts)
    if changes <= MOST_CHANGES:
        return np.arange(total)
    return np.unique(np.linspace(0, total - 1, MOST_CHANGES // len(contacts)).round().astype(int))


def intervals_of(trajectory: Trajectory, name: str, rows: IntArray) -> list[list[float]]:
    """[start, end, state] of a contact from the first time to the last [s], an impact with its |Λ| [N s]."""
    record, t = trajectory[name], trajectory.t[rows]
    states = record.states[rows]
    first = np.flatnonzero(np.diff(states, prepend=-1))
    end = np.append(first[1:], len(states)) - 1
    hit = states[first] == ContactState.IMPACT
    # the state of a row is that of the step which ends there
    start = np.where(hit, t[first], t[np.maximum(first - 1, 0)])
    intervals = [[float(a), float(b), int(s)] for a, b, s in zip(start, t[end], states[first], strict=True)]
    for interval, row in zip(intervals, first, strict=True):
        if interval[2] == ContactState.IMPACT:
            interval.append(float(np.linalg.norm(record.impulse[rows[row]])))
    return intervals


@dataclass(frozen=True)
class Arrows:
    """What acts where, of the contacts that are seen in each row: of row k start[k] ... start[k+1]."""

    names: list[str]
    start: IntArray  #: (rows + 1,)
    contact: IntArray  #: (entries,) numbers of `names`
    state: StateArray  #: (entries,) of ContactState
    point: FloatArray  #: (entries, 3) [m]
    force: FloatArray  #: (entries, 3) on the contact's first system [N]
    impulse: FloatArray  #: (entries, 3) [N s]
    largest_force: float
    largest_impulse: float


def arrows_of(trajectory: Trajectory, places: Sequence[PlaceRecord], rows: IntArray) -> Arrows:
    """Of the contacts whose places are known in these rows."""
    states = [trajectory[place.contact].states[rows] for place in places]
    seen = np.array(
        [np.full(len(rows), len(places) <= ALWAYS_SHOWN) | (s != ContactState.OPEN) for s in states]
    )
    seen = seen.reshape(len(places), len(rows)).T
    row, contact = np.nonzero(seen)
    parts = [
        (place.point, *(place.in_space(values[rows]) for values in trajectory.reactions(place.contact)))
        for place in places
    ]
    gathered = [
        np.array([part[k] for part in parts]).reshape(len(places), len(rows), 3)[contact, row]
        for k in range(3)
    ]
    point, force, impulse = gathered
    largest = [float(np.linalg.norm(values, axis=1).max(initial=0.0)) for values in (force, impulse)]
    return Arrows(
        [place.contact for place in places],
        np.concatenate([[0], np.cumsum(seen.sum(axis=1))]),
        contact,
        np.array(states).reshape(len(places), len(rows))[contact, row],
        point,
        force,
        impulse,
        *largest,
    )
