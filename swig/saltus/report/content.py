"""What a page tells about a run: texts, and numbers of as many of its rows as a page can carry."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from saltus.io.contact_states import ContactState
from saltus.report.contacts import Arrows, arrows_of, intervals_of, ranking
from saltus.report.panels import Panel, panels_of
from saltus.report.summary import summary_of

if TYPE_CHECKING:
    from saltus.io import Scene, Trajectory
    from saltus.typing import IntArray

FEWEST_ROWS = 200
MOST_SHAPES = 400
TYPES = {"float32": "f4", "float64": "f8", "uint16": "u2", "uint32": "u4", "uint8": "u1"}


@dataclass(frozen=True)
class Content:
    """Texts as JSON takes them, which say where in `numbers` the arrays are."""

    texts: dict[str, Any]
    numbers: bytes


def content_of(trajectory: Trajectory, most: int) -> Content:
    """Of a run, with as many rows as about `most` bytes can hold.

    Raises
    ------
    ValueError
        If it has no rows, or times that are not finite.
    """
    t = trajectory.t
    if not len(t) or not np.isfinite(t).all():
        raise ValueError(f"a report needs rows with finite times, got {len(t)} rows")
    scene = trajectory.scene
    contacts = ranking(trajectory)
    panels = panels_of(trajectory, contacts)
    rows = rows_of(trajectory, panels, scene, most)
    arrays = _Arrays()
    arrays.put("t", t[rows], "float64")
    shapes = [
        _put_shape(arrays, number, shape, rows) for number, shape in enumerate(scene.shapes[:MOST_SHAPES])
    ]
    arrows = arrows_of(trajectory, scene.places, rows)
    _put_arrows(arrays, arrows)
    texts = {
        "summary": summary_of(trajectory),
        "rows": [len(rows), len(t)],
        "span": [float(t[0]), float(t[-1])],
        "bounds": bounds_of(scene, rows),
        "spatial": any(shape.spatial for shape in scene.shapes),
        "shapes": shapes,
        "more_shapes": max(len(scene.shapes) - MOST_SHAPES, 0),
        "contacts": [
            {
                "name": name,
                "intervals": intervals_of(trajectory, name),
            }
            for name in contacts
        ],
        "more_contacts": len(trajectory.contacts) - len(contacts),
        "states": [state.name for state in ContactState],
        "largest": {"force": arrows.largest_force, "impulse": arrows.largest_impulse},
        "arrow_names": arrows.names,
        "panels": [_put_panel(arrays, number, panel, rows) for number, panel in enumerate(panels)],
        "arrays": arrays.entries,
    }
    return Content(texts, arrays.packed())


def rows_of(trajectory: Trajectory, panels: Sequence[Panel], scene: Scene, size: int) -> IntArray:
    """Rows that the page carries: all, or some evenly, impacts, what is before them, and extremes."""
    total = len(trajectory)
    numbers = sum(panel.values.shape[1] for panel in panels)
    numbers += sum(shape.poses.shape[1] for shape in scene.shapes) + 2 + 4 * len(scene.places)
    most = max(size // (4 * numbers), FEWEST_ROWS)
    if total <= most:
        return np.arange(total)
    hits = np.flatnonzero(trajectory.impacts)
    if 2 * len(hits) > most // 2:  # the strongest
        strength = np.abs(trajectory.columns()["impulse"][hits]).sum(axis=1)
        hits = hits[np.argsort(strength, kind="stable")[-(most // 4) :]]
    kept = [np.linspace(0, total - 1, most // 2).round().astype(int), hits, np.maximum(hits - 1, 0)]
    for panel in panels:
        known = np.where(np.isfinite(panel.values), panel.values, np.nan)
        if panel.values.shape[1] and np.isfinite(known).any(axis=0).all():
            kept += [np.nanargmin(known, axis=0), np.nanargmax(known, axis=0)]
    return np.unique(np.concatenate(kept))


def bounds_of(scene: Scene, rows: IntArray) -> list[list[float]]:
    """Lowest and highest coordinates of all shapes in at most 200 of these rows [m]."""
    few = rows[:: max(len(rows) // 200, 1)]
    seen = [shape.in_space(row) for shape in scene.shapes[:MOST_SHAPES] for row in few]
    if not seen:
        return [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
    points = np.vstack(seen)
    return [points.min(axis=0).tolist(), points.max(axis=0).tolist()]


class _Arrays:
    """Arrays one after the other, equal ones once."""

    def __init__(self) -> None:
        self.entries: dict[str, list[Any]] = {}
        self._chunks: list[bytes] = []
        self._known: dict[tuple[str, bytes], list[Any]] = {}
        self._size = 0

    def put(self, name: str, values: Any, kind: str) -> None:
        data = np.ascontiguousarray(values, dtype=TYPES[kind]).tobytes()
        if (kind, data) not in self._known:
            self._known[kind, data] = [kind, self._size, int(np.size(values))]
            self._chunks.append(data + bytes(-len(data) % 8))
            self._size += len(self._chunks[-1])
        self.entries[name] = self._known[kind, data]

    def packed(self) -> bytes:
        return b"".join(self._chunks)


def _put_shape(arrays: _Arrays, number: int, shape: Any, rows: IntArray) -> dict[str, Any]:
    poses = shape.poses[rows]
    if (poses == poses[0]).all():
        poses = poses[:1]  # it stands still
    arrays.put(f"points{number}", shape.points, "float32")
    arrays.put(f"lines{number}", shape.lines, "uint16" if len(shape.points) < 65536 else "uint32")
    arrays.put(f"faces{number}", shape.faces, "uint16" if len(shape.points) < 65536 else "uint32")
    arrays.put(f"poses{number}", poses, "float32")
    sizes = {"dimension": shape.points.shape[1], "pose": poses.shape[1], "moves": len(poses) > 1}
    return {"system": shape.system, "kind": shape.kind, **sizes}


def _put_arrows(arrays: _Arrays, arrows: Arrows) -> None:
    arrays.put("arrow_start", arrows.start, "uint32")
    arrays.put("arrow_contact", arrows.contact, "uint16")
    arrays.put("arrow_state", arrows.state, "uint8")
    for name in ("point", "force", "impulse"):
        arrays.put(f"arrow_{name}", getattr(arrows, name), "float32")


def _put_panel(arrays: _Arrays, number: int, panel: Panel, rows: IntArray) -> dict[str, Any]:
    for k in range(panel.values.shape[1]):
        arrays.put(f"panel{number}.{k}", panel.values[rows, k], "float32")
    lines = [{"label": line.label, "contact": line.contact, "row": line.row} for line in panel.lines]
    return {"title": panel.title, "unit": panel.unit, "kind": panel.kind, "note": panel.note, "lines": lines}
