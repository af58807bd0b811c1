"""``saltus reproduce``: tables of the paper, computed and printed beside the paper's values."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from rich.console import Console
from rich.table import Table

from saltus.cli.progress import progress_bar
from saltus.examples.slider_crank import convergence
from saltus.examples.slider_crank.convergence import Row

TITLES = {
    "table2": "Table 2: bilateral slider crank until 0.1 s",
    "table3": "Table 3: slider crank with impacts and friction until 0.1 s",
}


def run(what: str, *, as_json: bool) -> None:
    """Compute the table and print it."""
    rows = compute(what)
    if as_json:
        print(json.dumps(to_json(rows), indent=2))
    else:
        print_table(what, rows)


def compute(what: str) -> list[Row]:
    """All rows of a table; progress goes to stderr."""
    table = convergence.table2 if what == "table2" else convergence.table3
    with progress_bar() as show:
        return list(table(show))


def to_json(rows: Sequence[Row]) -> dict[str, list[dict[str, Any]]]:
    """The rows without their trajectories."""
    keys = ("scheme", "variant", "dt", "error", "normalised", "paper", "order", "us_per_step")
    return {"rows": [{key: getattr(row, key) for key in keys} for row in rows]}


def print_table(table: str, rows: Sequence[Row]) -> None:
    """Print to stdout: our error and the paper's, observed order, cost per step and its ratio."""
    console = Console()
    console.print(TITLES[table], style="bold")
    for variant in dict.fromkeys(row.variant for row in rows):
        console.print(grid_of([row for row in rows if row.variant == variant], variant))
    console.print(
        "error: spectral 2-norm of the differences of (θ1, θ2, θ3) over all N steps\n"
        "order: from error/√N of this Δt and the one above\n" + cost_line(table, rows),
        style="dim",
        highlight=False,
        soft_wrap=True,
    )


def grid_of(rows: Sequence[Row], variant: str) -> Table:
    """The rows of one variant."""
    grid = Table()
    grid.add_column(f"scheme ({variant})", no_wrap=True)
    for heading in ("Δt [s]", "error", "paper", "order", "µs/step"):
        grid.add_column(heading, justify="right", no_wrap=True)
    for before, row in zip([rows[0], *rows], rows, strict=False):
        if before.scheme != row.scheme:
            grid.add_section()
        grid.add_row(
            row.scheme,
            f"{row.dt:.0e}",
            f"{row.error:.4g}",
            "" if row.paper is None else f"{row.paper:.2g}",
            "" if row.order is None else f"{row.order:.2f}",
            f"{row.us_per_step:.2f}",
        )
    return grid


def cost_line(table: str, rows: Sequence[Row]) -> str:
    """Cost of a half-explicit step over that of a Moreau-Jean step, at the finest Δt."""
    finest = min(row.dt for row in rows)
    cost = {row.scheme: row.us_per_step for row in rows if row.dt == finest}
    ratio = cost["HalfExplicitTrapezoidalOSI"] / cost["ExplicitMoreauJeanOSI"]
    printed = convergence.paper_values(table)["cost_ratio"]
    return (
        f"cost of a step, half-explicit over Moreau-Jean, Δt = {finest:.0e} s: {ratio:.2f} (paper: {printed})"
    )
