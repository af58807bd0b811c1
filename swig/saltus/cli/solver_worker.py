"""A process of its own that solves contact problems: it may hang, run out of memory or crash.

A solver in C++ holds the interpreter as long as it works, so no thread could stop it. The kernel's timer ends
the process, which is then started again.
"""

from __future__ import annotations

import os
import pickle
import signal
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import IO, Any, NamedTuple

from saltus import registry
from saltus.numerics import Problem, solvers
from saltus.typing import FloatArray

LEAST_TIME = 0.02  #: [s] a solve is repeated until that is spent,
MOST_REPEATS = 5  #: or as often as that

NOT_ACCEPTED, TIME_OUT, CRASH = "not-accepted", "time-out", "crash"  # beside the status of a solution

_ENDED = (EOFError, BrokenPipeError, pickle.UnpicklingError)  # what is seen of a process that is no more


class Answer(NamedTuple):
    """What became of a problem."""

    status: str
    iterations: int | None = None
    solution: FloatArray | None = None
    seconds: float | None = None  # median over the repeats


class SolverWorker:
    """The process, seen from outside; a context, which ends it.

    Parameters
    ----------
    specs : contact solvers as `registry.solver` takes them, all that are registered if none is named
    """

    def __init__(self, specs: Sequence[str]) -> None:
        self._specs = list(specs)
        self._process: subprocess.Popen[bytes] | None = None

    def __enter__(self) -> SolverWorker:
        return self

    def __exit__(self, *_: object) -> None:
        self._end()

    def start(self) -> list[str]:
        """Start it, and return the names of the solvers in its table.

        Raises
        ------
        ValueError
            If one of them cannot be loaded.
        """
        code = f"import sys; sys.path[:] = {sys.path}; from saltus.cli import solver_worker as w; w.serve()"
        self._process = subprocess.Popen(
            [sys.executable, "-c", code],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            start_new_session=True,  # Ctrl-C is for the command, which ends this process
        )
        try:
            names, error = self._ask(self._specs)
        except _ENDED:
            raise ValueError(f"the process that loads {self._specs} ended with {self._end()}") from None
        if error:
            raise ValueError(error)
        return list(names)

    def solve(self, problem: Problem, solver: str, tolerance: float, time_out: float) -> Answer:
        """Solve it, a few times if that is quick; a solve is ended after `time_out` [s]."""
        if self._process is None:
            self.start()
        try:
            return Answer(*self._ask((problem, solver, tolerance, time_out)))
        except _ENDED:
            return Answer(TIME_OUT if self._end() == -signal.SIGALRM else CRASH)

    def _ask(self, request: Any) -> Any:
        assert self._process is not None
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        _send(self._process.stdin, request)
        return pickle.load(self._process.stdout)

    def _end(self) -> int:
        """End it if it still runs, and return its exit status."""
        if self._process is None:
            return 0
        self._process.kill()
        self._process.communicate()
        status, self._process = self._process.returncode, None
        return status


def serve() -> None:
    """The process from inside: load solvers, then solve what comes, until there is no more."""
    requests, replies = sys.stdin.buffer, os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a solver prints is no reply
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    try:
        names = list(dict.fromkeys(registry.solver(spec) for spec in pickle.load(requests)))
    except ValueError as error:
        _send(replies, ([], str(error)))
        return
    _send(replies, (names or list(solvers()), ""))
    with suppress(EOFError):
        while True:
            _send(replies, tuple(measure(*pickle.load(requests))))


def measure(problem: Problem, solver: str, tolerance: float, time_out: float) -> Answer:
    """Solve it; the process ends by SIGALRM if that takes longer than `time_out` [s]."""
    seconds: list[float] = []
    while sum(seconds) < LEAST_TIME and len(seconds) < MOST_REPEATS:
        with _ended_after(time_out):
            start = time.perf_counter()
            try:
                found = problem.solve(solver, tolerance)
            except ValueError as error:
                if "does not accept this problem" not in str(error):
                    raise
                return Answer(NOT_ACCEPTED)
            seconds.append(time.perf_counter() - start)
    return Answer(found.status, found.iterations, found.solution, statistics.median(seconds))


@contextmanager
def _ended_after(time_out: float) -> Iterator[None]:
    signal.setitimer(signal.ITIMER_REAL, time_out)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)


def _send(stream: IO[bytes], content: Any) -> None:
    pickle.dump(content, stream, protocol=pickle.HIGHEST_PROTOCOL)
    stream.flush()
