"""What is said about a run: where its contacts are, how it came about, what it looks like."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime, timezone
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from saltus import notebook
from saltus._core import __version__, rotation_matrix, run_columns

if TYPE_CHECKING:
    from saltus.typing import FloatArray, IntArray, StateArray

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
class Continued:
    """Rows that were read, and those that a recording adds to them from its row number `skip` on."""

    before: Loaded
    after: Rows
    skip: int = 0

    @property
    def rows(self) -> int:
        """Their number."""
        return self.before.rows + self.after.rows - self.skip

    def columns(self) -> Mapping[str, Any]:
        """All columns."""
        earlier, later = self.before.columns(), self.after.columns()
        return {name: np.concatenate([earlier[name], later[name][self.skip :]]) for name in later}


@dataclass(frozen=True)
class ContactLaw:
    """The law of a contact: its class, and the parameters that it has."""

    name: str  #: of a class of `saltus.kernel`, "NonSmoothLaw" if there is no special one
    restitution: float | None = None  #: ε_N
    tangential_restitution: float | None = None  #: ε_T
    friction: float | None = None  #: μ

    @property
    def bilateral(self) -> bool:
        """True for an equality, which always holds."""
        return self.name == "EqualityConditionNSL"


@dataclass(frozen=True)
class ContactSlot:
    """Where a contact's rows and gaps stand among those of all contacts, and its law.

    The first rows are those with a gap, normal ones or those of an equality, the others are tangential.
    """

    row: int
    rows: int
    gap: int
    gaps: int
    law: ContactLaw


@dataclass(frozen=True)
class Layout:
    """Names and places of the contacts, and how many coordinates each system has."""

    contacts: Mapping[str, ContactSlot]
    coordinates: tuple[int, ...]

    @staticmethod
    def of(
        contacts: Sequence[tuple[str, int, int, int, int, Mapping[str, Any]]], coordinates: Sequence[int]
    ) -> Layout:
        """From what the model lists: (name, row, rows, gap, gaps, law) of each contact."""
        slots = {
            name: ContactSlot(row, rows, gap, gaps, ContactLaw(**law))
            for name, row, rows, gap, gaps, law in contacts
        }
        return Layout(slots, tuple(coordinates))


@dataclass(frozen=True)
class Provenance:
    """How a run came about."""

    integrator: str
    options: Mapping[str, Any]  #: all of the integrator's, also those not given
    time_step: float  #: [s]
    solver: str
    record_every: int
    parameters: Mapping[str, Any]  #: of the model, as its author named them
    tolerance: float = 1e-12  #: of the contact problems
    forces_at_rest: bool | None = (
        None  #: has the integrator forces λ besides impulses Λ? None: not registered
    )
    version: str = __version__  #: of Saltus
    created: str = field(default_factory=lambda: datetime.now(timezone.utc).isoformat())  #: start, wall clock


@dataclass(frozen=True, repr=False)
class ContactRecord:
    """What happened in one contact, each array (rows of the run, rows of the contact)."""

    name: str
    gap: FloatArray  #: g [m], of the normal row or of all rows of an equality
    velocity: FloatArray  #: γ = Wᵀ v⁺ [m/s]
    lambda_plus: FloatArray  #: λ⁺ at the start of the step [N]
    lambda_minus: FloatArray  #: λ⁻ at its end [N]
    force: FloatArray  #: mean over the step [N], of the scheme's order where λ⁺ and λ⁻ are each of first
    impulse: FloatArray  #: Λ at its end [N s]
    law: ContactLaw
    find_states: Callable[[], StateArray]

    @property
    def states(self) -> StateArray:
        """Open, closed, sticking, slipping, impact or held: codes of `ContactState`, (rows,) of int8."""
        return self.find_states()

    def __repr__(self) -> str:
        return f"<ContactRecord {self.name!r}: {self.law.name}, {notebook.counted(len(self.gap), 'row')}>"

    def _repr_html_(self) -> str:
        return notebook.contact(self)


@dataclass(frozen=True)
class ShapeRecord:
    """A shape of a system, or with -1 one around the systems, and where it is in every row."""

    system: int
    kind: str
    points: FloatArray  #: (points, 2) or (points, 3) [m] in the shape's frame
    lines: IntArray  #: (lines, 2) numbers of points
    faces: IntArray  #: (faces, 3) numbers of points, counterclockwise from outside
    poses: FloatArray  #: (rows, 3): x [m], y [m], angle [rad]; or (rows, 7): x, y, z [m], quaternion

    @property
    def spatial(self) -> bool:
        """True unless it stays in the plane z = 0."""
        return bool(self.points.shape[1] == 3 or self.poses.shape[1] == 7)

    def in_space(self, row: int) -> FloatArray:
        """Where its points are in a row (points, 3) [m]."""
        points = np.zeros((len(self.points), 3))
        points[:, : self.points.shape[1]] = self.points
        at, rotation = in_space(self.poses[row])
        placed: FloatArray = points @ rotation.T + at
        return placed


def in_space(pose: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Origin (3,) [m] and rotation matrix (3, 3) of a pose (3,) or (7,)."""
    if len(pose) == 3:
        x, y, angle = pose
        c, s = np.cos(angle), np.sin(angle)
        return np.array([x, y, 0.0]), np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return np.array(pose[:3]), rotation_matrix(pose[3:])


@dataclass(frozen=True)
class PlaceRecord:
    """Where a contact is in every row, and along which directions its rows push its first system."""

    contact: str
    point: FloatArray  #: (rows, 3) [m]
    directions: FloatArray  #: (rows, up to 3, 3), of the contact's first rows

    def in_space(self, values: FloatArray) -> FloatArray:
        """Forces or impulses (rows, rows of the contact) as vectors (rows, 3), where directions are known."""
        vectors: FloatArray = np.einsum("rk,rkx->rx", values[:, : self.directions.shape[1]], self.directions)
        return vectors


@dataclass(frozen=True)
class Scene:
    """What is seen of a run."""

    shapes: tuple[ShapeRecord, ...] = ()
    places: tuple[PlaceRecord, ...] = ()

    def in_rows(self, rows: IntArray) -> Scene:
        """The same in these rows (k,) alone."""
        return Scene(
            tuple(replace(shape, poses=shape.poses[rows]) for shape in self.shapes),
            tuple(
                replace(place, point=place.point[rows], directions=place.directions[rows])
                for place in self.places
            ),
        )


def plain(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """A copy as it will be read from a file."""
    try:
        plain = json.loads(json.dumps(parameters))
    except (TypeError, ValueError) as error:
        raise ValueError(f"parameters must be numbers, words, lists and mappings, got: {error}") from error
    if not isinstance(plain, dict):
        raise ValueError(f"parameters must be a mapping of names, got {type(parameters).__name__}")
    return plain
