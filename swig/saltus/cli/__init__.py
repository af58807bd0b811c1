"""The command ``saltus``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from saltus import __version__
from saltus.cli import demo as demo_command
from saltus.cli import reproduce as reproduce_command

app = typer.Typer(add_completion=False, no_args_is_help=True, pretty_exceptions_enable=False)


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
    demo_command.run(out)


@app.command()
def reproduce(
    what: Annotated[reproduce_command.Target, typer.Argument(help="What to reproduce of the paper.")],
    json: Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")] = False,
) -> None:
    """Compute a table of the paper and print it beside the printed values."""
    reproduce_command.run(what, as_json=json)


def main() -> None:
    """Run the command; an error that a user can mend is one line on stderr."""
    try:
        app()
    except (ValueError, OSError) as error:
        text = getattr(error, "strerror", None) or str(error)
        Console(stderr=True, soft_wrap=True).print(f"saltus: {text}", style="red", markup=False)
        sys.exit(1)
