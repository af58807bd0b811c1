"""Runs of first-order models as numpy arrays, in HDF5 files and as CSV.

An HDF5 file has the attributes `saltus_first_order` = 1, `layout` and `provenance` (JSON), and a dataset for
each column, (rows, ...).
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py

from saltus import notebook
from saltus.io.files import new_file
from saltus.io.records import Loaded, Provenance, Rows

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from saltus.typing import AxesArray, FloatArray, IntArray

FORMAT_VERSION = 1
COLUMNS = ("t", "step", "x", "r", "y", "lambda", "iterations", "residual")


@dataclass(frozen=True)
class FirstOrderRecord:
    """What happened in one interaction, each array (rows of the run, entries)."""

    name: str
    y: FloatArray
    lambda_: FloatArray


@dataclass(frozen=True)
class FirstOrderLayout:
    """How many states each system has, and of each interaction its name and its entries of y."""

    systems: tuple[int, ...]
    interactions: tuple[tuple[str, int], ...]

    def entries(self, name: str) -> slice:
        """Those of an interaction among all of y. Raises KeyError if there is none of that name."""
        at = 0
        for other, size in self.interactions:
            if other == name:
                return slice(at, at + size)
            at += size
        known = ", ".join(other for other, _ in self.interactions) or "none"
        raise KeyError(f"no interaction named {name!r}, there are {known}")

    def labels(self) -> list[str]:
        """First line of a table."""
        states = range(sum(self.systems))
        each = [(name, k) for name, size in self.interactions for k in range(size)]
        return [
            "t [s]",
            "step [1]",
            *(f"x{k}" for k in states),
            *(f"r{k}" for k in states),
            *(f"{name}.y{k}" for name, k in each),
            *(f"{name}.lambda{k}" for name, k in each),
            "iterations [1]",
            "residual [1]",
        ]


class FirstOrderTrajectory:
    """A run of a first-order model: row 0 is the initial state with λ = 0, row k the step that ends at t[k].

    ``trajectory["diodes"]`` has y and λ of the interaction of that name. While a simulation goes on, its
    trajectory grows with it.
    """

    def __init__(self, source: Rows, layout: FirstOrderLayout, provenance: Provenance) -> None:
        self._source = source
        self._columns: Mapping[str, Any] = {}
        self._rows = -1  # of these columns
        self.layout = layout
        self.provenance = provenance

    def columns(self) -> Mapping[str, Any]:
        """All columns, name: array with one entry or row for each row of the run."""
        if self._rows != self._source.rows:
            self._columns, self._rows = self._source.columns(), self._source.rows
        return self._columns

    def __len__(self) -> int:
        return self._source.rows

    def __getitem__(self, name: str) -> FirstOrderRecord:
        entries = self.layout.entries(name)
        return FirstOrderRecord(name, self.y[:, entries], self.lambda_[:, entries])

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
    def x(self) -> FloatArray:
        """States (rows, n) of all systems, one after the other."""
        return self._float("x")

    @property
    def r(self) -> FloatArray:
        """Inputs (rows, n) by the relations."""
        return self._float("r")

    @property
    def y(self) -> FloatArray:
        """Outputs (rows, entries) of all relations, one after the other."""
        return self._float("y")

    @property
    def lambda_(self) -> FloatArray:
        """Multipliers (rows, entries)."""
        return self._float("lambda")

    @property
    def iterations(self) -> IntArray:
        """Of Newton's method in each step (rows,)."""
        column: IntArray = self.columns()["iterations"]
        return column

    @property
    def residual(self) -> FloatArray:
        """Of the motion and the laws, relative to the terms that cancel (rows,)."""
        return self._float("residual")

    def plot(self, axes: Axes | Sequence[Axes] | AxesArray | None = None) -> AxesArray:
        """Draw states, outputs and multipliers over time.

        Parameters
        ----------
        axes : one for each of the three panels, or one of a run without interactions; without it a figure
            is made

        Returns
        -------
        (panels,) of Axes
            Those drawn into, ``axes[0].figure`` is the figure.

        Raises
        ------
        ValueError
            If there are more or fewer axes than panels.
        """
        from saltus.plot import plot_first_order

        return plot_first_order(self, axes)

    def report(
        self, path: str | os.PathLike[str], *, title: str | None = None, caption: str | None = None
    ) -> Path:
        """Write a page for the browser, plots with zoom, as `Trajectory.report` does.

        Parameters
        ----------
        path : of the page, one HTML file that needs no network; an existing one is replaced as a whole
        title : its heading; the integrator's name if it is left out
        caption : what there is to see

        Raises
        ------
        ValueError
            If the run has no rows.
        OSError
            If the file cannot be written; what was there is untouched.
        """
        from saltus.report import write_report

        return write_report(self, path, title, caption)

    def to_hdf5(self, path: str | os.PathLike[str]) -> Path:
        """Write all columns; an existing file is replaced as a whole.

        Raises OSError if it cannot be written.
        """
        with new_file(path) as new, h5py.File(new.part, "w") as file:
            file.attrs["saltus_first_order"] = FORMAT_VERSION
            file.attrs["layout"] = json.dumps(asdict(self.layout))
            file.attrs["provenance"] = json.dumps(asdict(self.provenance))
            for name in COLUMNS:
                file.create_dataset(name, data=self.columns()[name])
        return new.target

    def to_csv(self, path: str | os.PathLike[str]) -> Path:
        """Write all columns as text (RFC 4180), an existing file is replaced as a whole.

        Names are ``t [s],step [1],x0,...,r0,...,diodes.y0,...,diodes.lambda0,...``. Numbers read back are the
        same to the last bit. Raises OSError if it cannot be written.
        """
        columns = [self.columns()[name] for name in COLUMNS]
        with new_file(path) as new, open(new.part, "w", encoding="utf-8", newline="") as file:
            file.write(_line(_quoted(label) for label in self.layout.labels()))
            for row in zip(*(column.tolist() for column in columns), strict=True):
                values = chain.from_iterable(v if isinstance(v, list) else (v,) for v in row)
                file.write(_line(map(repr, values)))
        return new.target

    def __repr__(self) -> str:
        span = f"t = {self.t[0]:g} ... {self.t[-1]:g} s" if len(self) else "empty"
        return f"<FirstOrderTrajectory {self.provenance.integrator}: {len(self)} rows, {span}>"

    def _repr_html_(self) -> str:
        return notebook.first_order_run(self)

    def _float(self, name: str) -> FloatArray:
        column: FloatArray = self.columns()[name]
        return column


