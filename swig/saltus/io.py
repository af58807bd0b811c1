"""Results: a run as numpy arrays, in memory and in HDF5 files."""

from __future__ import annotations

import errno
import json
import os
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from datetime import datetime, timezone
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from saltus._core import Recording, __version__

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from saltus.shapes import PlacedShape
    from saltus.typing import BoolArray, FloatArray, IntArray

FORMAT_VERSION = 1

UNITS = {
    "t": "s",
    "q": "m or rad",
    "v": "m/s or rad/s",
    "gap": "m",
    "velocity": "m/s",
    "lambda_plus": "N",
    "lambda_minus": "N",
    "impulse": "N s",
    "residual": "m/s",
    "penetration": "m",
    "kinetic_energy": "J",
    "potential_energy": "J",
    "work_forces": "J",
    "work_lambda": "J",
    "work_impulse": "J",
}
COLUMNS = (*UNITS, "step", "impulsive", "closed")
CONTACT_COLUMNS = ("gap", "velocity", "lambda_plus", "lambda_minus", "impulse")


@dataclass(frozen=True)
class ContactSlot:
    """Where a contact's rows and gaps stand among those of all contacts."""

    row: int
    rows: int
    gap: int
    gaps: int


@dataclass(frozen=True)
class Layout:
    """Names and places of the contacts, and the dimensions of the systems."""

    contacts: Mapping[str, ContactSlot]
    dimensions: tuple[int, ...]

    @staticmethod
    def of(contacts: Sequence[tuple[str, int, int, int, int]], dimensions: Sequence[int]) -> Layout:
        """From what the model lists: (name, row, rows, gap, gaps) of each contact."""
        return Layout({name: ContactSlot(*place) for name, *place in contacts}, tuple(dimensions))


@dataclass(frozen=True)
class Provenance:
    """How a run came about."""

    integrator: str
    time_step: float  #: [s]
    solver: str
    record_every: int
    version: str
    created: str

    @staticmethod
    def now(integrator: str, time_step: float, solver: str, record_every: int) -> Provenance:
        """With this version of Saltus and the present time."""
        created = datetime.now(timezone.utc).isoformat(timespec="seconds")
        return Provenance(integrator, time_step, solver, record_every, __version__, created)


@dataclass(frozen=True)
class ContactRecord:
    """What happened in one contact, each array (rows of the run, rows of the contact)."""

    name: str
    gap: FloatArray  #: g [m], of the normal row or of all rows of an equality
    velocity: FloatArray  #: γ = Wᵀ v⁺ [m/s]
    lambda_plus: FloatArray  #: λ⁺ at the start of the step [N]
    lambda_minus: FloatArray  #: λ⁻ at its end [N]
    impulse: FloatArray  #: Λ at its end [N s]

    @property
    def force(self) -> FloatArray:
        """Mean of λ⁺ and λ⁻ [N], of second order where each of them is of first."""
        return 0.5 * (self.lambda_plus + self.lambda_minus)


@dataclass(frozen=True)
class ShapeRecord:
    """A shape of a system and its pose in every row: x [m], y [m], angle [rad]."""

    system: int
    kind: str
    outline: FloatArray  #: (points, 2) [m] in the shape's frame
    poses: FloatArray  #: (rows, 3)


