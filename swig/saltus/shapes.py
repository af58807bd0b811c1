"""How a system looks: plane shapes with a pose that follows its position. Only pictures use them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from saltus._core import LagrangianDS

if TYPE_CHECKING:
    from saltus.typing import FloatArray

Pose = Callable[["FloatArray"], Sequence[float]]
"""Position q (n,) of the system -> x [m], y [m] and angle [rad] of the shape's own frame."""


@dataclass(frozen=True)
class Disc:
    """A disc about the origin of its frame."""

    radius: float  #: [m]

    def __post_init__(self) -> None:
        _require_positive("radius", self.radius)

    def outline(self) -> FloatArray:
        """Closed polygon (points, 2) [m], with a spoke that shows the angle."""
        angle = np.linspace(0.0, 2 * np.pi, 65)
        rim = self.radius * np.column_stack([np.cos(angle), np.sin(angle)])
        return np.vstack([rim, [[0.0, 0.0]]])


@dataclass(frozen=True)
class Box:
    """A rectangle about the origin of its frame."""

    width: float  #: [m]
    height: float  #: [m]

    def __post_init__(self) -> None:
        _require_positive("width", self.width)
        _require_positive("height", self.height)

    def outline(self) -> FloatArray:
        """Closed polygon (points, 2) [m]."""
        x, y = self.width / 2, self.height / 2
        return np.array([[-x, -y], [x, -y], [x, y], [-x, y], [-x, -y]])


@dataclass(frozen=True)
class Polyline:
    """Straight lines through points of its frame."""

    points: tuple[tuple[float, float], ...]  #: [m]

    def __post_init__(self) -> None:
        points = np.asarray(self.points, dtype=float)
        if points.ndim != 2 or points.shape[1] != 2 or len(points) < 2 or not np.isfinite(points).all():
            raise ValueError(f"points must be at least two finite pairs (x, y), got shape {points.shape}")
        object.__setattr__(self, "points", tuple((float(x), float(y)) for x, y in points))

    def outline(self) -> FloatArray:
        """The points (points, 2) [m]."""
        return np.array(self.points)


Shape = Disc | Box | Polyline


@dataclass(frozen=True)
class PlacedShape:
    """A shape of the system with this index, and where it is."""

    system: int
    shape: Shape
    pose: Pose

    def poses(self, q: FloatArray) -> FloatArray:
        """Poses (rows, 3) at positions q (rows, n) of the system.

        Raises
        ------
        ValueError
            If the pose is not three finite numbers.
        """
        poses = np.array([self.pose(row) for row in q], dtype=float).reshape(len(q), -1)
        if poses.shape[1] != 3 or not np.isfinite(poses).all():
            raise ValueError(
                f"the pose of {self.shape} must be three finite numbers (x, y, angle), "
                f"got {poses.shape[1]} in the first row: {poses[0] if len(poses) else poses}"
            )
        return poses


def _require_positive(name: str, value: float) -> None:
    if not (np.isfinite(value) and value > 0):
        raise ValueError(f"{name} must be positive and finite, got {value}")


def attach(ds: LagrangianDS, shape: Shape, pose: Pose) -> None:
    """Let a system look like this in pictures: the body of ``ds.add_shape(shape, pose)``.

    Raises
    ------
    TypeError
        If shape is not a shape or pose is not callable.
    """
    if not isinstance(shape, Disc | Box | Polyline):
        raise TypeError(f"shape must be a Disc, Box or Polyline, got {type(shape).__name__}")
    if not callable(pose):
        raise TypeError(f"pose must be a function q -> (x, y, angle), got {type(pose).__name__}")
    ds.__dict__.setdefault("_shapes", []).append((shape, pose))


def shapes_of(systems: Sequence[LagrangianDS]) -> list[PlacedShape]:
    """All shapes of these systems, with the systems' indices."""
    return [
        PlacedShape(index, shape, pose)
        for index, ds in enumerate(systems)
        for shape, pose in ds.__dict__.get("_shapes", [])
    ]
