"""What each contact does in each row of a run, found from its recorded columns alone."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Any

import numpy as np

from saltus.io.records import ContactSlot

if TYPE_CHECKING:
    from saltus.typing import BoolArray, FloatArray, IntArray, StateArray

RESTING_SPEED = 1e-8  #: of the contact's largest: what is slower does not move
LEAST_SPEED = 1e-12  #: [m/s] nor does what is slower than that: a contact may rest in all of a run
ROUNDING = 1e-12  #: of the run's largest force, and of its largest impulse


class ContactState(IntEnum):
    """State of a contact in the step that ends at a row of a run."""

    OPEN = 0  #: neither force nor impulse, and it is not at rest at zero gap
    CLOSED = 1  #: without friction, or the law does not tell sticking from sliding
    STICK = 2  #: closed, and the tangential velocity is zero at the end of the step
    SLIP = 3  #: closed, and it is not
    IMPACT = 4  #: an impulse acted
    HELD = 5  #: an equality


@dataclass(frozen=True)
class Reactions:
    """What the reactions of a run as a whole say about those of a row."""

    least_force: float  #: [N] smaller ones are rounding
    least_impulse: float  #: [N s] likewise
    told_apart: bool  #: are there forces λ besides impulses Λ? Moreau-Jean has none: what acts in a step is Λ

    @staticmethod
    def of(columns: Mapping[str, Any], forces_at_rest: bool | None) -> Reactions:
        """Of these columns of a run, name: (rows, ...); what is not known of its integrator they tell."""
        force, impulse = _largest(columns["force"]), _largest(columns["impulse"])
        told_apart = force > 0.0 or impulse == 0.0 if forces_at_rest is None else forces_at_rest
        return Reactions(ROUNDING * force, ROUNDING * impulse, told_apart)


def contact_states(columns: Mapping[str, Any], slot: ContactSlot, run: Reactions) -> StateArray:
    """States of a contact (rows,) of int8, codes of `ContactState`.

    An impact is a row in which Λ acts. Where λ and Λ are not told apart Λ is also what carries a contact at
    rest: there an impact is a row in which Λ acts while the contact was open in the step before. A contact is
    closed where a force acts, or where it has neither a gap nor a normal velocity at the end of the step: the
    first row has no forces. It slips where |γ_T| is beyond 1e-8 of the contact's largest speed in the run.
    What is below 1e-12 of the run's largest force or impulse, or 1e-12 m/s, is rounding.

    Parameters
    ----------
    columns : of the run, name: (rows, ...)
    slot : the contact's place in them
    run : the run's reactions
    """
    count = len(columns["t"])
    if slot.law.bilateral:
        return np.full(count, ContactState.HELD, dtype=np.int8)
    rows = slice(slot.row, slot.row + slot.rows)
    speeds = columns["velocity"][:, rows]
    still = max(RESTING_SPEED * _largest(speeds), LEAST_SPEED)
    gaps = columns["gap"][:, slot.gap : slot.gap + slot.gaps]
    impulsive = _acts(columns["impulse"][:, rows], run.least_impulse)
    closed = _acts(columns["force"][:, rows], run.least_force)
    closed |= ((gaps <= 0.0) & (np.abs(speeds[:, : slot.gaps]) <= still)).all(axis=1)
    if not run.told_apart:
        closed |= impulsive
        impulsive &= ~_in_the_step_before(closed, columns["step"])
    states = np.full(count, ContactState.OPEN, dtype=np.int8)
    states[closed] = ContactState.CLOSED
    if slot.law.friction:
        sliding = np.linalg.norm(speeds[:, slot.gaps :], axis=1)  # NaN: neither
        states[closed & (sliding <= still)] = ContactState.STICK
        states[closed & (sliding > still)] = ContactState.SLIP
    states[impulsive] = ContactState.IMPACT
    return states


def _largest(values: FloatArray) -> float:
    """Largest absolute value, without a copy of all; NaN are left out."""
    high = np.fmax.reduce(values, axis=None, initial=0.0)
    low = np.fmin.reduce(values, axis=None, initial=0.0)
    return max(float(high), -float(low))


def _acts(reactions: FloatArray, least: float) -> BoolArray:
    """Is one of them more than rounding? (rows,)."""
    acts: BoolArray = np.any(np.abs(reactions) > least, axis=1)
    return acts


def _in_the_step_before(closed: BoolArray, step: IntArray) -> BoolArray:
    """Was it closed in the step before? Steps with an impulse are never left out of a run."""
    before = np.zeros_like(closed)
    before[1:] = closed[:-1] & (np.diff(step) == 1)
    return before
