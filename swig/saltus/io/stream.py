"""Runs that are written to a file while they go on."""

from __future__ import annotations

import contextlib
import os
import weakref
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

from saltus._core import Recording
from saltus.io.hdf5 import RunFile, chunk_rows, read_rows
from saltus.io.records import UNITS, Layout, Provenance

if TYPE_CHECKING:
    from saltus.io.records import Scene
    from saltus.scene import Appearance

SECONDS = 1.0  #: at most between two chunks: what a killed process loses


class Stream:
    """A recording whose rows go to a file, in chunks of 4 MiB or of a second, and leave the memory then.

    Parameters
    ----------
    path : of the file, which a run of Saltus there makes room for
    recording : with the first row
    layout, provenance, look : of the run
    checkpoint : called for that of the simulation, with the number of rows that are then in the file
    before : file with rows that come first, and how many of them

    Raises
    ------
    OSError
        If the file cannot be written, FileExistsError if there is another file than a run.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        recording: Recording,
        layout: Layout,
        provenance: Provenance,
        look: Appearance,
        checkpoint: Callable[[int], bytes],
        before: tuple[str | os.PathLike[str], int] | None = None,
    ) -> None:
        earlier = read_rows(*before) if before else iter(())
        first = next(iter(read_rows(before[0], 1)))[1] if before else recording.columns()
        scene = look.scene(first["t"], first["q"])
        if before:
            _require_same_look(before[0], scene)
        chunk = chunk_rows(first)
        file = RunFile(path, layout, provenance, first, scene, chunk)
        offset = self._before = before[1] if before else 0

        def write(start: int, columns: Mapping[str, Any]) -> None:  # without self: it would never die
            at = offset + start
            scene = look.scene(columns["t"], columns["q"])
            file.write(at, columns, scene, checkpoint(at + len(columns["t"])))

        try:
            for at, columns, scene in earlier:
                file.write(at, columns, scene, checkpoint(offset))
            recording.stream(write, chunk, SECONDS)
            recording.flush()
            file.publish()
        except BaseException:
            file.discard()
            raise
        self._recording, self._file = recording, file
        # the rows of steps taken one by one are complete when the simulation, or the program, is
        weakref.finalize(self, _finish, recording, file)

    @property
    def rows(self) -> int:
        """Those in the file, and those still in memory."""
        return self._before + self._recording.handed_on + self._recording.rows

    def columns(self) -> Mapping[str, Any]:
        """All columns; each is read from the file when it is asked for."""
        self._recording.flush()
        return FileColumns(self._file, self.rows)

    def close(self) -> None:
        """Write what is left and close the file; a further step opens it again."""
        _finish(self._recording, self._file)


class FileColumns(Mapping[str, Any]):
    """Columns in a file."""

    def __init__(self, file: RunFile, rows: int) -> None:
        self._file, self._rows = file, rows

    def __getitem__(self, name: str) -> Any:
        if name not in UNITS:
            raise KeyError(name)
        return self._file.read(name, self._rows)

    def __iter__(self) -> Iterator[str]:
        return iter(UNITS)

    def __len__(self) -> int:
        return len(UNITS)


def _require_same_look(path: str | os.PathLike[str], scene: Scene) -> None:
    """Raise ValueError unless the run in a file has the shapes and places of this scene."""
    _, _, its = next(iter(read_rows(path, 1)))
    found, here = (
        [(shape.system, shape.kind, shape.poses.shape[1:]) for shape in each.shapes]
        + [(place.contact, place.directions.shape[1:]) for place in each.places]
        for each in (its, scene)
    )
    if found != here:
        raise ValueError(
            f"the run in '{path}' goes on only with its own shapes and places of contacts, "
            f"{len(its.shapes)} and {len(its.places)}, got {len(scene.shapes)} and {len(scene.places)} "
            f"or others"
        )


def _finish(recording: Recording, file: RunFile) -> None:
    if file.failed:  # that was said already, and would fail again
        with contextlib.suppress(OSError):
            file.close()
        return
    try:
        recording.flush()
    finally:
        file.close()
