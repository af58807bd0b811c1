"""What a long run shows on stderr."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

if TYPE_CHECKING:
    from saltus.kernel import TimeStepping

SECONDS = 10.0  #: between two lines, where there is no terminal for a bar


@contextmanager
def shown(simulation: TimeStepping, until: float) -> Iterator[Callable[[float], None]]:
    """A bar with steps, steps a second and the time that remains; without a terminal a line now and then.

    What it yields is called while the simulation runs.
    """
    console = Console(stderr=True)
    first, start = simulation.steps, time.perf_counter()
    total = first + max(round((until - simulation.t) / simulation.time_step), 0)
    said = start
    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("", total=total, completed=first)

        def report(t: float) -> None:
            nonlocal said
            now = time.perf_counter()
            bar.update(task, completed=simulation.steps, description=text(t, now))
            if not console.is_terminal and now - said >= SECONDS:
                said = now
                console.print(text(t, now), highlight=False, soft_wrap=True)

        def text(t: float, now: float) -> str:
            done = simulation.steps
            rate = (done - first) / (now - start)
            remaining = (total - done) / rate if rate else float("inf")
            return f"t = {t:.6g} s, {done} of {total} steps, {rate:.3g} steps/s, {remaining:.0f} s remain"

        try:
            yield report
        finally:
            seconds = time.perf_counter() - start
            steps = simulation.steps - first
            rate = steps / seconds
            console.print(f"{steps} steps in {seconds:.3g} s, {rate:.3g} steps/s", highlight=False)
