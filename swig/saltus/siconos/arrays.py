"""Vectors and matrices as scripts make them: SiconosVector and SimpleMatrix."""

from __future__ import annotations

import os
from numbers import Integral
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NoReturn

import numpy as np
from scipy import sparse

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, DTypeLike

    from saltus.typing import FloatArray

DENSE, SPARSE = 1, 4  # storages of a SimpleMatrix


class NotThere(NotImplementedError, AttributeError):
    """A name of Siconos that has no counterpart here."""


class Named:
    """Says what is there when a script asks for another method."""

    hints: ClassVar[dict[str, str]] = {}  #: methods that are taken and change nothing, and why

    def __getattr__(self, name: str) -> Any:
        cls = type(self)
        if name in cls.hints:
            return lambda *_: None
        if name.startswith("_"):
            raise AttributeError(f"'{cls.__name__}' object has no attribute '{name}'")
        there = sorted(key for key in {*dir(cls), *cls.hints} if not key.startswith("_") and key != "hints")
        raise NotThere(f"{cls.__name__}.{name} is not there, there are {', '.join(there)}")


class _Methods:
    def __init__(self, instance: Named) -> None:
        self._instance = instance

    def __getattr__(self, name: str) -> Any:
        return getattr(type(self._instance), name).__get__(self._instance)


def methods(instance: Named) -> Any:
    """Methods of an object by its class: a script may keep attributes of the same names, as `self.mass`."""
    return _Methods(instance)


def refuse_plugins(*values: object) -> None:
    """Raises NotThere if one of the values is a text: "Plugin:function"."""
    for value in values:
        if isinstance(value, str):
            raise NotThere(f"expected numbers here, plugins are for setCompute...Function, got '{value}'")


def refuse_late(taken: bool, what: str) -> None:
    """Raises NotThere if a simulation has taken as a constant what is about to be set."""
    if taken:
        raise NotThere(f"{what} is constant once the simulation is made, its first step does that")


def to_vector(values: ArrayLike, what: str) -> FloatArray:
    """(n,) of float64; memory is shared with an array that is one already. Raises ValueError."""
    refuse_plugins(values)
    vector = np.asarray(values, dtype=float)
    if vector.ndim != 1:
        raise ValueError(f"{what} must have one axis, got shape {vector.shape}")
    return vector


def to_matrix(values: Any, what: str) -> Any:
    """(rows, columns), an array of float64 or of scipy.sparse, memory shared likewise. Raises ValueError."""
    refuse_plugins(values)
    if isinstance(values, SimpleMatrix):
        return values.matrix
    if is_sparse(values):
        return values
    matrix = np.asarray(values, dtype=float)
    if matrix.ndim != 2:
        raise ValueError(f"{what} must have two axes, got shape {matrix.shape}")
    return matrix


def to_dense(matrix: Any) -> FloatArray:
    """The matrix as an array, itself if it is one."""
    dense: FloatArray = matrix.toarray() if is_sparse(matrix) else matrix
    return dense


def is_sparse(matrix: Any) -> bool:
    """Say whether it is one of scipy.sparse."""
    return bool(sparse.issparse(matrix))


class SiconosVector(Named):
    """A vector, from its length, from numbers, or from a file that has its length and the numbers.

    Raises ValueError if a file says otherwise, or the numbers have more than one axis.
    """

    def __init__(self, values: ArrayLike, fill: float = 0.0) -> None:
        if isinstance(values, Integral):
            self.vector: FloatArray = np.full(int(values), float(fill))
        elif isinstance(values, str | os.PathLike):
            head, numbers = _read(values, 1)
            self.vector = numbers.reshape(head)
        else:
            self.vector = to_vector(values, "a vector").copy()

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> FloatArray:
        return _as_array(self.vector, dtype, copy)

    def __len__(self) -> int:
        return len(self.vector)

    def __getitem__(self, index: Any) -> Any:
        return self.vector[index]

    def __setitem__(self, index: Any, value: Any) -> None:
        self.vector[index] = value

    def __repr__(self) -> str:
        return f"SiconosVector({self.vector.tolist()})"

    def __str__(self) -> str:
        return f"[{len(self)}]({','.join(f'{x:g}' for x in self.vector)})"

    def getValue(self, i: int) -> float:
        return float(self.vector[i])

    def setValue(self, i: int, value: float) -> None:
        self.vector[i] = value

    def size(self) -> int:
        return len(self.vector)

    def zero(self) -> None:
        self.vector[:] = 0.0

    def fill(self, value: float) -> None:
        self.vector[:] = value

    def norm2(self) -> float:
        return float(np.linalg.norm(self.vector))

    def normInf(self) -> float:
        return float(np.abs(self.vector).max(initial=0.0))

    def display(self) -> None:
        print(self.vector)


