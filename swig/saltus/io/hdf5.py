"""Runs in HDF5 files. There is one writer, for runs in memory and for those written while they go on.

Layout, format 4
----------------
| | |
|---|---|
| attribute `saltus_format` | 4 |
| attribute `layout` | JSON: coordinates of each system; rows, gaps and law of each contact |
| attribute `provenance` | JSON |
| `checkpoint/0`, `1` | bytes of `saltus.io.checkpoints`, written in turns; the latest complete one counts |
| `rows` | number of complete rows: what stands behind them in the datasets does not count |
| `columns/<name>` | (rows, ...) one dataset a column |
| `shapes/<number>/points`, `lines`, `faces` | of a shape, in its frame; attributes `system`, `kind` |
| `shapes/<number>/poses` | (rows, 3) x, y, angle, or (rows, 7) x, y, z and a quaternion (w, x, y, z) |
| `places/<number>/point`, `directions` | (rows, 3) and (rows, up to 3, 3) of a contact; attribute `contact` |

Every dataset has an attribute `unit`. Rows are appended in HDF5's single-writer mode (SWMR), in which the
file is consistent at any moment, and `rows` grows when a chunk is complete: a reader finds nothing
half-written, also if the writer was killed. HDF5 takes such a file for one that is being written; tools
other than `read_hdf5` open it with ``h5py.File(path, "r", swmr=True)``. Nothing in a file is executed.
"""

from __future__ import annotations

import errno
import json
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from saltus.io.checkpoints import latest
from saltus.io.files import NewFile, unwritable
from saltus.io.records import (
    UNITS,
    ContactLaw,
    ContactSlot,
    Layout,
    Loaded,
    PlaceRecord,
    Provenance,
    Rows,
    Scene,
    ShapeRecord,
)

if TYPE_CHECKING:
    from saltus.typing import FloatArray

FORMAT_VERSION = 4
LIBRARY = ("v110", "v110")  #: the oldest HDF5 that knows the single-writer mode can read the files
CHUNK_BYTES = 1 << 22  #: of the rows that are written at a time
OPEN_ELSEWHERE = ("already open", "flag values don't match")  #: HDF5's words, of others and of this process
BLOCK_ROWS = 1024  #: at most, of the pieces in which HDF5 stores a dataset