class Trajectory:
    """A run: row 0 is the initial state with zero reactions, row k the step that ends at t[k].

    ``trajectory["floor"]`` is the record of the contact of that name. While a simulation goes on, its
    trajectory grows with it.
    """

    def __init__(
        self,
        source: Recording | Mapping[str, Any],
        layout: Layout,
        provenance: Provenance,
        shapes: Sequence[PlacedShape | ShapeRecord] = (),
    ) -> None:
        self._source = source
        self._columns: Mapping[str, Any] = {} if isinstance(source, Recording) else source
        self._shapes = tuple(shapes)
        self.layout = layout
        self.provenance = provenance

    def columns(self) -> Mapping[str, Any]:
        """All columns, name: array with one entry or row for each row of the run."""
        if isinstance(self._source, Recording) and len(self._columns.get("t", ())) != self._source.rows:
            self._columns = self._source.columns()
        return self._columns

    def __len__(self) -> int:
        return len(self.t)

    def __getitem__(self, name: str) -> ContactRecord:
        try:
            slot = self.layout.contacts[name]
        except KeyError:
            known = ", ".join(self.layout.contacts) or "none"
            raise KeyError(f"no contact named {name!r}, there are {known}") from None
        columns = self.columns()
        rows = slice(slot.row, slot.row + slot.rows)
        gaps = slice(slot.gap, slot.gap + slot.gaps)
        parts = {key: columns[key][:, gaps if key == "gap" else rows] for key in CONTACT_COLUMNS}
        return ContactRecord(name, **parts)

    @property
    def contacts(self) -> tuple[str, ...]:
        """Names of the contacts."""
        return tuple(self.layout.contacts)

    @property
    def t(self) -> FloatArray:
        """Times (rows,) [s]."""
        return self._float("t")

    @property
    def step(self) -> IntArray:
        """Number of the step of each row (rows,)."""
        column: IntArray = self.columns()["step"]
        return column

    @property
    def q(self) -> FloatArray:
        """Positions (rows, n) of all systems, one after the other."""
        return self._float("q")

    @property
    def v(self) -> FloatArray:
        """Velocities v⁺ (rows, n)."""
        return self._float("v")

    @property
    def impulsive(self) -> BoolArray:
        """Was the impact law applied in the step, under Moreau-Jean: did an impulse act? (rows,)."""
        column: BoolArray = self.columns()["impulsive"]
        return column

    @property
    def closed(self) -> IntArray:
        """Number of closed contacts at the end of the step (rows,)."""
        column: IntArray = self.columns()["closed"]
        return column

    @property
    def residual(self) -> FloatArray:
        """Largest certificate of the step's contact problems (rows,) [m/s]."""
        return self._float("residual")

    @property
    def penetration(self) -> FloatArray:
        """Largest -g of the unilateral contacts, or 0 (rows,) [m]."""
        return self._float("penetration")

    @property
    def kinetic_energy(self) -> FloatArray:
        """½ vᵀMv (rows,) [J]."""
        return self._float("kinetic_energy")

    @property
    def potential_energy(self) -> FloatArray:
        """V (rows,) [J], NaN if a system does not define it."""
        return self._float("potential_energy")

    @property
    def energy(self) -> FloatArray:
        """Kinetic and potential energy together (rows,) [J]."""
        return self.kinetic_energy + self.potential_energy

    @property
    def work_forces(self) -> FloatArray:
        """Work of the applied forces in the step, of h and of the change of M (rows,) [J]."""
        return self._float("work_forces")

    @property
    def work_lambda(self) -> FloatArray:
        """Work of λ⁺ and λ⁻ in the step (rows,) [J]."""
        return self._float("work_lambda")

    @property
    def work_impulse(self) -> FloatArray:
        """Work of Λ in the step (rows,) [J], exactly the jump of the kinetic energy."""
        return self._float("work_impulse")

    @property
    def shapes(self) -> list[ShapeRecord]:
        """The systems' shapes with their poses in every row."""
        return [shape if isinstance(shape, ShapeRecord) else self._follow(shape) for shape in self._shapes]

    def plot(self) -> Figure:
        """Draw positions, gaps, forces, impulses and energy over time; impacts are marked."""
        from saltus.plot import plot_trajectory

        return plot_trajectory(self)

    def to_hdf5(self, path: str | os.PathLike[str]) -> Path:
        """Write all columns with units, shapes and provenance; an existing file is replaced as a whole.

        Raises
        ------
        OSError
            If the file cannot be written; one that was there is untouched.
        """
        return write_hdf5(self, path)

    def __repr__(self) -> str:
        count = len(self)
        span = f"t = {self.t[0]:g} ... {self.t[-1]:g} s" if count else "empty"
        return f"<Trajectory {self.provenance.integrator}: {count} rows, {span}>"

    def _float(self, name: str) -> FloatArray:
        column: FloatArray = self.columns()[name]
        return column

    def _follow(self, shape: PlacedShape) -> ShapeRecord:
        start = sum(self.layout.dimensions[: shape.system])
        q = self.q[:, start : start + self.layout.dimensions[shape.system]]
        kind = type(shape.shape).__name__
        return ShapeRecord(shape.system, kind, shape.shape.outline(), shape.poses(q))


