"""What is said about a run: where its contacts are, how it came about, what it looks like."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime, timezone
from typing import TYPE_CHECKING, Any, Protocol

from saltus._core import __version__, run_columns

if TYPE_CHECKING:
    from saltus.shapes import PlacedShape
    from saltus.typing import FloatArray

UNITS = run_columns()  #: all columns of a run, name: unit
CONTACT_COLUMNS = ("gap", "velocity", "lambda_plus", "lambda_minus", "force", "impulse")


class Rows(Protocol):
    """Where the rows of a run are: in memory or in a file, complete or growing."""

    @property
    def rows(self) -> int:
        """Their number."""

    def columns(self) -> Mapping[str, Any]:
        """All columns, name: array with one entry or row for each row of the run."""


@dataclass(frozen=True)
class Loaded:
    """Rows that were read."""

    rows: int
    values: Mapping[str, Any]

    def columns(self) -> Mapping[str, Any]:
        """All columns."""
        return self.values


@dataclass(frozen=True)
class ContactSlot:
    """Where a contact's rows and gaps stand among those of all contacts."""

    row: int
    rows: int
    gap: int
    gaps: int


@dataclass(frozen=True)
class Layout:
    """Names and places of the contacts, and how many coordinates each system has."""

    contacts: Mapping[str, ContactSlot]
    coordinates: tuple[int, ...]

    @staticmethod
    def of(contacts: Sequence[tuple[str, int, int, int, int]], coordinates: Sequence[int]) -> Layout:
        """From what the model lists: (name, row, rows, gap, gaps) of each contact."""
        return Layout({name: ContactSlot(*place) for name, *place in contacts}, tuple(coordinates))


@dataclass(frozen=True)
class Provenance:
    """How a run came about."""

    integrator: str
    options: Mapping[str, Any]  #: all of the integrator's, also those not given
    time_step: float  #: [s]
    solver: str
    record_every: int
    parameters: Mapping[str, Any]  #: of the model, as its author named them
    version: str = __version__  #: of Saltus
    created: str = field(default_factory=lambda: datetime.now(timezone.utc).isoformat())  #: start, wall clock


@dataclass(frozen=True)
class ContactRecord:
    """What happened in one contact, each array (rows of the run, rows of the contact)."""

    name: str
    gap: FloatArray  #: g [m], of the normal row or of all rows of an equality
    velocity: FloatArray  #: γ = Wᵀ v⁺ [m/s]
    lambda_plus: FloatArray  #: λ⁺ at the start of the step [N]
    lambda_minus: FloatArray  #: λ⁻ at its end [N]
    force: FloatArray  #: mean over the step [N], of the scheme's order where λ⁺ and λ⁻ are each of first
    impulse: FloatArray  #: Λ at its end [N s]


@dataclass(frozen=True)
class ShapeRecord:
    """A shape of a system and its pose in every row: x [m], y [m], angle [rad]."""

    system: int
    kind: str
    outline: FloatArray  #: (points, 2) [m] in the shape's frame
    poses: FloatArray  #: (rows, 3)


def follow(shapes: Iterable[PlacedShape | ShapeRecord], layout: Layout, q: FloatArray) -> list[ShapeRecord]:
    """Shapes with their poses at positions q (rows, n) of all systems.

    Raises
    ------
    ValueError
        If a pose is not three finite numbers.
    """
    return [shape if isinstance(shape, ShapeRecord) else _follow(shape, layout, q) for shape in shapes]


def _follow(shape: PlacedShape, layout: Layout, q: FloatArray) -> ShapeRecord:
    start = sum(layout.coordinates[: shape.system])
    poses = shape.poses(q[:, start : start + layout.coordinates[shape.system]])
    return ShapeRecord(shape.system, type(shape.shape).__name__, shape.shape.outline(), poses)


def plain(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """A copy as it will be read from a file."""
    try:
        plain = json.loads(json.dumps(parameters))
    except (TypeError, ValueError) as error:
        raise ValueError(f"parameters must be numbers, words, lists and mappings, got: {error}") from error
    if not isinstance(plain, dict):
        raise ValueError(f"parameters must be a mapping of names, got {type(parameters).__name__}")
    return plain
