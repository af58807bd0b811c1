"""FCLib's HDF5 files: local problems of Coulomb friction, u = W r + V l + q, Vᵀ r + R l + s = 0.

Acary, Brémond, Koziara, Pérignon: FCLIB, a collection of discrete 3D frictional contact problems, RT-444.
Group `fclib_local`: `spacedim`; matrices `W`, and `V`, `R` if there are equalities, each with m, n, nz,
nzmax, p, i, x (nz >= 0: triplets, -1: by columns, -2: by rows); `vectors` with q, mu, s; `info` with texts.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np
from scipy import sparse

from saltus.numerics.problems import FrictionProblem, Problem

if TYPE_CHECKING:
    from saltus.typing import FloatArray

TRIPLETS, BY_COLUMNS, BY_ROWS = 0, -1, -2
COMPRESSION = 2000  #: the most that a byte of a file can stand for; a dataset without content claims more
SYMMETRY = 1e-12  #: relative difference of W's coupling blocks that still is V and Vᵀ


def read(path: str | os.PathLike[str]) -> FrictionProblem:
    """Read a local problem. Raises ValueError if the file is malformed, OSError if it cannot be read."""
    try:
        file = h5py.File(path, "r")
    except (OSError, RuntimeError) as error:  # HDF5 has both
        raise OSError(f"cannot read '{os.fspath(path)}': {error}") from error
    with file:
        try:
            return _read(file.get("fclib_local"), Path(path).stat().st_size)
        except (ValueError, KeyError, TypeError, OSError, RuntimeError) as error:
            raise ValueError(f"{os.fspath(path)}: {error}") from error


def _read(group: Any, bytes_of_file: int) -> FrictionProblem:
    if not isinstance(group, h5py.Group):
        raise ValueError("expected a group 'fclib_local', there is none")
    reader = _Reader(group, bytes_of_file)
    dim = reader.integer("spacedim")
    q, mu = reader.array("vectors/q"), reader.array("vectors/mu")
    W = reader.matrix("W", q.size, q.size)
    if "V" not in group:
        return FrictionProblem(W, q, mu, dim)
    s = reader.array("vectors/s")
    V, R = reader.matrix("V", q.size, s.size), reader.matrix("R", s.size, s.size)
    blocks: Any = [[W, V], [V.T, R]]
    whole = sparse.csr_array(sparse.block_array(blocks))
    return FrictionProblem(whole, np.concatenate([q, s]), mu, dim, n_equalities=s.size)


class _Reader:
    def __init__(self, group: h5py.Group, bytes_of_file: int) -> None:
        self._group = group
        self._most = COMPRESSION * bytes_of_file

    def array(self, name: str, kind: str = "f", size: int | None = None) -> FloatArray:
        dataset = self._group.get(name)
        if not isinstance(dataset, h5py.Dataset):
            raise ValueError(f"expected a dataset '{name}', there is none")
        if dataset.dtype.kind not in "iu" + kind or dataset.shape is None:
            raise ValueError(f"'{name}' must hold numbers, got {dataset.dtype}")
        if dataset.nbytes > self._most:  # before it is allocated
            raise ValueError(f"'{name}' claims {dataset.nbytes} bytes, more than the file can hold")
        if size is not None and dataset.size < size:
            raise ValueError(f"'{name}' must have {size} entries, got {dataset.size}")
        values = np.asarray(dataset[()]).reshape(-1)
        return values if size is None else values[:size]

    def integer(self, name: str) -> int:
        return int(self.array(name, "i", 1)[0])

    def matrix(self, name: str, rows: int, columns: int) -> sparse.csr_array:
        m, n, nz = (self.integer(f"{name}/{size}") for size in ("m", "n", "nz"))
        if (m, n) != (rows, columns):  # of the vectors, whose content is there
            raise ValueError(f"'{name}' must be ({rows}, {columns}) as the vectors are, got ({m}, {n})")
        if nz < BY_ROWS:
            raise ValueError(f"'{name}' must have nz >= -2, got {nz}")
        if nz >= TRIPLETS:
            i, j = (self.array(f"{name}/{index}", "i", nz) for index in "ip")
            self._check(name, i, m)
            self._check(name, j, n)
            x = self.array(f"{name}/x", "f", nz)
            return sparse.csr_array(sparse.coo_array((x, (i, j)), shape=(m, n)))
        lines, width = (n, m) if nz == BY_COLUMNS else (m, n)
        p = self.array(f"{name}/p", "i", lines + 1)
        if p[0] != 0 or (p[1:] < p[:-1]).any():  # compared: differences may overflow
            raise ValueError(f"'{name}/p' must rise from 0")
        i = self.array(f"{name}/i", "i", int(p[-1]))
        self._check(name, i, width)
        kind: Any = sparse.csc_array if nz == BY_COLUMNS else sparse.csr_array
        return sparse.csr_array(kind((self.array(f"{name}/x", "f", int(p[-1])), i, p), shape=(m, n)))

    def _check(self, name: str, index: FloatArray, size: int) -> None:
        if index.size and not (index.min() >= 0 and index.max() < size):
            raise ValueError(f"the indices of '{name}' must be from 0 to {size - 1}")


def write(
    problem: Problem, path: str | os.PathLike[str], title: str = "Saltus", description: str = ""
) -> None:
    """Write a friction problem; what is there is replaced.

    FCLib knows equalities only with Vᵀ as the transpose of V. Where the coupling is not symmetric, they are
    eliminated: r stays the same, l is not in the file.

    Raises
    ------
    ValueError
        If it is no friction problem.
    OSError
        If the file cannot be written.
    """
    if not isinstance(problem, FrictionProblem):
        raise ValueError(f"FCLib holds friction problems, got {problem!r}; write it to .dat")
    rows = problem.dim * problem.contacts
    matrix = sparse.csr_array(problem.W)
    W, V, R = matrix[:rows, :rows], matrix[:rows, rows:], matrix[rows:, rows:]
    q, s = problem.q[:rows], problem.q[rows:]
    coupling = matrix[rows:, :rows]
    with h5py.File(path, "w") as file:
        group = file.create_group("fclib_local")
        group["spacedim"] = np.array([problem.dim], dtype=np.int32)
        if s.size and _largest(coupling - V.T) <= SYMMETRY * _largest(V):
            _write_matrix(group.create_group("V"), V)
            _write_matrix(group.create_group("R"), R)
            group["vectors/s"] = s
        elif s.size:
            W, q = _eliminate(W, V, coupling, R, q, s)
        _write_matrix(group.create_group("W"), W)
        group["vectors/q"] = q
        group["vectors/mu"] = problem.mu
        for name, text in {"title": title, "description": description, "math_info": ""}.items():
            group[f"info/{name}"] = np.bytes_((text or " ").encode())


def _largest(matrix: sparse.csr_array) -> float:
    return float(np.abs(matrix.data).max()) if matrix.nnz else 0.0


def _eliminate(
    W: sparse.csr_array,
    V: sparse.csr_array,
    coupling: sparse.csr_array,
    R: sparse.csr_array,
    q: FloatArray,
    s: FloatArray,
) -> tuple[sparse.csr_array, FloatArray]:
    """U = W r + q with l out of coupling r + R l + s = 0, the least l where R is singular."""
    solved = np.linalg.lstsq(R.toarray(), np.column_stack([coupling.toarray(), s]))[0]
    return sparse.csr_array(W.toarray() - V @ solved[:, :-1]), q - V @ solved[:, -1]


def _write_matrix(group: h5py.Group, matrix: sparse.csr_array) -> None:
    sizes = {"m": matrix.shape[0], "n": matrix.shape[1], "nz": BY_ROWS, "nzmax": matrix.nnz}
    for name, size in sizes.items():
        group[name] = np.array([size], dtype=np.int32)
    group["p"] = matrix.indptr.astype(np.int32)
    group["i"] = matrix.indices.astype(np.int32)
    group["x"] = matrix.data
