"""Problems in files, whatever their format."""

from __future__ import annotations

import os
from pathlib import Path

from saltus.numerics import fclib, siconos_files
from saltus.numerics.problems import Problem

_HDF5 = b"\x89HDF\r\n\x1a\n"


def read_problem(path: str | os.PathLike[str]) -> Problem:
    """Read a problem from Siconos's ASCII format or FCLib's HDF5; the content says which it is.

    Returns
    -------
    Problem
        `LCP`, `MLCP` or `FrictionProblem`; a matrix that is sparse in the file is a scipy.sparse.csr_array.

    Raises
    ------
    ValueError
        If the file is malformed, naming the line or the dataset, what was expected and what came.
    OSError
        If it cannot be read.
    """
    with Path(path).open("rb") as file:
        start = file.read(len(_HDF5))
    return fclib.read(path) if start == _HDF5 else siconos_files.read(path)
