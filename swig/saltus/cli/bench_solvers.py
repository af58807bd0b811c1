"""``saltus bench solvers``: contact solvers compared on a collection of problems."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from math import inf, isfinite
from pathlib import Path
from statistics import median
from typing import Any, TypeAlias

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from saltus.cli.compare import number, to_numbers
from saltus.cli.out import require_picture, require_targets, save, wide_console, write
from saltus.cli.progress import progress_bar
from saltus.cli.solver_worker import CRASH, NOT_ACCEPTED, TIME_OUT, Answer, SolverWorker
from saltus.numerics import (
    FRICTION_KINDS,
    LCP_KINDS,
    FrictionProblem,
    Problem,
    random_friction,
    random_lcp,
    read_problem,
)
from saltus.numerics.profiles import performance_profile
from saltus.registry import split_specs

Collection: TypeAlias = dict[str, Callable[[], Problem]]

ENDINGS = (".dat", ".hdf5", ".h5")
LCP_SIZES = (8, 32, 128)  #: rows of the problems that are made if no folder is given
CONTACTS = (2, 8, 32)
MOST_SECONDS = 1e6  #: of a time-out: more than that a timer does not take
SOLVED, WRONG = "solved", "wrong"  #: a solution that is called solved, and is not


@dataclass(frozen=True)
class Row:
    """One solver on one problem; what is not known is None."""

    problem: str
    solver: str
    tolerance: float
    status: str
    iterations: int | None
    residual: float | None  # computed here from the solution
    seconds: float | None


@dataclass(frozen=True)
class Bench:
    """What was measured."""

    solvers: list[str]
    tolerances: list[float]
    problems: list[dict[str, Any]]
    unreadable: list[str]
    rows: list[Row]

    def select(self, solver: str, tolerance: float) -> list[Row]:
        """One solver's rows, in the order of the problems."""
        return [row for row in self.rows if (row.solver, row.tolerance) == (solver, tolerance)]

    def profile(self, tolerance: float) -> dict[str, list[tuple[float, float]]]:
        """Performance profile: see `performance_profile`."""
        rows = {solver: self.select(solver, tolerance) for solver in self.solvers}
        return performance_profile({solver: [_time(row) for row in own] for solver, own in rows.items()})

    def to_json(self) -> dict[str, Any]:
        """All figures."""
        return {
            "problems": self.problems,
            "unreadable": self.unreadable,
            "tolerances": self.tolerances,
            "rows": [asdict(row) for row in self.rows],
            "profiles": [
                {"tolerance": tolerance, "solver": solver, "steps": steps}
                for tolerance in self.tolerances
                for solver, steps in self.profile(tolerance).items()
            ],
        }


def run(
    folder: Path | None,
    specs: str,
    tolerances: str,
    *,
    time_out: float,
    json_to: Path | None,
    picture: Path | None,
) -> None:
    """Measure, print the tables, and write the files that are wanted ("-" as in `compare.run`).

    Raises
    ------
    ValueError, OSError
        If something given makes no sense, there is no problem, or a file cannot be written.
    """
    bounds = _tolerances(tolerances)
    if not 0 < time_out <= MOST_SECONDS:
        raise ValueError(f"a time-out must be between 0 and {MOST_SECONDS:g} s, got {time_out:g}")
    quiet = require_targets([path for path in (json_to, picture) if path is not None])
    if picture is not None:
        require_picture(picture)
    collection = read_collection(folder) if folder else made_collection()
    with SolverWorker(split_specs(specs)) as worker:
        found = measure(collection, worker, bounds, time_out)
    if not found.problems:
        raise ValueError(f"no file in '{folder}' can be read as a contact problem")
    if picture is not None:
        from saltus.cli.profiles import draw

        save(draw({tolerance: found.profile(tolerance) for tolerance in bounds}), picture)
    if json_to is not None:
        write(json.dumps(found.to_json(), indent=2, ensure_ascii=False, allow_nan=False) + "\n", json_to)
    if not quiet:
        print_tables(found, picture)


def _tolerances(text: str) -> list[float]:
    values = list(dict.fromkeys(to_numbers(text, "tolerances")))
    if not values or not all(0 < value < inf for value in values):
        raise ValueError(f"tolerances must be positive numbers between commas, got '{text}'")
    return values


