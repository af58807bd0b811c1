"""How a system looks: shapes with a pose that follows its position. Only pictures use them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from saltus.typing import FloatArray, IntArray

Pose = Callable[["FloatArray"], Sequence[float]]
"""Position q (n,) of the system -> where the shape's frame is: x [m], y [m] and angle [rad] in the plane, or
x, y, z [m] and a unit quaternion (w, x, y, z) in space."""

ROUND = 64  #: edges of a disc's rim
AROUND, UPWARD = 24, 12  #: faces of a sphere


@dataclass(frozen=True)
class Geometry:
    """Points of a shape's own frame, and how they are joined."""

    points: FloatArray  #: (points, 2) or (points, 3) [m]
    lines: IntArray  #: (lines, 2) numbers of points
    faces: IntArray  #: (faces, 3) numbers of points, counterclockwise from outside


@dataclass(frozen=True)
class Disc:
    """A disc about the origin of its frame, with a spoke that shows the angle."""

    radius: float  #: [m]

    def __post_init__(self) -> None:
        _require_positive("radius", self.radius)

    def geometry(self) -> Geometry:
        """The rim, and last the centre."""
        angle = 2 * np.pi * np.arange(ROUND) / ROUND
        points = np.vstack([self.radius * np.column_stack([np.cos(angle), np.sin(angle)]), [[0.0, 0.0]]])
        rim = _ring(ROUND)
        return Geometry(points, np.vstack([rim, [[ROUND, 0]]]), np.column_stack([np.full(ROUND, ROUND), rim]))


@dataclass(frozen=True)
class Box:
    """A rectangle about the origin of its frame, or with a depth, along z, a box."""

    width: float  #: along x [m]
    height: float  #: along y [m]
    depth: float | None = None  #: along z [m]

    def __post_init__(self) -> None:
        _require_positive("width", self.width)
        _require_positive("height", self.height)
        if self.depth is not None:
            _require_positive("depth", self.depth)

    def geometry(self) -> Geometry:
        """The corners: of a box those below first."""
        corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * [self.width / 2, self.height / 2]
        if self.depth is None:
            return Geometry(corners, _ring(4), np.array([[0, 1, 2], [0, 2, 3]]))
        below, above = (np.column_stack([corners, np.full(4, z)]) for z in (-self.depth / 2, self.depth / 2))
        upright = np.column_stack([np.arange(4), np.arange(4, 8)])
        return Geometry(
            np.vstack([below, above]),
            np.vstack([_ring(4), _ring(4) + 4, upright]),
            np.vstack([[[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]], _mantle(4)]),
        )


@dataclass(frozen=True)
class Polyline:
    """Straight lines through points of its frame, (x, y) or (x, y, z)."""

    points: tuple[tuple[float, ...], ...]  #: [m]

    def __post_init__(self) -> None:
        points = np.asarray(self.points, dtype=float)
        if points.ndim != 2 or points.shape[1] not in (2, 3) or len(points) < 2:
            raise ValueError(
                f"points must be at least two of 2 or 3 entries each, got an array of shape {points.shape}"
            )
        if not np.isfinite(points).all():
            raise ValueError("points must be finite, got NaN or infinity")
        object.__setattr__(self, "points", tuple(tuple(float(x) for x in point) for point in points))

    def geometry(self) -> Geometry:
        """The points, one after the other."""
        numbers = np.arange(len(self.points))
        return Geometry(np.array(self.points), np.column_stack([numbers[:-1], numbers[1:]]), _no_faces())


@dataclass(frozen=True)
class Sphere:
    """A sphere about the origin of its frame, with three great circles that show how it turns."""

    radius: float  #: [m]

    def __post_init__(self) -> None:
        _require_positive("radius", self.radius)

    def geometry(self) -> Geometry:
        """Rings of points from the lower pole to the upper one, then those of the great circles."""
        latitude = np.pi * np.arange(1, UPWARD) / UPWARD - np.pi / 2
        angle = 2 * np.pi * np.arange(AROUND) / AROUND
        rings = [
            np.column_stack(
                [np.cos(a) * np.cos(angle), np.cos(a) * np.sin(angle), np.full(AROUND, np.sin(a))]
            )
            for a in latitude
        ]
        poles = len(rings) * AROUND + 1  # the number of the upper one
        ring = _ring(AROUND)
        lowest, highest = 1 + ring, poles - AROUND + ring
        faces = [np.column_stack([np.zeros(AROUND, int), lowest[:, ::-1]])]
        faces += [_mantle(AROUND) + 1 + k * AROUND for k in range(len(rings) - 1)]
        faces += [np.column_stack([np.full(AROUND, poles), highest])]
        around = 2 * np.pi * np.arange(ROUND) / ROUND
        cosine, sine, zero = np.cos(around), np.sin(around), np.zeros(ROUND)
        circles = [(cosine, sine, zero), (cosine, zero, sine), (zero, cosine, sine)]
        points = np.vstack([[[0, 0, -1]], *rings, [[0, 0, 1]], *(np.column_stack(c) for c in circles)])
        lines = np.vstack([_ring(ROUND) + poles + 1 + k * ROUND for k in range(3)])
        return Geometry(self.radius * points, lines, np.vstack(faces))


