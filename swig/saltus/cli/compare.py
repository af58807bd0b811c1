"""``saltus compare`` and ``saltus converge``: what is printed and written; saltus.compare does the work."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeAlias

from rich.markup import escape
from rich.table import Table

from saltus.cli.junit import to_junit
from saltus.cli.out import require_picture, require_targets, save, wide_console, write
from saltus.cli.progress import progress_bar
from saltus.compare import Comparison, Row, compare, converge
from saltus.registry import split_specs

Columns: TypeAlias = dict[str, Callable[[Row], str]]

#: heading, and the text of a row
MOTION: Columns = {
    "error q": lambda row: number(row.error_q),
    "error v": lambda row: number(row.error_v),
    "spectral": lambda row: number(row.spectral),
    "order": lambda row: number(row.order, ".2f"),
    "energy drift": lambda row: number(row.energy_drift, ".2g"),
    "penetration": lambda row: number(row.penetration, ".2g"),
    "residual": lambda row: number(row.residual, ".1e"),
    "µs/step": lambda row: number(row.us_per_step, ".3f"),
    "slowdown": lambda row: number(row.slowdown, ".2f"),
}
CONTACTS: Columns = {
    "impulsive steps": lambda row: f"{row.impulsive_steps} of {row.steps}",
    "closed contacts": lambda row: number(row.closed, ".3f"),
    "impacts": lambda row: f"{row.impacts}, reference {row.reference_impacts}",
    "unmatched": lambda row: str(row.unmatched),
    "time error [s]": lambda row: number(row.impact_time_error, ".2g"),
    "impulse error": lambda row: number(row.impulse_error, ".2g"),
}


def run(
    model: str,
    integrators: str,
    time_steps: str,
    *,
    json_to: Path | None,
    junit_to: Path | None,
    markdown_to: Path | None,
    **settings: Any,
) -> bool:
    """Compare, print, and write the files that are wanted ("-" is stdout, which then has nothing else).

    Returns
    -------
    bool
        Do all limits hold?

    Raises
    ------
    ValueError, OSError
        If something given makes no sense, or a file cannot be read or written; nothing is computed then.
    """
    targets = {"json": json_to, "junit": junit_to, "markdown": markdown_to}
    quiet = require_targets([path for path in targets.values() if path is not None])
    with progress_bar() as show:
        found = compare(
            model,
            split_specs(integrators),
            time_steps=to_numbers(time_steps, "time steps"),
            progress=show,
            **settings,
        )
    makers = {"json": to_json_text, "junit": to_junit, "markdown": to_markdown}
    for name, path in targets.items():
        if path is not None:
            write(makers[name](found), path)
    if not quiet:
        print_comparison(found)
    return found.ok


def run_converge(
    model: str, integrators: str, time_steps: str, *, picture: Path, json_to: Path | None, **settings: Any
) -> None:
    """Measure orders, print and draw them. Raises as `run`."""
    quiet = require_targets([picture, *([] if json_to is None else [json_to])])
    require_picture(picture)
    with progress_bar() as show:
        found = converge(
            model,
            split_specs(integrators),
            time_steps=to_numbers(time_steps, "time steps"),
            progress=show,
            **settings,
        )
    from saltus.cli.converge import draw, orders

    save(draw(found), picture)
    if json_to is not None:
        content = [{**comparison.to_json(), "orders": orders(comparison)} for comparison in found]
        write(json.dumps({"comparisons": content}, indent=2, ensure_ascii=False) + "\n", json_to)
    if quiet:
        return
    for comparison in found:
        print_comparison(comparison)
        for what, order in orders(comparison).items():
            wide_console().print(f"order of {what}: {number(order, '.2f')}", highlight=False)
    wide_console().print(f"{picture}  picture", highlight=False)


def to_numbers(text: str, what: str) -> list[float]:
    """Numbers between commas. Raises ValueError if there is something else."""
    try:
        return [float(part) for part in text.split(",") if part.strip()]
    except ValueError:
        raise ValueError(f"{what} must be numbers between commas, got '{text}'") from None


def number(value: float | None, form: str = ".4g") -> str:
    """A short text, a dash for what cannot be told."""
    return "–" if value is None else format(value, form)


def print_comparison(found: Comparison) -> None:
    """Print to stdout: motion and cost, contacts, warnings and limits."""
    console = wide_console()
    console.print(title(found), style="bold", highlight=False, soft_wrap=True)
    for columns in (MOTION, CONTACTS):
        console.print(grid_of(found, columns))
    for name, reason in found.refused.items():
        console.print(f"{name} left out: {reason}", highlight=False, soft_wrap=True, markup=False)
    for warning in found.warnings:
        console.print(f"warning: {warning}", style="yellow", highlight=False, soft_wrap=True, markup=False)
    for breach in found.breaches:
        console.print(f"BROKEN  {breach.message}", style="red", highlight=False, soft_wrap=True, markup=False)
    if found.limits and found.ok:
        console.print(f"all limits hold: {limits_of(found)}", style="green", highlight=False, soft_wrap=True)


def title(found: Comparison) -> str:
    """What is compared with what."""
    baseline = [row.integrator for row in found.rows if row.baseline]
    against = f", baseline {baseline[0]}" if baseline else ""
    reference = f"{found.reference}@{found.reference_step:g}"
    return f"{found.model} until {found.until:g} s, reference {reference}{against}"


def limits_of(found: Comparison) -> str:
    """The limits as they were given."""
    return ", ".join(f"{name} {limit:g}" for name, limit in found.limits.items())


def grid_of(found: Comparison, columns: Columns) -> Table:
    """A table of all rows; "?" marks errors that the reference is not clearly better than."""
    grid = Table()
    grid.add_column("integrator", no_wrap=True)
    for heading in ("Δt [s]", *columns):
        grid.add_column(escape(heading), justify="right", no_wrap=True)
    for before, row in zip([found.rows[0], *found.rows], found.rows, strict=False):
        if before.integrator != row.integrator:
            grid.add_section()
        grid.add_row(*cells(found, row, columns), style="dim" if row.baseline else None)
    return grid


def cells(found: Comparison, row: Row, columns: Columns) -> list[str]:
    """The texts of a row."""
    texts = {heading: text(row) for heading, text in columns.items()}
    moves = found.reference_moves
    if "error q" in texts and moves is not None and row.error_q is not None and 10 * moves > row.error_q:
        texts["error q"] += " ?"
    return [row.integrator, f"{row.time_step:g}", *texts.values()]


def to_json_text(found: Comparison) -> str:
    """All figures as JSON."""
    return json.dumps(found.to_json(), indent=2, ensure_ascii=False) + "\n"


def to_markdown(found: Comparison) -> str:
    """A table for comments on merge requests, with warnings and broken limits."""
    columns = {**MOTION, **CONTACTS}
    lines = [f"**{title(found)}**", ""]
    lines.append("| integrator | Δt [s] | " + " | ".join(columns) + " |")
    lines.append("|---|" + "---:|" * (len(columns) + 1))
    lines += ["| " + " | ".join(cells(found, row, columns)) + " |" for row in found.rows]
    notes = [f"{name} left out: {reason}" for name, reason in found.refused.items()]
    notes += [f"warning: {warning}" for warning in found.warnings]
    notes += [f"**broken:** {breach.message}" for breach in found.breaches]
    if found.limits and found.ok:
        notes.append(f"all limits hold: {limits_of(found)}")
    return "\n".join([*lines, "", *(f"- {note}" for note in notes)]).rstrip() + "\n"
