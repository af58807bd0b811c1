"""What a page tells about a run: texts, and numbers of as many of its rows as a page can carry."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from saltus.io import FirstOrderTrajectory, Trajectory
from saltus.io.contact_states import ContactState
from saltus.report.contacts import MOST_CONTACTS, Arrows, arrows_of, intervals_of, rows_of_states
from saltus.report.panels import Panel, first_order_panels, panels_of
from saltus.report.summary import first_order_summary, summary_of

if TYPE_CHECKING:
    from saltus.io import Scene
    from saltus.io.records import ShapeRecord
    from saltus.typing import FloatArray, IntArray

FEWEST_ROWS = 200
MOST_SHAPES = 400
TYPES = {"float32": "f4", "float64": "f8", "uint16": "u2", "uint32": "u4", "uint8": "u1"}


@dataclass(frozen=True)
class Content:
    """Texts as JSON takes them, which say where in `numbers` the arrays are."""

    texts: dict[str, Any]
    numbers: bytes


def content_of(run: Trajectory | FirstOrderTrajectory, size: int) -> Content:
    """Of a run, with as many rows as about `size` bytes can hold.

    Raises
    ------
    ValueError
        If it has no rows, or times that are not finite.
    """
    if not len(run) or not np.isfinite(run.t).all():
        raise ValueError(f"a report needs rows with finite times, got {len(run)} rows")
    return _mechanical(run, size) if isinstance(run, Trajectory) else _first_order(run, size)


def _mechanical(run: Trajectory, size: int) -> Content:
    first, contacts = run.scene_in(np.arange(1)), run.busiest_contacts(MOST_CONTACTS)
    panels = panels_of(run, contacts)
    numbers = sum(shape.poses.shape[1] for shape in first.shapes) + 4 * len(first.places)
    most = most_rows(panels, numbers, size)
    rows = rows_of(len(run), panels, run.strongest_impacts(most // 4), most)
    scene = run.scene_in(rows)  # of these alone: poses can be functions in Python
    arrays = _Arrays()
    shapes = [_put_shape(arrays, number, shape) for number, shape in enumerate(scene.shapes[:MOST_SHAPES])]
    arrows = arrows_of(run, scene.places, rows)
    _put_arrows(arrays, arrows)
    looked = rows_of_states(run, contacts)
    texts = {
        "summary": summary_of(run),
        "bounds": bounds_of(scene, len(rows)),
        "spatial": any(shape.spatial for shape in scene.shapes),
        "shapes": shapes,
        "more_shapes": max(len(scene.shapes) - MOST_SHAPES, 0),
        "contacts": [{"name": name, "intervals": intervals_of(run, name, looked)} for name in contacts],
        "coarse": len(looked) if len(looked) < len(run) else 0,
        "more_contacts": len(run.contacts) - len(contacts),
        "states": [state.name for state in ContactState],
        "largest": {"force": arrows.largest_force, "impulse": arrows.largest_impulse},
        "arrow_names": arrows.names,
    }
    return _content(run.t, rows, panels, arrays, texts)


def _first_order(run: FirstOrderTrajectory, size: int) -> Content:
    panels = first_order_panels(run)
    rows = rows_of(len(run), panels, np.empty(0, dtype=np.int64), most_rows(panels, 0, size))
    texts: dict[str, Any] = {
        "summary": first_order_summary(run),
        "shapes": None,
        "contacts": [],
        "states": [],
    }
    return _content(run.t, rows, panels, _Arrays(), texts)


def _content(
    t: FloatArray, rows: IntArray, panels: Sequence[Panel], arrays: _Arrays, texts: dict[str, Any]
) -> Content:
    arrays.put("t", t[rows], "float64")
    texts |= {
        "rows": [len(rows), len(t)],
        "span": [float(t[0]), float(t[-1])],
        "panels": [_put_panel(arrays, number, panel, rows) for number, panel in enumerate(panels)],
        "arrays": arrays.entries,
    }
    return Content(texts, arrays.packed())


def most_rows(panels: Sequence[Panel], numbers: int, size: int) -> int:
    """How many rows these bytes can hold, each with the time, the plots and so many numbers more."""
    numbers += 2 + sum(panel.values.shape[1] for panel in panels)
    return max(size // (4 * numbers), FEWEST_ROWS)


def rows_of(total: int, panels: Sequence[Panel], hits: IntArray, most: int) -> IntArray:
    """Rows that the page carries: all, or some evenly, impacts, what is before them, and extremes."""
    if total <= most:
        return np.arange(total)
    kept = [np.linspace(0, total - 1, most // 2).round().astype(int), hits, np.maximum(hits - 1, 0)]
    for panel in panels:
        known = np.where(np.isfinite(panel.values), panel.values, np.nan)
        if panel.values.shape[1] and np.isfinite(known).any(axis=0).all():
            kept += [np.nanargmin(known, axis=0), np.nanargmax(known, axis=0)]
    return np.unique(np.concatenate(kept))


def bounds_of(scene: Scene, rows: int) -> list[list[float]]:
    """Lowest and highest coordinates of all shapes in about 200 of its rows, evenly [m]."""
    few = range(0, rows, max(rows // 200, 1))
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


def _put_shape(arrays: _Arrays, number: int, shape: ShapeRecord) -> dict[str, Any]:
    poses = shape.poses
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