class SimpleMatrix(Named):
    """A matrix, from its numbers of rows and columns, from numbers, or from a file that has all of these.

    With the storage SPARSE only entries that are set take memory, and a system made of it stays sparse; nnz,
    how many are expected, is not asked.

    Raises ValueError if a file says otherwise, or the numbers do not have two axes.
    """

    def __init__(self, rows: Any, columns: int | None = None, storage: int = DENSE, nnz: int = 0) -> None:
        if columns is not None:
            if storage not in (DENSE, SPARSE):
                raise NotThere(f"storages of a SimpleMatrix are DENSE (1) and SPARSE (4), got {storage}")
            shape = (int(rows), int(columns))
            self.matrix: Any = sparse.lil_array(shape) if storage == SPARSE else np.zeros(shape)
        elif isinstance(rows, str | os.PathLike):
            head, numbers = _read(rows, 2)
            self.matrix = numbers.reshape(head)
        else:
            self.matrix = to_matrix(rows, "a matrix").copy()

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> FloatArray:
        return _as_array(to_dense(self.matrix), dtype, copy)

    def __getitem__(self, index: Any) -> Any:
        return self.matrix[index]

    def __setitem__(self, index: Any, value: Any) -> None:
        self.matrix[index] = value

    def __repr__(self) -> str:
        return f"SimpleMatrix({np.asarray(self).tolist()})"

    def getValue(self, i: int, j: int) -> float:
        return float(self.matrix[i, j])

    def setValue(self, i: int, j: int, value: float) -> None:
        self.matrix[i, j] = value

    def size(self, axis: int) -> int:
        return int(self.matrix.shape[axis])

    def zero(self) -> None:
        self.matrix[:] = 0.0

    def eye(self) -> None:
        self.zero()
        self.matrix.setdiag(1.0) if is_sparse(self.matrix) else np.fill_diagonal(self.matrix, 1.0)

    def display(self) -> None:
        print(np.asarray(self))


def getMatrix(matrix: Any) -> FloatArray:
    """The numbers of a matrix, (rows, columns)."""
    return np.asarray(SimpleMatrix(matrix) if is_sparse(matrix) else matrix, dtype=float)


def getVector(vector: ArrayLike) -> FloatArray:
    """The numbers of a vector, (n,)."""
    return to_vector(vector, "a vector")


def compareRefFile(
    data: ArrayLike, filename: str, epsilon: float, index: Any = None, verbose: bool = True
) -> float:
    """The largest distance of numbers from those in a file, printed.

    Parameters
    ----------
    data : (rows, columns)
    filename : rows, columns and the rows, or the rows alone
    epsilon : what counts as equal
    index : the columns to compare, all if left out

    Raises
    ------
    ValueError
        If the file holds another number of rows or columns.
    """
    ours = np.asarray(data, dtype=float)
    lines = Path(filename).read_text(encoding="ascii", errors="replace").splitlines()
    theirs = np.loadtxt(lines[1:] if len(lines[0].split()) == 2 != ours.shape[1] else lines, ndmin=2)
    if theirs.shape != ours.shape:
        raise ValueError(f"{filename}: expected {ours.shape} numbers, got {theirs.shape}")
    columns = slice(None) if index is None else index
    error = float(np.abs(ours[:, columns] - theirs[:, columns]).max(initial=0.0))
    if verbose:
        print(
            f"{filename}: differs by {error:g}, {'more' if error > epsilon else 'not more'} than {epsilon:g}"
        )
    return error


def _as_array(values: FloatArray, dtype: DTypeLike | None, copy: bool | None) -> FloatArray:
    array = np.asarray(values, dtype=dtype)
    return array.copy() if copy else array


def _read(path: str | os.PathLike[str], axes: int) -> tuple[list[int], FloatArray]:
    """The lengths at the start of a file, and the numbers after them."""

    def fail(got: str) -> NoReturn:
        what = "rows, columns and the rows" if axes == 2 else "the length and the numbers"
        raise ValueError(f"{os.fspath(path)}: expected {what}, got {got}")

    words = Path(path).read_text(encoding="ascii", errors="replace").split()
    if len(words) < axes or not all(word.isdigit() for word in words[:axes]):
        fail(f"'{' '.join(words[:axes])}'")
    head = [int(word) for word in words[:axes]]
    try:
        numbers = np.array(words[axes:], dtype=float)
    except ValueError as error:
        fail(str(error))
    if numbers.size != np.prod(head):
        fail(f"{numbers.size} numbers for {' x '.join(map(str, head))}")
    return head, numbers
