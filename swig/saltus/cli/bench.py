"""``saltus bench``: what a step costs."""

from __future__ import annotations

import json
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass

from rich.console import Console
from rich.table import Table

from saltus import _core, registry
from saltus.cli import bench_functions
from saltus.cli.progress import progress_bar
from saltus.kernel import integrators
from saltus.models import MODELS, Example

REPEATS = 7
FUNCTIONS = "model-functions"  #: what a call of them costs, beside the models


@dataclass(frozen=True)
class Result:
    """One line of the table."""

    model: str
    integrator: str
    us_per_step: float  # median over the repeats
    steps: int
    time_step: float  # [s]


@dataclass(frozen=True)
class Skipped:
    """A pair that cannot be run, and why."""

    model: str
    integrator: str
    reason: str


def run(names: Sequence[str], schemes: Sequence[str], as_json: bool) -> None:
    """Time every integrator on every model and print the table.

    Raises
    ------
    ValueError
        If there is no such model or integrator.
    """
    for name in names:
        if name not in MODELS and name != FUNCTIONS:
            raise ValueError(f"no model named '{name}', there are {', '.join((*MODELS, FUNCTIONS))}")
    chosen = [_label(scheme) for scheme in schemes]
    results: list[Result] = []
    skipped: list[Skipped] = []
    calls: dict[str, float] = {}
    with progress_bar() as show:
        models = list(names) or [*MODELS, FUNCTIONS]
        for index, name in enumerate(models):
            show(name, index / len(models))
            if name == FUNCTIONS:
                calls.update(bench_functions.measure())
                continue
            measure(name, chosen or [entry["name"] for entry in integrators()], results, skipped)
    if as_json:
        ns = [{"function": kind, "ns_per_call": 1e9 * seconds} for kind, seconds in calls.items()]
        print(
            json.dumps(
                {
                    "results": [asdict(r) for r in results],
                    "skipped": [asdict(s) for s in skipped],
                    "model_functions": ns,
                }
            )
        )
    else:
        print_table(results, skipped)
        print_calls(calls)


def _label(spec: str) -> str:
    """What stands in the table: the registered name, or name and options as they were given."""
    name = registry.make_integrator(spec).name
    return spec if "(" in spec else name


def measure(name: str, schemes: Sequence[str], results: list[Result], skipped: list[Skipped]) -> None:
    """Median time of a step: the loop alone, with the report of each step, nothing recorded.

    The integrators take turns, so that a disturbance of the machine does not hit one of them alone. Those
    that are unstable at the model's Δt are left out: numbers that grow without bound have costs of their own.
    """
    model = MODELS[name]
    loops: dict[str, Callable[[], float]] = {}
    for scheme in schemes:
        try:
            system, integrator = model.build(), registry.make_integrator(scheme)
            _core.TimeSteppingBase(system, integrator, model.time_step, "auto")
            refusal = _core.stability_warning(system, integrator, model.time_step)
        except ValueError as error:
            refusal = str(error)
        if refusal is not None:
            skipped.append(Skipped(name, scheme, refusal))
            continue
        loops[scheme] = lambda scheme=scheme: time_loop(model, scheme)  # type: ignore[misc]
    if model.bare_loop:
        loops["bare-loop"] = lambda: time_bare_loop(model)
    runs = -(-model.bench_steps // model.steps)
    seconds: dict[str, list[float]] = {scheme: [] for scheme in loops}
    for _ in range(REPEATS):
        for scheme, loop in list(loops.items()):
            try:
                seconds[scheme].append(sum(loop() for _ in range(runs)) / runs)
            except _core.SimulationError as error:  # of a model whose stability is not judged beforehand
                skipped.append(Skipped(name, scheme, str(error)))
                del loops[scheme], seconds[scheme]
    for scheme, values in seconds.items():
        us = 1e6 * statistics.median(values) / model.steps
        results.append(Result(name, scheme, us, model.steps, model.time_step))


def time_loop(model: Example, scheme: str) -> float:
    """Seconds of one run, its preparation excluded."""
    simulation = _core.TimeSteppingBase(
        model.build(), registry.make_integrator(scheme), model.time_step, "auto"
    )
    start = time.perf_counter()
    simulation.advance(model.until, None)
    return time.perf_counter() - start


def time_bare_loop(model: Example) -> float:
    """Seconds of the loop written by hand."""
    assert model.bare_loop
    start = time.perf_counter()
    model.bare_loop(model.time_step, model.steps)
    return time.perf_counter() - start


def print_table(results: Sequence[Result], skipped: Sequence[Skipped]) -> None:
    """Time of a step, and its ratio to the bare loop where there is one."""
    if not results and not skipped:
        return
    bare = {r.model: r.us_per_step for r in results if r.integrator == "bare-loop"}
    table = Table(title=f"time of a step, median of {REPEATS} runs, one thread, nothing recorded")
    for heading in ("model", "integrator"):
        table.add_column(heading, no_wrap=True)
    for heading in ("µs/step", "/ bare loop"):
        table.add_column(heading, justify="right")
    for r in results:
        ratio = f"{r.us_per_step / bare[r.model]:.2f}" if r.model in bare else ""
        table.add_row(f"{r.model}, Δt={r.time_step:.0e}", r.integrator, f"{r.us_per_step:.3f}", ratio)
    console = Console(soft_wrap=True)
    console.print(table)
    for s in skipped:
        console.print(f"{s.integrator} on {s.model} not run: {s.reason}", highlight=False)


def print_calls(calls: dict[str, float]) -> None:
    """What the call of a model function costs."""
    if not calls:
        return
    table = Table(title="call of a model function that does nothing, beyond a model without any")
    table.add_column("function", no_wrap=True)
    table.add_column("ns/call", justify="right")
    for kind, seconds in calls.items():
        table.add_row(kind, f"{1e9 * seconds:.0f}")
    Console(soft_wrap=True).print(table)
