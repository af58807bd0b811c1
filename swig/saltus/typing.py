"""Types of the public functions."""

from typing import TYPE_CHECKING, Any, TypeAlias, TypedDict, Union

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from scipy.sparse import csr_array, sparray, spmatrix

    from saltus._core import Tableau

FloatArray = NDArray[np.float64]
Matrix: TypeAlias = Union[FloatArray, "csr_array"]
SparseMatrix: TypeAlias = Union["sparray", "spmatrix"]  # any format
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
AxesArray = NDArray[np.object_]  # of matplotlib's Axes
StateArray = NDArray[np.int8]  # codes of saltus.io.ContactState

# "library:function", what saltus.compiled returns, or a C pointer of ctypes, cffi or numba: saltus.functions
ModelFunction = Any


# Of an option of an integrator: a number, or a word that can stand for a tableau
OptionValue: TypeAlias = Union[float, str, "Tableau"]


class OptionEntry(TypedDict):
    """An option of an integrator: a number, or a word out of its choices."""

    default: float | str
    choices: list[str]
    meaning: str


class IntegratorEntry(TypedDict):
    """A row of the table of integrators."""

    name: str
    summary: str
    options: dict[str, OptionEntry]
    properties: dict[str, Any]