class RunFile:
    """A file that rows of a run are written to. It takes its place at `publish`.

    Parameters
    ----------
    path : where it is to be; what is there already must be a run of Saltus, or empty
    layout, provenance : of the run
    like, scene : rows like those to come, {name: array}, and what is seen in them
    chunk : rows that are written at a time

    Raises
    ------
    OSError
        If the file cannot be written, FileExistsError if what is there is something else than a run.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        layout: Layout,
        provenance: Provenance,
        like: Mapping[str, Any],
        scene: Scene,
        chunk: int,
    ) -> None:
        self._new = NewFile(path)
        self.target = self._new.target
        self.failed = False  #: the last attempt to write
        self._file: h5py.File | None = None
        self._slot = 0  # of the next checkpoint
        self._provenance = json.dumps(asdict(provenance))
        block = min(chunk, BLOCK_ROWS)
        self._spare = 2 * block * row_bytes(like) + (1 << 16)  # pieces that are begun, and their index
        try:
            _require_replaceable(self.target)
            with self._errors_named():
                self._file = h5py.File(self._new.part, "w", libver=LIBRARY)
                self._file.attrs["saltus_format"] = FORMAT_VERSION
                self._file.attrs["provenance"] = self._provenance
                self._file.attrs["layout"] = json.dumps(asdict(layout))
                _make_datasets(self._file, like, scene, block)
        except BaseException:
            self.discard()
            raise

    def write(self, start: int, columns: Mapping[str, Any], scene: Scene, checkpoint: bytes = b"") -> None:
        """Write rows from number `start` on, over what stands there, and then a checkpoint."""
        rows = start + len(columns["t"])
        with self._errors_named():
            moving = _moving(scene)
            self._require_space(sum(values.nbytes for values in (*columns.values(), *moving.values())))
            file = self._open()
            for name in UNITS:
                _put(file["columns"][name], start, rows, columns[name])
            for place, values in moving.items():
                _put(file[place], start, rows, values)
            file.flush()  # the rows are in the file before they count
            file["rows"][()] = rows
            file.flush()
            if checkpoint:
                slot = file["checkpoint"][str(self._slot)]
                _put(slot, 0, len(checkpoint), np.frombuffer(checkpoint, dtype=np.uint8))
                file.flush()
                self._slot = 1 - self._slot
        self.failed = False

    def read(self, name: str, rows: int) -> Any:
        """The first rows of a column. Raises OSError if another run has replaced this one."""
        if self._file is not None:
            return self._file["columns"][name][:rows]
        with open_run(self.target) as file:
            self._require_own(file)
            return file["columns"][name][:rows]

    def publish(self) -> None:
        """Put the file in its place, where it may go on growing."""
        with self._errors_named():
            self._new.publish()

    def close(self) -> None:
        """Close the file; writing opens it again."""
        file, self._file = self._file, None
        if file is not None:
            with self._errors_named():
                file.close()

    def discard(self) -> None:
        """Close the file, and remove it if it is not in its place."""
        try:
            self.close()
        finally:
            self._new.discard()

    def _open(self) -> h5py.File:
        if self._file is None:
            with open_run(self.target) as file:
                self._require_own(file)
            self._file = h5py.File(self.target, "r+", libver=LIBRARY)
        if not self._file.swmr_mode:
            self._file.swmr_mode = True
        return self._file

    def _require_space(self, size: int) -> None:
        """A full disk is refused beforehand: HDF5 does not recover from a write that failed halfway."""
        disk = os.statvfs(self.target.parent)
        if disk.f_bavail * disk.f_frsize < size + self._spare:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def _require_own(self, file: h5py.File) -> None:
        if file.attrs["provenance"] != self._provenance:
            raise OSError(f"'{self.target}' must hold this run, got another one that has replaced it")

    @contextmanager
    def _errors_named(self) -> Iterator[None]:
        try:
            yield
        except (OSError, RuntimeError) as error:  # HDF5 has both
            self.failed = True
            raise unwritable(self.target, error) from error


def write_run(
    path: str | os.PathLike[str],
    source: Rows,
    layout: Layout,
    provenance: Provenance,
    scene: Scene,
    checkpoint: bytes = b"",
) -> Path:
    """Write a run that is at hand, and return where it is. Errors as `RunFile`."""
    columns, rows = dict(source.columns()), source.rows
    file = RunFile(path, layout, provenance, columns, scene, min(chunk_rows(columns), max(rows, 1)))
    try:
        file.write(0, columns, scene, checkpoint)
        file.close()
        file.publish()
    finally:
        file.discard()
    return file.target


def chunk_rows(columns: Mapping[str, Any]) -> int:
    """How many rows like these are written at a time."""
    return max(CHUNK_BYTES // row_bytes(columns), 1)


def row_bytes(columns: Mapping[str, Any]) -> int:
    """Size of a row like these."""
    return sum(int(values.dtype.itemsize) * prod(values.shape[1:]) for values in columns.values())


@contextmanager
def open_run(path: str | os.PathLike[str]) -> Iterator[h5py.File]:
    """Open a run for reading, also while it is written and after its writer was killed.

    Raises
    ------
    OSError
        If the file cannot be read or is not an HDF5 file.
    ValueError
        If it holds something else than a run of Saltus, or one of another format.
    """
    try:
        file = _open_for_reading(path)
    except OSError as error:
        raise OSError(f"cannot read '{path}': expected an HDF5 file ({error})") from error
    with file:
        version = file.attrs.get("saltus_format")
        if not isinstance(version, np.integer):
            raise ValueError(f"'{path}' must be a run of Saltus, got an HDF5 file without 'saltus_format'")
        if version != FORMAT_VERSION:
            raise ValueError(f"'{path}' has format {version}, this version reads {FORMAT_VERSION}")
        yield file


def _open_for_reading(path: str | os.PathLike[str]) -> h5py.File:
    """As a file that is written only if it is one: there HDF5 waits without end for damage to go away."""
    try:
        return h5py.File(path, "r", locking=False)
    except OSError as error:
        if not any(sign in str(error) for sign in OPEN_ELSEWHERE):
            raise
        return h5py.File(path, "r", swmr=True)


def read_run(path: str | os.PathLike[str]) -> tuple[Loaded, Layout, Provenance, Scene]:
    """All that a file holds. Errors as `open_run`."""
    with open_run(path) as file:
        try:
            rows = int(file["rows"][()])
            layout = json.loads(file.attrs["layout"])
            contacts = {
                name: ContactSlot(**{**slot, "law": ContactLaw(**slot["law"])})
                for name, slot in layout["contacts"].items()
            }
            shapes, places = file["shapes"], file["places"]
            return (
                Loaded(rows, {name: file["columns"][name][:rows] for name in UNITS}),
                Layout(contacts, tuple(layout["coordinates"])),
                Provenance(**json.loads(file.attrs["provenance"])),
                Scene(
                    tuple(_read_shape(shapes[name], slice(rows)) for name in sorted(shapes)),
                    tuple(_read_place(places[name], slice(rows)) for name in sorted(places)),
                ),
            )
        except (KeyError, TypeError, AttributeError, json.JSONDecodeError) as error:
            raise ValueError(f"'{path}' must be a complete run of Saltus, got one with: {error!r}") from error


def read_checkpoint(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Where the run in a file can go on. Errors as `open_run`, ValueError also if there is no such place."""
    with open_run(path) as file:
        slots = [bytes(file["checkpoint"][name][:]) for name in ("0", "1")] if "checkpoint" in file else []
        found = latest(slots, int(file["rows"][()]))
    if found is None:
        raise ValueError(
            f"the run in '{path}' cannot go on: it must be written by a simulation, got no checkpoint"
        )
    return found


