"""Model functions at the speed of C: compiled from Python, or made elsewhere.

The constructors of `LagrangianDS` and `LagrangianScleronomousR` take functions in the place of methods, that
of `Actuator` takes one as its force:

    @saltus.compiled
    def forces(t, q, v, out, parameters):
        out[0] = -parameters[0] * q[0]

    ball = sk.LagrangianDS(q0, v0, mass=M, forces=forces, parameters=[50.0])

A function is one of

- what `compiled` returns: the method without ``self``, and with ``parameters`` last if it needs them;
- ``"library:function"`` of a shared library;
- a ctypes or cffi pointer to a function, or an object with its ``address``, as a ``numba.cfunc`` has one.

The last two obey one C signature, `saltus/kernel/model/model_function.hpp`:

    void f(double t, int n, const double* q, const double* v, double* out, const double* parameters)
"""

from __future__ import annotations

import ctypes
import inspect
import sys
from collections.abc import Callable
from typing import Any

FUNCTION_POINTER = ctypes.CFUNCTYPE(None).__mro__[1]  # ctypes' own base of them all

METHODS = {
    "mass": (("q", "out"), "(n, n)"),
    "forces": (("t", "q", "v", "out"), "(n,)"),
    "force_jacobians": (("t", "q", "v", "out"), "(2, n, n)"),
    "potential_energy": (("q",), "(1,)"),
    "gap": (("q", "out"), "(rows,)"),
    "jacobian": (("q", "out"), "(rows, n)"),
    "curvature": (("q", "v", "out"), "(rows,)"),
    "force": (("t", "length", "rate"), "(1,)"),
}
RETURNED = {"potential_energy", "force"}  # the others write into out


class CompiledFunction:
    """A Python function that numba compiles for the model that takes it; calling it runs the Python code."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.function = function
        self.__doc__ = function.__doc__
        self._compiled: dict[tuple[str, int, int], Any] = {}

    def __call__(self, *arguments: Any) -> Any:
        """Run the function as Python code."""
        return self.function(*arguments)

    def __repr__(self) -> str:
        return f"<compiled {self.function.__qualname__}>"

    def address(self, method: str, rows: int, parameters: int) -> int:
        """Compile for a method of a model. Returns the address of the C function."""
        key = (method, rows, parameters)
        if key not in self._compiled:
            self._compiled[key] = _compile(self.function, method, rows, parameters)
        return int(self._compiled[key].address)


def compiled(function: Callable[..., Any]) -> CompiledFunction:
    """Let numba compile a model function.

    Arguments are those of the method that it stands for, without ``self``; ``parameters`` may follow.
    `out` is zero at the call. What numba cannot compile is an error when the model is made; an exception
    at run time fills `out` with NaN, which ends the run.

    Raises
    ------
    ModuleNotFoundError
        If numba is not installed.
    """
    if not callable(function):
        raise TypeError(f"compiled needs a function, got {type(function).__name__}")
    import numba  # noqa: F401

    return CompiledFunction(function)


def _compile(function: Callable[..., Any], method: str, rows: int, parameters: int) -> Any:
    import numba
    from numba import carray, types  # type: ignore[attr-defined]

    names, shape = METHODS[method]
    given = tuple(inspect.signature(function).parameters)
    if given not in (names, (*names, "parameters")):
        raise TypeError(
            f"{function.__qualname__}: the arguments of {method} must be ({', '.join(names)}) or "
            f"({', '.join((*names, 'parameters'))}), got ({', '.join(given)})"
        )
    call = f"inner({', '.join(given)})"
    source = f"""
def entry(t, n, q_pointer, v_pointer, out_pointer, parameters_pointer):
    rows = {rows}
    q = carray(q_pointer, (n,))
    v = carray(v_pointer, (n,))
    out = carray(out_pointer, {shape})
    parameters = carray(parameters_pointer, ({parameters},))
    length, rate = q[0], v[0]
    try:
        {"out[0] = " if method in RETURNED else ""}{call}
    except Exception:
        out[...] = nan
"""
    read_only = types.Array(types.float64, 1, "C", readonly=True)  # as the arrays of methods are
    axes = len([extent for extent in shape.strip("()").split(",") if extent])
    arrays = dict.fromkeys(("q", "v", "parameters"), read_only)
    arrays["out"] = types.Array(types.float64, axes, "C")
    inner = numba.njit(
        tuple(arrays.get(name, types.float64) for name in given), error_model="numpy", boundscheck=True
    )(function)
    [signature] = inner.nopython_signatures
    if method not in RETURNED and signature.return_type != types.none:
        got = f"got {signature.return_type}"
        raise TypeError(f"{function.__qualname__} must write into out and return None, {got}")
    scope: dict[str, Any] = {"carray": carray, "inner": inner, "nan": float("nan")}
    exec(source, scope)
    pointer = types.CPointer(types.float64)  # type: ignore[no-untyped-call]
    signature = types.void(types.float64, types.int32, pointer, pointer, pointer, pointer)
    return numba.cfunc(signature, error_model="numpy")(scope["entry"])


def is_native(function: object) -> bool:
    """Tell functions at the speed of C from those that Python runs."""
    cffi = sys.modules.get("_cffi_backend")
    return (
        isinstance(function, (str, CompiledFunction, FUNCTION_POINTER))
        or (cffi is not None and isinstance(function, cffi.FFI.CData))
        or isinstance(getattr(function, "address", None), int)
    )


def address(function: object, method: str, rows: int, parameters: int) -> int:
    """Address of the C function that `function` stands for; the core asks for it.

    Raises
    ------
    TypeError
        If it is not a kind of function that this module knows.
    """
    if isinstance(function, CompiledFunction):
        return function.address(method, rows, parameters)
    if isinstance(function, FUNCTION_POINTER):
        number = ctypes.cast(function, ctypes.c_void_p).value  # type: ignore[arg-type]
        return _not_null(number, method)
    cffi = sys.modules.get("_cffi_backend")
    if cffi is not None and isinstance(function, cffi.FFI.CData):
        return _not_null(int(cffi.FFI().cast("intptr_t", function)), method)
    if isinstance(where := getattr(function, "address", None), int):
        return _not_null(where, method)
    hint = ": decorate it with @saltus.compiled" if inspect.isfunction(function) else ""
    raise TypeError(
        f"{method} must be a compiled function, 'library:function' or a pointer to a C function, got "
        f"{type(function).__name__}{hint}"
    )


def _not_null(number: int | None, method: str) -> int:
    if not number:
        raise ValueError(f"{method} must be a pointer to a C function, got a null pointer")
    return number
