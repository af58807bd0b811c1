"""What long commands show on stderr while they compute."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn


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
