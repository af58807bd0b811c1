"""Contact solvers in a process of its own: they may hang, run out of memory or crash."""

from __future__ import annotations

import statistics
import time
from collections.abc import Sequence
from typing import Any, NamedTuple

from saltus import registry
from saltus.child_process import TIME_OUT as ENDED_BY_TIMER
from saltus.child_process import ChildProcess, EndedError, ended_after, serve_requests
from saltus.numerics import Problem, solvers
from saltus.typing import FloatArray

LEAST_TIME = 0.02  #: [s] a solve is repeated until that is spent,
MOST_REPEATS = 5  #: or as often as that

NOT_ACCEPTED, TIME_OUT, CRASH = "not-accepted", "time-out", "crash"  # beside the status of a solution


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
        self._process: ChildProcess | None = None

    def __enter__(self) -> SolverWorker:
        return self

    def __exit__(self, *_: object) -> None:
        if self._process is not None:
            self._process.end()

    def start(self) -> list[str]:
        """Start it, and return the names of the solvers in its table.

        Raises
        ------
        ValueError
            If one of them cannot be loaded.
        """
        self._process = ChildProcess(__name__)
        try:
            names, error = self._process.ask(self._specs)
        except EndedError as ended:
            raise ValueError(
                f"the process that loads {self._specs} ended with {self._ended(ended)}"
            ) from None
        if error:
            raise ValueError(error)
        return list(names)

    def solve(self, problem: Problem, solver: str, tolerance: float, time_out: float) -> Answer:
        """Solve it, a few times if that is quick; a solve is ended after `time_out` [s]."""
        if self._process is None:
            self.start()
        assert self._process is not None
        try:
            return Answer(*self._process.ask((problem, solver, tolerance, time_out)))
        except EndedError as ended:
            return Answer(TIME_OUT if self._ended(ended) == ENDED_BY_TIMER else CRASH)

    def _ended(self, ended: EndedError) -> int:
        self._process = None
        return ended.status


def serve() -> None:
    """The process from inside: load solvers, then solve what comes, until there is no more."""
    serve_requests(_answer)


def _answer(request: Any) -> tuple[Any, ...]:
    """What becomes of a problem, or of the solvers that are to be loaded."""
    return tuple(measure(*request)) if isinstance(request, tuple) else _load(request)


def _load(specs: list[str]) -> tuple[list[str], str]:
    try:
        return list(dict.fromkeys(registry.solver(spec) for spec in specs)) or list(solvers()), ""
    except ValueError as error:
        return [], str(error)


def measure(problem: Problem, solver: str, tolerance: float, time_out: float) -> Answer:
    """Solve it; the process ends by SIGALRM if that takes longer than `time_out` [s]."""
    seconds: list[float] = []
    while sum(seconds) < LEAST_TIME and len(seconds) < MOST_REPEATS:
        with ended_after(time_out):
            start = time.perf_counter()
            try:
                found = problem.solve(solver, tolerance)
            except ValueError as error:
                if "does not accept this problem" not in str(error):
                    raise
                return Answer(NOT_ACCEPTED)
            seconds.append(time.perf_counter() - start)
    return Answer(found.status, found.iterations, found.solution, statistics.median(seconds))
