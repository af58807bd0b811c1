"""Runs for ParaView: shapes and contacts in files of VTK, one a row, and a collection with their times."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np

from saltus.io.contact_states import ContactState
from saltus.io.files import new_file, unwritable, writable_folder

if TYPE_CHECKING:
    from vtkmodules.vtkCommonCore import vtkDataArray, vtkStringArray
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

    from saltus.io.records import PlaceRecord, ShapeRecord
    from saltus.io.trajectory import Trajectory
    from saltus.typing import FloatArray, IntArray

    Frame = Callable[[int], vtkPolyData]

MOST_FRAMES = 300  #: evenly over a run, and as many impacts
FRAME = re.compile(r"\d{8}\.vtp")


def write_vtk(trajectory: Trajectory, folder: str | os.PathLike[str], every: int | None) -> list[Path]:
    """See `Trajectory.to_vtk`."""
    _require_vtk()
    trajectory = trajectory.loaded()
    rows = frames_of(trajectory, every)
    before = np.where(rows > 0, rows - 1, min(1, len(trajectory) - 1))
    known = np.union1d(rows, before)
    scene = trajectory.scene_in(known)
    if not scene.shapes and not scene.places:
        raise ValueError(
            "expected a run of something that is seen, got neither shapes nor places of contacts: before a "
            "run give its systems shapes, ds.add_shape(shape, pose), and its contacts places, "
            "interaction.show_at(place)"
        )
    parts: list[tuple[str, Frame]] = []
    if scene.shapes:
        parts.append(("bodies", _Bodies(scene.shapes, known, trajectory.t).frame))
    if scene.places:
        parts.append(("contacts", _Contacts(trajectory, scene.places, known).frame))
    target = writable_folder(folder)
    _clear(target)
    return [_write_collection(target, name, trajectory, rows, frame) for name, frame in parts]


def frames_of(trajectory: Trajectory, every: int | None) -> IntArray:
    """Rows that are exported: see `Trajectory.to_vtk`."""
    count = len(trajectory)
    if not count:
        raise ValueError("expected a run with rows, got none")
    if every is not None and every < 1:
        raise ValueError(f"every must be at least 1, got {every}")
    if every is not None:
        return np.union1d(np.arange(0, count, every), np.flatnonzero(trajectory.impacts))
    hits = trajectory.strongest_impacts(MOST_FRAMES)
    even = np.linspace(0, count - 1, min(count, MOST_FRAMES)).round().astype(np.int64)
    return np.union1d(even, hits)


class _Bodies:
    """All shapes as lines and faces, which are joined alike in every row.

    Parameters
    ----------
    shapes : with their poses in some rows
    known : (poses,) these rows
    t : (rows,) [s]
    """

    def __init__(self, shapes: Sequence[ShapeRecord], known: IntArray, t: FloatArray) -> None:
        self._shapes, self._known, self._t = shapes, known, t
        start = np.cumsum([0, *(len(shape.points) for shape in shapes)])
        self._lines = _cells([shape.lines + at for shape, at in zip(shapes, start, strict=False)])
        self._faces = _cells([shape.faces + at for shape, at in zip(shapes, start, strict=False)])
        kinds = sorted({shape.kind for shape in shapes})
        self._kinds = _strings("kinds", kinds)
        self._cell_data = {
            "system": self._of_cells([shape.system for shape in shapes]),
            "shape": self._of_cells(list(range(len(shapes)))),
            "kind": self._of_cells([kinds.index(shape.kind) for shape in shapes]),
        }

    def _of_cells(self, values: Sequence[int]) -> IntArray:
        """A number of each shape for each of its lines, then for each of its faces."""
        lines, faces = ([len(getattr(shape, name)) for shape in self._shapes] for name in ("lines", "faces"))
        return np.concatenate([np.repeat(values, lines), np.repeat(values, faces)])

    def frame(self, row: int) -> vtkPolyData:
        """The shapes in this row, with the mean velocity of their points since the row before."""
        other = row - 1 if row > 0 else min(1, len(self._t) - 1)
        points, duration = self._points(row), self._t[row] - self._t[other]
        velocity = (points - self._points(other)) / duration if duration else np.zeros_like(points)
        data = _poly_data(points)
        data.SetLines(self._lines)
        data.SetPolys(self._faces)
        _put(data.GetPointData(), {"velocity": velocity})
        _put(data.GetCellData(), self._cell_data)
        data.GetFieldData().AddArray(self._kinds)
        return data

    def _points(self, row: int) -> FloatArray:
        at = int(np.searchsorted(self._known, row))
        return np.vstack([shape.in_space(at) for shape in self._shapes])


class _Contacts:
    """Contacts whose place is known as points, with what acts there.

    Parameters
    ----------
    trajectory : the run
    places : in some rows
    known : (places,) these rows
    """

    def __init__(self, trajectory: Trajectory, places: Sequence[PlaceRecord], known: IntArray) -> None:
        self._known, self._places = known, places
        records = [trajectory[place.contact] for place in places]
        self._gaps = np.column_stack([record.gap[known, 0] for record in records])
        self._states = np.column_stack([record.states[known] for record in records])
        acting = [trajectory.reactions(place.contact) for place in places]
        self._force, self._impulse = (
            np.stack([place.in_space(part[k][known]) for part, place in zip(acting, places, strict=True)], 1)
            for k in range(2)
        )
        self._names = _strings("contacts", [place.contact for place in places])
        self._kinds = _strings("states", [state.name.lower() for state in ContactState])
        self._vertices = _cells([np.arange(len(places))[:, None]])

    def frame(self, row: int) -> vtkPolyData:
        """The contacts in this row."""
        at = int(np.searchsorted(self._known, row))
        data = _poly_data(np.array([place.point[at] for place in self._places]))
        data.SetVerts(self._vertices)
        arrays = {
            "contact": np.arange(len(self._places)),
            "gap": self._gaps[at],
            "state": self._states[at],
            "force": self._force[at],
            "impulse": self._impulse[at],
        }
        for k in range(3):
            arrays[f"direction{k}"] = np.array([_direction(place, at, k) for place in self._places])
        _put(data.GetPointData(), arrays)
        data.GetFieldData().AddArray(self._names)
        data.GetFieldData().AddArray(self._kinds)
        return data


def _direction(place: PlaceRecord, at: int, number: int) -> FloatArray:
    return place.directions[at, number] if number < place.directions.shape[1] else np.zeros(3)


def _clear(target: Path) -> None:
    """Remove an earlier export."""
    for name in ("bodies", "contacts"):
        frames = [path for path in (target / name).glob("*.vtp") if FRAME.fullmatch(path.name)]
        for path in [target / f"{name}.pvd", *frames]:
            if path.is_file():
                path.unlink()


def _write_collection(target: Path, name: str, trajectory: Trajectory, rows: IntArray, frame: Frame) -> Path:
    """One file for each of these rows, and the collection of them, which is there when they are."""
    folder = writable_folder(target / name)
    root = ElementTree.Element("VTKFile", type="Collection", version="0.1")
    collection = ElementTree.SubElement(root, "Collection")
    for row in rows.tolist():
        file = f"{trajectory.step[row]:08d}.vtp"
        _write(frame(row), folder / file)
        at = {"timestep": repr(float(trajectory.t[row])), "part": "0", "file": f"{name}/{file}"}
        ElementTree.SubElement(collection, "DataSet", at)
    with new_file(target / f"{name}.pvd") as new:
        ElementTree.indent(root)
        ElementTree.ElementTree(root).write(new.part, encoding="utf-8", xml_declaration=True)
    return new.target


def _write(data: vtkPolyData, path: Path) -> None:
    from vtkmodules.vtkCommonMisc import vtkErrorCode
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

    writer = vtkXMLPolyDataWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(data)
    writer.EncodeAppendedDataOff()
    if not writer.Write():
        reason = vtkErrorCode.GetStringFromErrorCode(writer.GetErrorCode())
        raise unwritable(path, OSError(0, reason))


def _poly_data(points: FloatArray) -> vtkPolyData:
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkPolyData

    placed = vtkPoints()
    placed.SetData(_array(points))
    data = vtkPolyData()
    data.SetPoints(placed)
    return data


def _cells(cells: Sequence[IntArray]) -> vtkCellArray:
    """Cells (cells, points of each) of the same number of points."""
    from vtkmodules.vtkCommonDataModel import vtkCellArray

    points = np.vstack(cells)
    array = vtkCellArray()
    array.SetData(points.shape[1], _array(points.ravel().astype(np.int64)))
    return array


def _strings(name: str, texts: Sequence[str]) -> vtkStringArray:
    from vtkmodules.vtkCommonCore import vtkStringArray

    array = vtkStringArray()
    array.SetName(name)
    for text in texts:
        array.InsertNextValue(text)
    return array


def _put(data: Any, arrays: dict[str, Any]) -> None:
    """Arrays into the data of points or cells."""
    for name, values in arrays.items():
        array = _array(values)
        array.SetName(name)
        data.AddArray(array)


def _array(values: Any) -> vtkDataArray:
    from vtkmodules.util.numpy_support import numpy_to_vtk

    copied: vtkDataArray = numpy_to_vtk(np.ascontiguousarray(values), deep=True)  # type: ignore[no-untyped-call]
    return copied


def _require_vtk() -> None:
    try:
        import vtkmodules.vtkIOXML  # noqa: F401
    except ImportError as error:
        raise ImportError(
            f"files for ParaView need the package vtk: pip install 'saltus[vtk]' ({error})"
        ) from error