def write_hdf5(trajectory: Trajectory, path: str | os.PathLike[str]) -> Path:
    """See `Trajectory.to_hdf5`."""
    target = Path(os.path.realpath(path))  # a link stays one: its target is replaced
    if target.exists() and not target.is_file():
        raise _unwritable(target, OSError(errno.EISDIR, "not a regular file"))
    try:
        descriptor, name = tempfile.mkstemp(dir=target.parent, prefix=target.name, suffix=".part")
        os.close(descriptor)
    except OSError as error:
        raise _unwritable(target, error) from error
    try:
        with h5py.File(name, "w") as file:
            _fill(file, trajectory)
        os.chmod(name, 0o666 & ~_umask())
        os.replace(name, target)
    except OSError as error:
        raise _unwritable(target, error) from error
    finally:
        Path(name).unlink(missing_ok=True)
    return target


def read_hdf5(path: str | os.PathLike[str]) -> Trajectory:
    """Read a run that `Trajectory.to_hdf5` wrote. Nothing in the file is executed.

    Raises
    ------
    OSError
        If the file cannot be read or is not an HDF5 file.
    ValueError
        If it holds something else than a run of Saltus, or one of a newer format.
    """
    try:
        file = h5py.File(path, "r")
    except OSError as error:
        raise OSError(f"cannot read '{path}': expected an HDF5 file ({error})") from error
    with file:
        version = file.attrs.get("saltus_format")
        if not isinstance(version, np.integer):
            raise ValueError(f"'{path}' must be a run of Saltus, got an HDF5 file without 'saltus_format'")
        if version > FORMAT_VERSION:
            raise ValueError(f"'{path}' has format {version}, this version reads up to {FORMAT_VERSION}")
        try:
            return _read(file)
        except (KeyError, TypeError, AttributeError, json.JSONDecodeError) as error:
            raise ValueError(f"'{path}' must be a complete run of Saltus, got one with: {error!r}") from error


def _read(file: h5py.File) -> Trajectory:
    layout = json.loads(file.attrs["layout"])
    contacts = {name: ContactSlot(**slot) for name, slot in layout["contacts"].items()}
    shapes = [
        ShapeRecord(
            int(group.attrs["system"]), str(group.attrs["kind"]), group["outline"][:], group["poses"][:]
        )
        for group in _groups(file["shapes"])
    ]
    return Trajectory(
        {name: file["columns"][name][:] for name in COLUMNS},
        Layout(contacts, tuple(layout["dimensions"])),
        Provenance(**json.loads(file.attrs["provenance"])),
        shapes,
    )


def _fill(file: h5py.File, trajectory: Trajectory) -> None:
    layout = trajectory.layout
    contacts = {name: asdict(slot) for name, slot in layout.contacts.items()}
    file.attrs["saltus_format"] = FORMAT_VERSION
    file.attrs["provenance"] = json.dumps(asdict(trajectory.provenance))
    file.attrs["layout"] = json.dumps({"contacts": contacts, "dimensions": layout.dimensions})
    columns = file.create_group("columns")
    for name in COLUMNS:
        dataset = columns.create_dataset(name, data=trajectory.columns()[name])
        if name in UNITS:
            dataset.attrs["unit"] = UNITS[name]
    shapes = file.create_group("shapes")
    for index, shape in enumerate(trajectory.shapes):
        group = shapes.create_group(f"{index:04d}")
        group.attrs["system"] = shape.system
        group.attrs["kind"] = shape.kind
        group.create_dataset("outline", data=shape.outline)
        group.create_dataset("poses", data=shape.poses)


def _groups(parent: h5py.Group) -> Iterator[h5py.Group]:
    for name in sorted(parent):
        yield parent[name]


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def _unwritable(target: Path, error: OSError) -> OSError:
    reason = error.strerror or str(error)
    return OSError(
        error.errno or 0,
        f"cannot write '{target}': expected a writable file in an existing folder, got: {reason}",
    )


__all__ = ["ContactRecord", "Layout", "Provenance", "ShapeRecord", "Trajectory", "read_hdf5", "write_hdf5"]
