"""The contact problems of a running simulation, written to files."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from saltus.numerics import fclib
from saltus.numerics.problems import FrictionProblem, stage_problem

if TYPE_CHECKING:
    from saltus.kernel import TimeStepping
    from saltus.numerics.problems import Sets
    from saltus.typing import FloatArray, Matrix

When = Literal["all", "failed"] | Callable[[FrictionProblem, str], bool]


class ProblemDump:
    """Writes the problems of a simulation as long as it is not stopped: see `dump_problems`."""

    def __init__(self, simulation: TimeStepping, folder: str | os.PathLike[str], when: When) -> None:
        if not callable(when) and when not in ("all", "failed"):
            raise ValueError(f"when must be 'all', 'failed' or a function, got {when!r}")
        self._simulation = simulation
        self._when = when
        self._step = self._number = -1
        self.folder = Path(folder)
        self.folder.mkdir(parents=True, exist_ok=True)
        self.paths: list[Path] = []  #: what was written so far
        simulation.watch_problems(self._see)

    def stop(self) -> None:
        """Write no more."""
        self._simulation.watch_problems(None)

    def _see(self, G: Matrix, b: FloatArray, sets: Sets, _: FloatArray, status: str) -> None:
        step = self._simulation.steps
        self._number = self._number + 1 if step == self._step else 0
        self._step = step
        problem = stage_problem(G, b, sets)
        if problem.contacts and self._wanted(problem, status):
            path = self.folder / f"step{step:06d}-{self._number}.hdf5"
            text = (
                f"contact problem {self._number} of the step from t = {self._simulation.t:.17g} s, {status}"
            )
            fclib.write(problem, path, description=text)
            self.paths.append(path)

    def _wanted(self, problem: FrictionProblem, status: str) -> bool:
        if callable(self._when):
            return self._when(problem, status)
        return self._when == "all" or status != "solved"


def dump_problems(
    simulation: TimeStepping, folder: str | os.PathLike[str], when: When = "all"
) -> ProblemDump:
    """Write the contact problems of the steps to come to FCLib files, ``step000012-0.hdf5`` and so on.

    One file a problem: a step solves one or more. Contacts without friction become contacts with mu = 0,
    equalities stay or, where their coupling is not symmetric, are eliminated (see `fclib.write`); a problem
    of equalities alone is left out. A simulation is watched by one dump at a time: the last one.

    Parameters
    ----------
    simulation : TimeStepping
    folder : made if it is not there; files of the same name are replaced
    when : "all", "failed" (only those that were not solved), or a function of the problem and the status of
        its solution that says whether to write it

    Returns
    -------
    ProblemDump
        ``paths``, the files written so far, and ``stop()``.

    Raises
    ------
    ValueError
        If `when` is something else.
    OSError
        If the folder cannot be made; from the run, if a file cannot be written.
    """
    return ProblemDump(simulation, folder, when)
