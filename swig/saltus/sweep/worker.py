"""What a worker does: it makes runs in processes of its own, which may crash or be ended.

A dask worker would be taken for dead while a run in C++ holds its interpreter.
"""

from __future__ import annotations

import os
import threading
import time
import traceback
import warnings
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import saltus.kernel as sk
from saltus import __version__
from saltus.child_process import TIME_OUT, ChildProcess, EndedError, ended_after, serve_requests
from saltus.io import Trajectory
from saltus.sweep.study import Run, Study, make_study

ATTEMPTS = 3  #: of a run whose process ends
DONE, FAILED, TIMED_OUT, DIED = "done", "failed", "time-out", "died"  #: status of a run

# A thread for each process: sums are added in the same order whatever else the machine does.
ENVIRONMENT = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}
ENVIRONMENT["PYTHONHASHSEED"] = "0"


class Task(NamedTuple):
    """Everything a process needs to know of a run."""

    version: str  #: of Saltus
    source: str  #: of the study
    path: str
    run: Run
    time_out: float | None  #: [s]
    keep: str | None  #: HDF5 file of the trajectory


class Processes:
    """The processes of one sweep on one worker, one for each of its threads."""

    def __init__(self) -> None:
        self._idle: list[ChildProcess] = []
        self._all: set[ChildProcess] = set()
        self._closed = False
        self._lock = threading.Lock()

    def make(self, task: Task) -> dict[str, Any]:
        """Make the run, also after its process has ended, and tell what became of it."""
        status = 0
        for _ in range(ATTEMPTS):
            process = self._take()
            try:
                answer: dict[str, Any] = process.ask(task)
            except EndedError as ended:
                status = ended.status
                with self._lock:
                    self._all.discard(process)
                if status == TIME_OUT and task.time_out is not None:
                    return failure(TIMED_OUT, "TimeoutError", f"took longer than {task.time_out:g} s")
            else:
                self._idle.append(process)
                return answer
        how = f"signal {-status}" if status < 0 else f"exit status {status}"
        return failure(DIED, "ProcessDied", f"its process ended by {how}, {ATTEMPTS} times")

    def close(self) -> None:
        """End all processes, also those that are at work."""
        with self._lock:
            self._closed = True
            for process in self._all:
                process.kill()
        for process in self._idle:
            process.end()

    def _take(self) -> ChildProcess:
        with self._lock:
            if self._closed:
                raise RuntimeError("the sweep is over")
            if self._idle:
                return self._idle.pop()
            process = ChildProcess(__name__, ENVIRONMENT)
            self._all.add(process)
            return process


_parent = os.getppid()
_sweeps: dict[str, Processes] = {}  # those that this worker takes part in


def make(sweep: str, task: Task) -> dict[str, Any]:
    """Make a run of a sweep: what dask calls."""
    return _sweeps.setdefault(sweep, Processes()).make(task)


def close(sweep: str) -> None:
    """The sweep is over."""
    if (processes := _sweeps.pop(sweep, None)) is not None:
        processes.close()


def serve() -> None:
    """The process from inside."""
    serve_requests(_answer)


def _answer(task: Task) -> dict[str, Any]:
    if task.version != __version__:
        message = f"expected Saltus {task.version} on every worker, got {__version__}"
        return failure(FAILED, "RuntimeError", message)
    start = time.perf_counter()
    answer: dict[str, Any]
    with ended_after(task.time_out), warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        try:
            answer = {"status": DONE, "figures": _figures(_study(task.source, task.path), task)}
        except Exception as error:
            answer = failure(FAILED, type(error).__name__, str(error), traceback.format_exc())
    answer["warnings"] = list(dict.fromkeys(str(warning.message) for warning in said))
    answer["seconds"] = time.perf_counter() - start
    return answer


@lru_cache(maxsize=1)
def _study(source: str, path: str) -> Study:
    return make_study(source, Path(path))


def _figures(study: Study, task: Task) -> dict[str, Any]:
    """Run it and measure it."""
    run = task.run
    simulation = sk.TimeStepping(study.build(**run.parameters), run.integrator, run.time_step)  # type: ignore[arg-type]
    try:
        trajectory = simulation.run(run.until, _end_with_parent)
    finally:
        if task.keep is not None:
            simulation.trajectory.to_hdf5(task.keep)
    measured = {} if study.measure is None else study.measure(trajectory)
    if not isinstance(measured, Mapping):
        raise TypeError(f"measure must return figures by name, got {type(measured).__name__}")
    standard = standard_figures(trajectory)
    taken = (set(measured) & {*standard, *run.parameters}) | (set(measured) & set(COLUMNS))
    if taken:
        raise ValueError(f"figures must have names of their own, got {', '.join(sorted(taken))}")
    return {**{str(name): _number(name, value) for name, value in measured.items()}, **standard}


#: what the table has of every run besides parameters and figures
COLUMNS = ("id", "integrator", "time_step", "until", "status", "error", "message", "traceback", "warnings")

STANDARD_UNITS = {"steps": "1", "impulsive_steps": "1", "penetration": "m", "residual": "m/s", "energy": "J"}


def standard_figures(trajectory: Trajectory) -> dict[str, float]:
    """Figures of every run: numbers of steps, the largest penetration and residual, the energy at its end."""
    values = (
        int(trajectory.step[-1]),
        int(np.count_nonzero(trajectory.impulsive)),
        float(trajectory.penetration.max()),
        float(trajectory.residual.max()),
        float(trajectory.energy[-1]),
    )
    return dict(zip(STANDARD_UNITS, values, strict=True))


def _end_with_parent(t: float) -> None:
    if os.getppid() != _parent:
        os._exit(1)


def _number(name: str, value: Any) -> float | list[float]:
    """As a file can keep it."""
    array = np.asarray(value)
    if array.dtype.kind not in "biuf" or array.ndim > 1:
        raise TypeError(f"figure '{name}' must be a number or a list of numbers, got {value!r}")
    plain: float | list[float] = array.astype(float).tolist()
    return plain


def failure(status: str, error: str, message: str, trace: str = "") -> dict[str, Any]:
    """What is kept of a run without result."""
    return {"status": status, "error": error, "message": message, "traceback": trace}