def read_collection(folder: Path) -> Collection:
    """The problems in files of this folder and those below. Raises ValueError if there is none."""
    if not folder.is_dir():
        raise ValueError(f"expected a folder of contact problems, got '{folder}'")
    paths = sorted(path for path in folder.rglob("*") if path.suffix in ENDINGS and path.is_file())
    if not paths:
        raise ValueError(f"there is no file *{', *'.join(ENDINGS)} in '{folder}'")
    return {path.relative_to(folder).as_posix(): partial(read_problem, path) for path in paths}


def made_collection() -> Collection:
    """Random problems of every kind but the one that has no solution, the same every time."""
    collection: Collection = {}
    for kind in LCP_KINDS:
        for n in LCP_SIZES if kind != "unsolvable" else ():
            collection[f"lcp-{kind}-{n}"] = partial(random_lcp, kind, n, seed=n)
    for kind in FRICTION_KINDS:
        for dim in (2, 3):
            for contacts in CONTACTS:
                name = f"friction-{dim}d-{kind}-{contacts}"
                collection[name] = partial(random_friction, kind, contacts, dim, seed=contacts)
    return collection


def measure(
    collection: Collection, worker: SolverWorker, tolerances: Sequence[float], time_out: float
) -> Bench:
    """Every solver of the worker on every problem; what cannot be read is named on stderr."""
    found = Bench(worker.start(), list(tolerances), [], [], [])
    with progress_bar() as show:
        for index, (name, make) in enumerate(collection.items()):
            show(escape(name), index / len(collection))
            try:
                problem = make()
            except (ValueError, OSError) as error:
                found.unreadable.append(name)
                _report(f"{name} cannot be read: {error}")
                continue
            contacts = problem.contacts if isinstance(problem, FrictionProblem) else None
            about = {"name": name, "class": type(problem).__name__, "rows": problem.q.size}
            found.problems.append({**about, "contacts": contacts})
            for solver in found.solvers:
                for tolerance in tolerances:
                    answer = worker.solve(problem, solver, tolerance, time_out)
                    found.rows.append(judge(name, problem, solver, tolerance, answer))
    if found.unreadable:
        _report(f"{len(found.unreadable)} of {len(collection)} files cannot be read")
    return found


def judge(name: str, problem: Problem, solver: str, tolerance: float, answer: Answer) -> Row:
    """The residual is computed from the solution, and what is called solved must be within the tolerance."""
    residual = None if answer.solution is None else problem.residual(answer.solution)
    status = answer.status
    if status == SOLVED and not (residual is not None and residual <= tolerance):
        status = WRONG
    known = residual if residual is not None and isfinite(residual) else None
    return Row(name, solver, tolerance, status, answer.iterations, known, answer.seconds)


def _time(row: Row) -> float:
    return row.seconds if row.status == SOLVED and row.seconds is not None else inf


def print_tables(found: Bench, picture: Path | None) -> None:
    """Print to stdout: a table for each tolerance."""
    console = wide_console()
    for tolerance in found.tolerances:
        console.print(_table(found, tolerance))
    if picture is not None:
        console.print(f"{picture}  picture", highlight=False)


def _table(found: Bench, tolerance: float) -> Table:
    table = Table(title=f"tolerance {tolerance:g}; time and residual of what is solved")
    table.add_column("solver", no_wrap=True)
    counted = (NOT_ACCEPTED, TIME_OUT, CRASH)
    for heading in ("solved", *counted, "median time [ms]", "worst residual"):
        table.add_column(escape(heading), justify="right", no_wrap=True)
    for solver in found.solvers:
        rows = found.select(solver, tolerance)
        solved = [row for row in rows if row.status == SOLVED]
        table.add_row(
            solver,
            f"{len(solved)} of {len(rows)}",
            *(str(sum(row.status == status for row in rows)) for status in counted),
            number(1e3 * median(map(_time, solved)) if solved else None, ".3g"),
            number(max((row.residual or 0.0 for row in solved), default=None), ".1e"),
        )
    return table


def _report(text: str) -> None:
    Console(stderr=True, soft_wrap=True).print(text, style="yellow", highlight=False, markup=False)
