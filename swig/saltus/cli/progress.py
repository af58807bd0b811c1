"""What long commands show on stderr while they compute."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    SpinnerColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)


@contextmanager
def progress_bar() -> Iterator[Callable[[str, float], None]]:
    """A bar that takes a label and the fraction that is done; stdout stays clean."""
    console = Console(stderr=True)
    columns = (SpinnerColumn(), TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("", total=1.0)
        last = ""

        def show(label: str, fraction: float) -> None:
            nonlocal last
            if label != last and not console.is_terminal:
                console.print(label, highlight=False)
            last = label
            bar.update(task, description=label, completed=fraction)

        yield show


@contextmanager
def sweep_progress() -> Iterator[Callable[[int, int, int, int], None]]:
    """A bar of runs, with their rate and the time that remains; stdout stays clean.

    It takes the numbers of runs in all, there before, made, and failed. Where there is no terminal it is a
    line every ten seconds.
    """
    console = Console(stderr=True)
    columns = (
        SpinnerColumn(),
        MofNCompleteColumn(),
        BarColumn(),
        TextColumn("{task.description}"),
        TimeElapsedColumn(),
        TextColumn("remaining"),
        TimeRemainingColumn(elapsed_when_finished=True),
    )
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("", total=None)
        start = said = time.monotonic()

        def show(total: int, before: int, made: int, failed: int) -> None:
            nonlocal said
            now = time.monotonic()
            rate = made / max(now - start, 1e-3)
            text = f"{rate:.3g} runs/s" + (f", {failed} failed" if failed else "")
            bar.update(task, description=text, total=total, completed=before + made)
            if not console.is_terminal and now > said + 10:
                left = (total - before - made) / rate
                console.print(
                    f"{before + made} of {total} runs, {text}, {left:.0f} s remain", highlight=False
                )
                said = now

        yield show
