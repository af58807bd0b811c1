"""The command ``saltus``."""

from __future__ import annotations

import sys
from enum import Enum
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from saltus import __version__

app = typer.Typer(add_completion=False, no_args_is_help=True, pretty_exceptions_enable=False)


class Target(str, Enum):
    """What can be reproduced of the paper."""

    table2 = "table2"
    table3 = "table3"
    fig4 = "fig4"
    fig5 = "fig5"
    fig7 = "fig7"
    fig8 = "fig8"
    fig10 = "fig10"
    fig11 = "fig11"
    all = "all"


def _print_version(wanted: bool) -> None:
    if wanted:
        print(f"saltus {__version__}")
        raise typer.Exit


@app.callback()
def saltus(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Simulate mechanical systems whose velocities jump: contact, impact, dry friction."""


@app.command()
def demo(
    out: Annotated[Path, typer.Option(help="Folder of the results.")] = Path("out/demo"),
) -> None:
    """Run the frictional slider crank: Table 3 of the paper, a trajectory and a picture."""
    from saltus.cli.demo import run  # plotting takes a second to load: only where it is needed

    run(out)


@app.command()
def reproduce(
    what: Annotated[Target, typer.Argument(help="A table or figure of the paper, or all of them.")],
    out: Annotated[Path, typer.Option(help="Folder of the results.")] = Path("out/paper"),
    json: Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")] = False,
) -> None:
    """Compute tables and figures of the paper, print their numbers, and keep them as JSON and PNG."""
    from saltus.cli.reproduce import run

    run(what.value, out, as_json=json)


@app.command()
def bench(
    models: Annotated[
        list[str] | None, typer.Argument(metavar="[MODEL]...", help="Models to run; all if none is named.")
    ] = None,
    integrator: Annotated[
        list[str] | None,
        typer.Option(help="An integrator, also of a plugin or a Python file; all if none is named."),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")] = False,
) -> None:
    """Measure the time of a step: every integrator on models in C++, beside a loop written by hand."""
    from saltus.cli.bench import run

    run(models or [], integrator or [], as_json=json)


@app.command()
def conformance(
    integrators: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[INTEGRATOR]...",
            help="Names, library:Class or file.py:Class; all registered if none is given.",
        ),
    ] = None,
) -> None:
    """Measure whether integrators keep what their line in the table says; exit status 1 if one does not."""
    from saltus import kernel
    from saltus.conformance import findings

    console = Console(soft_wrap=True)
    broken = 0
    for name in integrators or [entry["name"] for entry in kernel.integrators()]:
        console.print(name, style="bold", markup=False)
        for finding in findings(name):
            console.print(str(finding), highlight=False, markup=False, style=None if finding.ok else "red")
            broken += not finding.ok
    raise typer.Exit(code=1 if broken else 0)


def main() -> None:
    """Run the command; an error that a user can mend is one line on stderr."""
    try:
        app()
    except ValueError as error:
        _fail(str(error))
    except OSError as error:
        text = error.strerror or str(error)
        _fail(f"{error.filename}: {text}" if error.filename else text)


def _fail(text: str) -> None:
    Console(stderr=True, soft_wrap=True).print(f"saltus: {text}", style="red", markup=False)
    sys.exit(1)