@dataclass(frozen=True)
class Cylinder:
    """A cylinder about the z axis of its frame; with another radius on top a frustum, with 0 a cone."""

    radius: float  #: at -length/2 [m]
    length: float  #: [m]
    radius_on_top: float | None = None  #: at length/2 [m]; the same if it is left out

    def __post_init__(self) -> None:
        _require_positive("radius", self.radius)
        _require_positive("length", self.length)
        if self.radius_on_top:
            _require_positive("radius_on_top", self.radius_on_top)

    def geometry(self) -> Geometry:
        """Both rims, then the centres of the ends."""
        sides = ROUND // 2
        angle = 2 * np.pi * np.arange(sides) / sides
        rim = np.column_stack([np.cos(angle), np.sin(angle)])
        top = self.radius if self.radius_on_top is None else self.radius_on_top
        ends = [
            np.column_stack([radius * rim, np.full(sides, z)])
            for radius, z in ((self.radius, -self.length / 2), (top, self.length / 2))
        ]
        centres = [[0, 0, -self.length / 2], [0, 0, self.length / 2]]
        ring, lower, upper = _ring(sides), np.full(sides, 2 * sides), np.full(sides, 2 * sides + 1)
        marks = np.column_stack([np.arange(0, sides, sides // 4), np.arange(0, sides, sides // 4) + sides])
        return Geometry(
            np.vstack([*ends, centres]),
            np.vstack([ring, ring + sides, marks, [[2 * sides + 1, sides]]]),
            np.vstack(
                [
                    np.column_stack([lower, ring[:, ::-1]]),
                    _mantle(sides),
                    np.column_stack([upper, ring + sides]),
                ]
            ),
        )


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles between points of its frame, such as those of an STL file."""

    points: FloatArray  #: (points, 3) [m]
    faces: IntArray  #: (faces, 3) numbers of points, counterclockwise from outside

    def __post_init__(self) -> None:
        points, faces = np.array(self.points, dtype=float), np.array(self.faces)
        if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
            raise ValueError(f"points must be finite, of shape (points, 3), got shape {points.shape}")
        if (
            faces.ndim != 2
            or faces.shape[1] != 3
            or not len(faces)
            or not np.issubdtype(faces.dtype, np.integer)
        ):
            raise ValueError(
                f"faces must be whole numbers (faces, 3), got {faces.dtype} of shape {faces.shape}"
            )
        if faces.min() < 0 or faces.max() >= len(points):
            raise ValueError(
                f"faces must name points 0 ... {len(points) - 1}, got {faces.min()} ... {faces.max()}"
            )
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "faces", faces)

    def geometry(self) -> Geometry:
        """The triangles, without lines."""
        return Geometry(self.points, np.empty((0, 2), dtype=np.int64), self.faces)


Shape = Disc | Box | Polyline | Sphere | Cylinder | Mesh


def require_shape(shape: Any) -> None:
    """Raise TypeError if it is something else."""
    if not isinstance(shape, Shape):
        kinds = "Disc, Box, Polyline, Sphere, Cylinder or Mesh"
        raise TypeError(f"shape must be a {kinds}, got {type(shape).__name__}")


def _ring(points: int) -> IntArray:
    """Lines from each point to the next, and from the last to the first."""
    numbers = np.arange(points)
    return np.column_stack([numbers, np.roll(numbers, -1)])


def _mantle(points: int) -> IntArray:
    """Triangles between a ring of points and the next ring, above it."""
    ring = _ring(points)
    first, second = ring[:, 0], ring[:, 1]
    return np.vstack(
        [
            np.column_stack([first, second, second + points]),
            np.column_stack([first, second + points, first + points]),
        ]
    )


def _no_faces() -> IntArray:
    return np.empty((0, 3), dtype=np.int64)


def _require_positive(name: str, value: float) -> None:
    if not isinstance(value, Real) or isinstance(value, bool):
        raise TypeError(f"{name} must be a number, got {type(value).__name__}")
    if not (np.isfinite(value) and value > 0):
        raise ValueError(f"{name} must be positive and finite, got {value}")
