"""Functions of shared libraries with the signatures of Siconos's plugins."""

from __future__ import annotations

import ctypes
import os
import sys
from contextlib import suppress
from ctypes import POINTER, c_double, c_uint, c_void_p
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from saltus.siconos.arrays import Named

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from saltus.typing import FloatArray

_DOUBLES = POINTER(c_double)


class PluginFunction:
    """A function of a library that is beside the script, in the current folder, or where the loader looks.

    Parameters
    ----------
    library : a path, or a name as "BallPlugin" of BallPlugin.so or libBallPlugin.so
    name : of the function, which must have C linkage
    signature : its arguments before z: "t" time, "n" a size, "a" an array, of which the last is written

    Raises
    ------
    ValueError
        If there is no such library or function, or the library cannot be loaded.
    """

    def __init__(self, library: str, name: str, signature: str) -> None:
        self._library = _load(library)
        if not hasattr(self._library, name):
            raise ValueError(f"plugin '{library}:{name}': the library exports no '{name}'")
        self._call = getattr(self._library, name)
        types = [{"t": c_double, "n": c_uint, "a": _DOUBLES}[kind] for kind in signature]
        self._call.argtypes = [*types, c_uint, _DOUBLES]
        self._call.restype = None
        #: of the C function
        self.address = ctypes.cast(self._call, c_void_p).value

    def __call__(self, *arguments: Any, z: FloatArray) -> None:
        """Call it once; arrays are contiguous, those that are matrices column by column."""
        given = [a.ctypes.data_as(_DOUBLES) if isinstance(a, np.ndarray) else a for a in arguments]
        self._call(*given, len(z), z.ctypes.data_as(_DOUBLES))


def split(plugin: str) -> tuple[str, str]:
    """Library and function of "library:function". Raises ValueError if it has no such form."""
    library, colon, function = plugin.rpartition(":")
    if not (library and colon and function):
        raise ValueError(f"expected a plugin as 'library:function', got '{plugin}'")
    return library, function


def _load(library: str) -> ctypes.CDLL:
    path = Path(library)
    names = [path.name] if path.suffix == ".so" else [f"{path.name}.so", f"lib{path.name}.so"]
    anywhere = os.sep not in library
    folders = [Path(sys.path[0]), Path()] if anywhere else [path.parent]
    for file in (folder / name for folder in folders for name in names):
        if file.is_file():
            try:
                return ctypes.CDLL(str(file.resolve()))
            except OSError as error:
                raise ValueError(f"plugin '{library}': the library cannot be loaded: {error}") from error
    for name in names if anywhere else []:
        with suppress(OSError):
            return ctypes.CDLL(name)
    where = ", ".join(f"'{folder.resolve()}'" for folder in folders)
    raise ValueError(f"plugin '{library}': expected {' or '.join(names)} in {where}, got none")


class PluggedTerms(Named):
    """Terms of a system that are functions of plugins, besides those that are constants or overrides.

    Each method raises ValueError if there is no such library or function.
    """

    _SIGNATURES = {
        "Mass": "naa",
        "FInt": "tnaaa",
        "FGyr": "naaa",
        "FExt": "tna",
        "JacobianFIntq": "tnaaa",
        "JacobianFIntqDot": "tnaaa",
        "JacobianFGyrq": "naaa",
        "JacobianFGyrqDot": "naaa",
    }

    def __init__(self) -> None:
        self._plugins: dict[str, PluginFunction] = {}
        self._z = np.zeros(1)

    def z(self) -> FloatArray:
        """What plugins get as z."""
        return self._z

    def setzPtr(self, z: ArrayLike) -> None:
        """Parameters of the plugins; their values when the simulation is made."""
        self._z = np.array(z, dtype=float)

    def _plug(self, term: str, library: str, function: str) -> None:
        self._plugins[term] = PluginFunction(library, function, self._SIGNATURES[term])

    def setComputeMassFunction(self, library: str, function: str) -> None:
        """M(q): void f(unsigned n, double* q, double* M, unsigned size_z, double* z)."""
        self._plug("Mass", library, function)

    def setComputeFIntFunction(self, library: str, function: str) -> None:
        """F_int: void f(double t, unsigned n, double* q, double* v, double* out, unsigned nz, double* z)."""
        self._plug("FInt", library, function)

    def setComputeFGyrFunction(self, library: str, function: str) -> None:
        """F_gyr: void f(unsigned n, double* q, double* v, double* out, unsigned size_z, double* z)."""
        self._plug("FGyr", library, function)

    def setComputeFExtFunction(self, library: str, function: str) -> None:
        """F_ext: void f(double t, unsigned n, double* out, unsigned size_z, double* z)."""
        self._plug("FExt", library, function)

    def setComputeJacobianFIntqFunction(self, library: str, function: str) -> None:
        """∂F_int/∂q, with the arguments of F_int."""
        self._plug("JacobianFIntq", library, function)

    def setComputeJacobianFIntqDotFunction(self, library: str, function: str) -> None:
        """∂F_int/∂v, with the arguments of F_int."""
        self._plug("JacobianFIntqDot", library, function)

    def setComputeJacobianFGyrqFunction(self, library: str, function: str) -> None:
        """∂F_gyr/∂q, with the arguments of F_gyr."""
        self._plug("JacobianFGyrq", library, function)

    def setComputeJacobianFGyrqDotFunction(self, library: str, function: str) -> None:
        """∂F_gyr/∂v, with the arguments of F_gyr."""
        self._plug("JacobianFGyrqDot", library, function)

    def _call_plugin(self, term: str, *arguments: Any, out: FloatArray) -> None:
        """Write a term into `out`, unless it is not a plugin's."""
        function = self._plugins.get(term)
        if function is None:
            return
        columns = np.zeros(out.shape, order="F")
        given = [np.array(a, dtype=float) if np.ndim(a) else a for a in arguments]
        function(*given, columns, z=self._z.copy())
        out[:] = columns
