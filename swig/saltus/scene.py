"""What a model looks like: shapes that follow its systems, and where its contacts are."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from saltus._core import Interaction, LagrangianDS, NewtonEulerDS
from saltus.io.records import PlaceRecord, Scene, ShapeRecord
from saltus.shapes import Pose, Shape, require_shape

if TYPE_CHECKING:
    from saltus.kernel import NonSmoothDynamicalSystem
    from saltus.typing import FloatArray

Place = Callable[["FloatArray"], "Sequence[Sequence[float] | FloatArray]"]
"""Positions q of the linked systems -> point [m] and unit vectors, each with 2 or 3 entries."""
Fixture = Sequence[float] | Callable[[float], Sequence[float]]
"""A pose that does not depend on any system: numbers, or a function of the time [s]."""


def attach(ds: LagrangianDS, shape: Shape, pose: Pose | None) -> None:
    """Let a system look like this in pictures: the body of ``ds.add_shape(shape, pose)``.

    Raises
    ------
    TypeError
        If shape is not a shape, or pose is not callable; only a NewtonEulerDS can do without.
    """
    require_shape(shape)
    if pose is None and not isinstance(ds, NewtonEulerDS):
        raise TypeError(
            f"pose must be given: only a NewtonEulerDS tells where its shapes are, got {type(ds).__name__}"
        )
    if pose is not None and not callable(pose):
        raise TypeError(f"pose must be a function q -> (x, y, angle), got {type(pose).__name__}")
    ds.__dict__.setdefault("_shapes", []).append((shape, pose))


def show_at(interaction: Interaction, place: Place) -> None:
    """Let pictures show a contact there: the body of ``interaction.show_at(place)``. Raises TypeError."""
    if not callable(place):
        raise TypeError(f"place must be a function q -> (point, *directions), got {type(place).__name__}")
    interaction.__dict__["_place"] = place


@dataclass(frozen=True)
class Appearance:
    """What a model looks like at any positions; see `of`."""

    shapes: tuple[PlacedShape, ...]
    places: tuple[Callable[[FloatArray], PlaceRecord | None], ...]

    @staticmethod
    def of(system: NonSmoothDynamicalSystem) -> Appearance:
        """Shapes of its systems and around them, and where its contacts are."""
        starts = np.cumsum([0, *(ds.coordinates for ds in system.systems)]).tolist()
        parts = [slice(start, end) for start, end in zip(starts, starts[1:], strict=False)]
        shapes = [
            PlacedShape(index, shape, pose, parts[index])
            for index, ds in enumerate(system.systems)
            for shape, pose in ds.__dict__.get("_shapes", [])
        ]
        shapes += [PlacedShape(-1, shape, pose, None) for shape, pose in system.scenery]
        contacts = [(name, rows) for name, _, rows, *_ in system.contacts()]
        places = [_placer(system, index, name, rows, parts) for index, (name, rows) in enumerate(contacts)]
        return Appearance(tuple(shapes), tuple(places))

    def scene(self, t: FloatArray, q: FloatArray) -> Scene:
        """In rows with times t (rows,) [s] and positions q (rows, n) of all systems.

        Raises
        ------
        ValueError
            If a pose is not three or seven finite numbers, or a place not a point and directions.
        """
        placed = [shape.record(t, q) for shape in self.shapes]
        found = [place(q) for place in self.places]
        return Scene(tuple(placed), tuple(place for place in found if place is not None))


@dataclass(frozen=True)
class PlacedShape:
    """A shape of the system with this index, and how its pose follows from that part of q; -1: from t."""

    system: int
    shape: Shape
    pose: Pose | Fixture | None
    part: slice | None

    def record(self, t: FloatArray, q: FloatArray) -> ShapeRecord:
        """In rows with times t (rows,) and positions q (rows, n) of all systems."""
        geometry, kind = self.shape.geometry(), type(self.shape).__name__
        return ShapeRecord(
            self.system, kind, geometry.points, geometry.lines, geometry.faces, self._poses(t, q)
        )

    def _poses(self, t: FloatArray, q: FloatArray) -> FloatArray:
        of = t if self.part is None else q[:, self.part]
        if self.pose is None and self.part is not None:
            return np.ascontiguousarray(of)  # position and quaternion of a rigid body
        if not callable(self.pose):
            return self._require([self.pose] * len(t))
        pose: Callable[[Any], Sequence[float]] = self.pose
        return self._require([pose(row) for row in of])

    def _require(self, found: Sequence[Any]) -> FloatArray:
        expected = f"the pose of {self.shape} must be three finite numbers (x, y, angle), or seven in space"
        try:
            poses = np.array(found, dtype=float).reshape(len(found), -1)
        except (TypeError, ValueError) as error:
            raise ValueError(f"{expected}, the same in every row, got {found[0]} in the first") from error
        if poses.shape[1] not in (3, 7):
            raise ValueError(f"{expected}, got {poses.shape[1]} in the first row: {found[0]}")
        wrong = ~np.isfinite(poses).all(axis=1)
        if wrong.any():
            raise ValueError(f"{expected}, got {poses[wrong][0]} in row {int(np.argmax(wrong))}")
        return poses


def _placer(
    system: NonSmoothDynamicalSystem, index: int, name: str, rows: int, parts: Sequence[slice]
) -> Callable[[FloatArray], PlaceRecord | None]:
    """What tells where a contact with so many rows is."""
    interaction, ends = system.links[index]
    given: Place | None = interaction.__dict__.get("_place")

    def known(q: FloatArray) -> PlaceRecord | None:
        found = system.places(index, np.ascontiguousarray(q))
        return None if found is None else PlaceRecord(name, *found)

    if given is None:
        return known

    def told(q: FloatArray) -> PlaceRecord:
        linked = np.hstack([q[:, parts[end]] for end in ends])
        return _place_record(name, rows, [given(row) for row in linked])

    return told


def _place_record(
    name: str, rows: int, places: Sequence[Sequence[Sequence[float] | FloatArray]]
) -> PlaceRecord:
    try:
        found = np.array(places, dtype=np.float32)
    except (TypeError, ValueError) as error:
        raise ValueError(f"the place of {name!r} must be a point and directions, got {places[0]}") from error
    if (
        found.ndim != 3
        or found.shape[2] not in (2, 3)
        or found.shape[1] > 1 + min(rows, 3)
        or not np.isfinite(found).all()
    ):
        raise ValueError(
            f"the place of {name!r} must be a point and at most three directions, no more than its rows, "
            f"{rows}, each of 2 or 3 finite numbers, got {places[0]} in the first row"
        )
    in_space = np.zeros((*found.shape[:2], 3), dtype=np.float32)
    in_space[:, :, : found.shape[2]] = found
    return PlaceRecord(name, in_space[:, 0], in_space[:, 1:])
