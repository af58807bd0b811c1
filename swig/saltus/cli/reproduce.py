"""``saltus reproduce``: tables and figures of the paper, the tables beside the paper's values.

Beyond the paper ``work-precision``: the error of schemes with fixed steps and with error control over the
time that they take.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from saltus.cli.out import save, write_json
from saltus.cli.progress import progress_bar
from saltus.examples.ball_in_box import figures as ball_in_box
from saltus.examples.elastic_bar import figures as elastic_bar
from saltus.examples.figure import PaperFigure
from saltus.examples.slider_crank import convergence
from saltus.examples.slider_crank import figures as slider_crank
from saltus.examples.slider_crank.convergence import Row
from saltus.examples.work_precision import work_precision
from saltus.io.files import writable_folder

TITLES = {
    "table2": "Table 2: bilateral slider crank until 0.1 s",
    "table3": "Table 3: slider crank with impacts and friction until 0.1 s",
}
FIGURES: dict[str, Callable[[], PaperFigure]] = {
    "fig4": slider_crank.figure_4,
    "fig5": slider_crank.figure_5,
    "fig7": slider_crank.figure_7,
    "fig8": slider_crank.figure_8,
    "fig10": ball_in_box.figure_10,
    "fig11": ball_in_box.figure_11,
    "fig13": elastic_bar.figure_13,
    "fig14": elastic_bar.figure_14,
    "fig15": elastic_bar.figure_15,
}
STUDY = "work-precision"
FIXED_STEPS = ("ExplicitMoreauJeanOSI", "HalfExplicitTrapezoidalOSI", "HalfExplicitRungeKuttaOSI")
CLOSE = 1.5e-5  #: an error [rad] at which schemes are compared


def run(what: str, out: Path, *, as_json: bool) -> None:
    """Compute one table or figure, or all; print the numbers, and write them and the pictures.

    Raises
    ------
    OSError
        If the folder cannot be written; nothing is computed then.
    """
    writable_folder(out)
    names = [*TITLES, *FIGURES] if what == "all" else [what]
    results = {}
    for name in names:
        make = make_table if name in TITLES else make_study if name == STUDY else make_figure
        results[name] = make(name, out, as_json)
        write_json(results[name], out / f"{name}.json")
    if as_json:
        print(json.dumps(results if what == "all" else results[what], indent=2))


def make_table(name: str, out: Path, quiet: bool) -> dict[str, Any]:
    """Compute a table and print it."""
    rows = compute(name)
    if not quiet:
        print_table(name, rows)
        print_path(out / f"{name}.json")
    return to_json(rows)


def make_study(name: str, out: Path, quiet: bool) -> dict[str, Any]:
    """Measure work and precision, draw them and print them."""
    with progress_bar() as show:
        rows = list(work_precision.rows(work_precision.CRANK, show))
    save(work_precision.picture(work_precision.CRANK, rows), out / f"{name}.png")
    if not quiet:
        print_study(rows)
        print_path(out / f"{name}.png")
    return {"rows": [asdict(row) for row in rows]}


def print_study(rows: Sequence[work_precision.Row]) -> None:
    """Print to stdout: every run, and what others make of the time of an accurate one."""
    console = Console()
    grid = Table()
    for heading in ("integrator", "setting", "error", "ms"):
        grid.add_column(heading, justify="left" if heading in ("integrator", "setting") else "right")
    for before, row in zip([rows[0], *rows], rows, strict=False):
        if before.integrator != row.integrator:
            grid.add_section()
        grid.add_row(row.integrator, row.setting, f"{row.error:.2e}", f"{row.ms:.3g}")
    console.print(work_precision.CRANK.title, style="bold")
    console.print(grid)
    for row in rows:
        if row.integrator != work_precision.ADAPTIVE[0] or row.error > CLOSE:
            continue
        ratios = ", ".join(
            f"{name} {work_precision.error_at(rows, name, row.ms) / row.error:.3g}" for name in FIXED_STEPS
        )
        line = f"errors after {row.ms:.3g} ms over that of {row.integrator}, {row.error:.1e}: {ratios}"
        console.print(line, style="dim", highlight=False, soft_wrap=True)


def make_figure(name: str, out: Path, quiet: bool) -> dict[str, Any]:
    """Draw a figure and print the numbers behind it."""
    figure = FIGURES[name]()
    save(figure.picture, out / f"{name}.png")
    if not quiet:
        print_figure(name, figure)
        print_path(out / f"{name}.png")
    return {"caption": figure.caption, "rows": [asdict(quantity) for quantity in figure.quantities]}


def print_figure(name: str, figure: PaperFigure) -> None:
    """Print to stdout: the caption, and the numbers of each scheme as a table."""
    console = Console()
    title = f"Figure {name.removeprefix('fig')}: {figure.caption}"
    console.print(title, style="bold", highlight=False, soft_wrap=True)
    for scheme in dict.fromkeys(row.scheme for row in figure.quantities):
        grid = Table()
        grid.add_column(scheme, no_wrap=True)
        grid.add_column("value", justify="right", no_wrap=True)
        grid.add_column("unit", no_wrap=True)
        for row in figure.quantities:
            if row.scheme == scheme:
                grid.add_row(row.quantity, f"{row.value:.5g}", "" if row.unit == "1" else row.unit)
        console.print(grid)


def print_path(path: Path) -> None:
    """Print where the result is."""
    Console(soft_wrap=True).print(str(path), highlight=False)


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
        grid.add_column(escape(heading), justify="right", no_wrap=True)
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