def read_rows(path: str | os.PathLike[str], rows: int) -> Iterator[tuple[int, dict[str, Any], Scene]]:
    """The first rows of a file in pieces: number of the first, columns, scene. Errors as `open_run`."""
    with open_run(path) as file:
        size = chunk_rows({name: file["columns"][name][:1] for name in UNITS})
        for start in range(0, rows, size):
            part = slice(start, min(start + size, rows))
            scene = Scene(
                tuple(_read_shape(group, part) for _, group in sorted(file["shapes"].items())),
                tuple(_read_place(group, part) for _, group in sorted(file["places"].items())),
            )
            yield start, {name: file["columns"][name][part] for name in UNITS}, scene


def _read_shape(group: h5py.Group, rows: slice) -> ShapeRecord:
    system, kind = int(group.attrs["system"]), str(group.attrs["kind"])
    return ShapeRecord(
        system, kind, group["points"][:], group["lines"][:], group["faces"][:], group["poses"][rows]
    )


def _read_place(group: h5py.Group, rows: slice) -> PlaceRecord:
    return PlaceRecord(str(group.attrs["contact"]), group["point"][rows], group["directions"][rows])


def _make_datasets(file: h5py.File, like: Mapping[str, Any], scene: Scene, block: int) -> None:
    file.create_dataset("rows", data=np.int64(0)).attrs["unit"] = "1"
    columns = file.create_group("columns")
    for name, unit in UNITS.items():
        _make_growing(columns, name, like[name], unit, block)
    for slot in ("0", "1"):
        _make_growing(file.require_group("checkpoint"), slot, np.empty(0, dtype=np.uint8), "1", 1 << 12)
    file.create_group("places")
    file.create_group("shapes")
    for number, shape in enumerate(scene.shapes):
        group = file.create_group(_numbered("shapes", number))
        group.attrs["system"] = shape.system
        group.attrs["kind"] = shape.kind
        for name, values, unit in (
            ("points", shape.points, "m"),
            ("lines", shape.lines, "1"),
            ("faces", shape.faces, "1"),
        ):
            group.create_dataset(name, data=values).attrs["unit"] = unit
        _make_growing(
            group,
            "poses",
            shape.poses,
            "m, m, rad" if shape.poses.shape[1] == 3 else "m, m, m, 1, 1, 1, 1",
            block,
        )
    for number, place in enumerate(scene.places):
        group = file.create_group(_numbered("places", number))
        group.attrs["contact"] = place.contact
        _make_growing(group, "point", place.point, "m", block)
        _make_growing(group, "directions", place.directions, "1", block)


def _moving(scene: Scene) -> dict[str, FloatArray]:
    """What has rows, by its name in the file."""
    values = {
        f"{_numbered('shapes', number)}/poses": shape.poses for number, shape in enumerate(scene.shapes)
    }
    for number, place in enumerate(scene.places):
        values[f"{_numbered('places', number)}/point"] = place.point
        values[f"{_numbered('places', number)}/directions"] = place.directions
    return values


def _make_growing(group: h5py.Group, name: str, like: FloatArray, unit: str, block: int) -> None:
    """An empty dataset for rows like these."""
    width = like.shape[1:]
    room = tuple(max(size, 1) for size in width)  # HDF5 knows no pieces of width 0
    dataset = group.create_dataset(
        name, shape=(0, *width), maxshape=(None, *room), chunks=(block, *room), dtype=like.dtype
    )
    dataset.attrs["unit"] = unit


def _put(dataset: h5py.Dataset, start: int, end: int, values: FloatArray) -> None:
    dataset.resize(end, axis=0)
    dataset[start:end] = values


def _numbered(group: str, number: int) -> str:
    return f"{group}/{number:06d}"


def _require_replaceable(target: Path) -> None:
    """Only runs are replaced, and empty files: a wrong path must not cost what is there."""
    if not target.exists() or target.stat().st_size == 0:
        return
    try:
        with h5py.File(target, "r", swmr=True) as file:
            if "saltus_format" in file.attrs:
                return
    except OSError:
        pass
    raise FileExistsError(
        f"cannot write '{target}': expected a new file or a run to replace, got another file"
    )
