"""``saltus bench model-functions``: what the call of a model function costs beyond its own work."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import saltus
import saltus.kernel as sk
from saltus import _core

if TYPE_CHECKING:
    from saltus.typing import FloatArray

REPEATS = 7
STEPS = 200_000
TIME_STEP = 1e-5  # [s]


class WithMethod(sk.LagrangianDS):
    """A method that does nothing."""

    def forces(self, t: float, q: FloatArray, v: FloatArray, out: FloatArray) -> None:
        """No force."""


def measure() -> dict[str, float]:
    """Seconds of a call of `forces`: medians of runs, less those of a linear system without any function.

    One step of the explicit Moreau-Jean scheme calls `forces` once. The kinds take turns, so that a
    disturbance of the machine does not hit one of them alone.
    """
    builds: dict[str, Callable[[], sk.LagrangianDS]] = {
        "none": lambda: sk.LagrangianLinearTIDS([1.0], [0.0], [[1.0]]),
        "method": lambda: WithMethod([1.0], [0.0], [[1.0]]),
    }
    compiled = _compiled()
    if compiled is not None:
        address = compiled.address("forces", 0, 0)  # as a ctypes pointer has it
        pointer = _pointer_type()(address)
        builds["compiled"] = lambda: sk.LagrangianDS([1.0], [0.0], [[1.0]], forces=compiled)
        builds["pointer"] = lambda: sk.LagrangianDS([1.0], [0.0], [[1.0]], forces=pointer)
    seconds: dict[str, list[float]] = {kind: [] for kind in builds}
    for _ in range(REPEATS):
        for kind, build in builds.items():
            seconds[kind].append(_time(build()))
    median = {kind: statistics.median(values) for kind, values in seconds.items()}
    return {kind: value - median["none"] for kind, value in median.items() if kind != "none"}


def _time(system: sk.LagrangianDS) -> float:
    model = sk.NonSmoothDynamicalSystem([system])
    scheme = _core.make_integrator("ExplicitMoreauJeanOSI")
    simulation = _core.TimeSteppingBase(model, scheme, TIME_STEP, "auto")
    start = time.perf_counter()
    simulation.advance((STEPS + 0.5) * TIME_STEP, None)
    return (time.perf_counter() - start) / STEPS


def _compiled() -> saltus.functions.CompiledFunction | None:
    def forces(t: float, q: FloatArray, v: FloatArray, out: FloatArray) -> None:
        pass

    try:
        return saltus.compiled(forces)
    except ModuleNotFoundError:  # without numba
        return None


def _pointer_type() -> Any:
    import ctypes

    array = ctypes.POINTER(ctypes.c_double)
    return ctypes.CFUNCTYPE(None, ctypes.c_double, ctypes.c_int, array, array, array, array)