def read_first_order(path: str | os.PathLike[str]) -> FirstOrderTrajectory:
    """Read what `FirstOrderTrajectory.to_hdf5` wrote. Nothing in the file is executed.

    Raises
    ------
    OSError
        If the file cannot be read or is not an HDF5 file.
    ValueError
        If it holds something else.
    """
    try:
        file = h5py.File(path, "r")
    except OSError as error:
        raise OSError(f"cannot read '{path}': expected an HDF5 file ({error})") from error
    with file:
        if file.attrs.get("saltus_first_order") != FORMAT_VERSION:
            raise ValueError(
                f"'{path}' must be a first-order run of format {FORMAT_VERSION}, "
                f"got 'saltus_first_order' = {file.attrs.get('saltus_first_order')}"
            )
        try:
            layout = json.loads(file.attrs["layout"])
            interactions = tuple((str(name), int(size)) for name, size in layout["interactions"])
            columns = {name: file[name][()] for name in COLUMNS}
            return FirstOrderTrajectory(
                Loaded(len(columns["t"]), columns),
                FirstOrderLayout(tuple(layout["systems"]), interactions),
                Provenance(**json.loads(file.attrs["provenance"])),
            )
        except (KeyError, TypeError, ValueError) as error:
            raise ValueError(
                f"'{path}' must be a complete first-order run, got one with: {error!r}"
            ) from error


def _line(fields: Iterable[str]) -> str:
    return ",".join(fields) + "\r\n"


def _quoted(label: str) -> str:
    return '"' + label.replace('"', '""') + '"' if any(c in label for c in ',"\r\n') else label
