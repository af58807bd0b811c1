"""The command ``saltus``."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from enum import Enum
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from typer.core import TyperGroup

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
    fig13 = "fig13"
    fig14 = "fig14"
    fig15 = "fig15"
    work_precision = "work-precision"
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
    """Run the frictional slider crank: Table 3 of the paper, a trajectory, a picture and a page."""
    from saltus.cli.demo import run  # plotting takes a second to load: only where it is needed

    run(out)


@app.command()
def reproduce(
    what: Annotated[
        Target,
        typer.Argument(help="A table or figure of the paper, all of them, or error against computing time."),
    ],
    out: Annotated[Path, typer.Option(help="Folder of the results.")] = Path("out/paper"),
    json: Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")] = False,
) -> None:
    """Compute tables and figures of the paper, print their numbers, and keep them as JSON and PNG."""
    from saltus.cli.reproduce import run

    run(what.value, out, as_json=json)


class _Bench(TyperGroup):
    """Words that name nothing to measure are those of `models`."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        named = args and args[0] in (*self.commands, "--help")
        return super().parse_args(ctx, args if named else ["models", *args])


bench = typer.Typer(cls=_Bench)
app.add_typer(
    bench, name="bench", help="Measure the time of a step, `bench models` or `bench`, or of a solve."
)


@bench.command(name="models")
def bench_models(
    models: Annotated[
        list[str] | None, typer.Argument(metavar="[MODEL]...", help="Models to run; all if none is named.")
    ] = None,
    integrator: Annotated[
        list[str] | None,
        typer.Option(help="An integrator, also of a plugin or a Python file; all if none is named."),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")] = False,
) -> None:
    """Measure the time of a step: every integrator on every model, beside a loop written by hand.

    Integrators that cannot take a model, or are unstable at its time step, are named instead.
    """
    from saltus.cli.bench import run

    with _misuse():
        run(models or [], integrator or [], as_json=json)


JsonFile = Annotated[
    Path | None, typer.Option("--json", metavar="FILE", help="Write JSON; - prints it and nothing else.")
]


@bench.command(name="solvers")
def bench_solvers(
    folder: Annotated[
        Path | None,
        typer.Argument(
            metavar="DIR", help="Problems: its .dat, .hdf5 and .h5 files; random ones if it is not given."
        ),
    ] = None,
    solvers: Annotated[
        str,
        typer.Option(metavar="A,B,…", help="NAME, library:Class or file.py:Class; default: all."),
    ] = "",
    tolerances: Annotated[
        str, typer.Option(metavar="TOL,TOL,…", help="Bounds on the residual of what is solved.")
    ] = "1e-4,1e-8,1e-12",
    time_out: Annotated[float, typer.Option(help="Of a solve, in s.")] = 10.0,
    json: JsonFile = None,
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Picture: performance profiles of Dolan and Moré.")
    ] = None,
) -> None:
    """Compare contact solvers on problems: what they solve, in which time, and performance profiles."""
    from saltus.cli.bench_solvers import run

    with _misuse():
        run(folder, solvers, tolerances, time_out=time_out, json_to=json, picture=out)


ModelArgument = Annotated[
    str,
    typer.Argument(
        metavar="MODEL",
        help="A name (`saltus models`), file.py with build(), library:function, script for Siconos.",
    ),
]
Integrators = Annotated[
    str,
    typer.Option(
        metavar="A,B,…", help="NAME, NAME(option=value), library:Class or file.py:Class; default: all."
    ),
]
TimeSteps = Annotated[str, typer.Option(metavar="DT,DT,…", help="Time steps in s; default: the model's.")]
Until = Annotated[float | None, typer.Option(help="End of the runs in s; default: the model's.")]
Reference = Annotated[
    str | None, typer.Option(metavar="INTEGRATOR@DT|FILE", help="The run, or its HDF5 file, to compare with.")
]


@app.command()
def models() -> None:
    """List the models that bench, compare and converge know by name."""
    from rich.markup import escape
    from rich.table import Table

    from saltus.models import MODELS

    table = Table()
    for heading in ("model", "Δt [s]", "until [s]", "summary"):
        table.add_column(escape(heading), no_wrap=heading != "summary")
    for entry in MODELS.values():
        table.add_row(entry.name, f"{entry.time_step:g}", f"{entry.until:g}", entry.summary)
    Console().print(table)


@app.command()
def run(
    script: Annotated[Path, typer.Argument(help="A Python script that imports siconos.kernel.")],
    arguments: Annotated[
        list[str] | None,
        typer.Argument(metavar="[-- ARGUMENT...]", help="What the script finds in sys.argv."),
    ] = None,
    integrator: Annotated[
        str | None,
        typer.Option(help="NAME, NAME(option=value), library:Class or file.py:Class, in place of its own."),
    ] = None,
    solver: Annotated[
        str | None, typer.Option(help="NAME, library:Class or file.py:Class, in place of its own.")
    ] = None,
    time_step: Annotated[
        float | None,
        typer.Option(help="In s. A smaller one must be a whole fraction: the script sees every n-th step."),
    ] = None,
    until: Annotated[float | None, typer.Option(help="End in s, in place of its own.")] = None,
    record: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write every step to a .h5, .hdf5 or .csv file.")
    ] = None,
) -> None:
    """Run a script written for Siconos as it is, or with another integrator, solver, time step or end.

    Exit status 0, 1 if the script ends with an error, 2 on misuse.
    """
    from saltus.cli.run import run as run_it
    from saltus.siconos.simulation import Changes

    with _misuse():
        ok = run_it(script, arguments or [], Changes(integrator, solver, time_step, until), record)
    raise typer.Exit(code=0 if ok else 1)


@app.command()
def report(
    run: Annotated[Path, typer.Argument(metavar="RUN.h5", help="A run in an HDF5 file.")],
    out: Annotated[
        Path | None, typer.Option(metavar="PAGE.html", help="The page; default: beside the run.")
    ] = None,
    title: Annotated[str | None, typer.Option(help="Its heading; default: the name of the run.")] = None,
    caption: Annotated[str | None, typer.Option(help="What there is to see.")] = None,
) -> None:
    """Write a page for the browser: animation, plots with zoom, and what each contact does."""
    from saltus.io import read_any

    with _misuse():
        page = read_any(run).report(out or run.with_suffix(".html"), title=title or run.stem, caption=caption)
    Console(soft_wrap=True).print(str(page), highlight=False)


@app.command()
def export(
    run: Annotated[Path, typer.Argument(metavar="RUN.h5", help="A run in an HDF5 file.")],
    vtk: Annotated[Path, typer.Option(metavar="DIR", help="Folder of the files for ParaView.")],
    every: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            help="Every N-th row, and all with an impact; default: 300 rows, and at most 300 with an impact.",
        ),
    ] = None,
) -> None:
    """Write a run for ParaView: shapes and contacts with what acts in them, and their times."""
    from saltus.io import read_hdf5

    with _misuse():
        try:
            collections = read_hdf5(run).to_vtk(vtk, every)
        except ImportError as error:
            raise ValueError(str(error)) from error
        for collection in collections:
            Console(soft_wrap=True).print(str(collection), highlight=False)


@app.command()
def compare(
    model: ModelArgument,
    integrators: Integrators = "",
    baseline: Annotated[str, typer.Option(metavar="INTEGRATOR", help="What time is compared with.")] = (
        "MoreauJeanOSI"
    ),
    time_steps: TimeSteps = "",
    until: Until = None,
    reference: Reference = None,
    max_error: Annotated[float | None, typer.Option(help="Of q, and of v away from jumps, scaled.")] = None,
    max_energy_drift: Annotated[float | None, typer.Option(help="Over the largest kinetic energy.")] = None,
    max_impulse_error: Annotated[float | None, typer.Option(help="Over the largest impulse.")] = None,
    max_penetration: Annotated[float | None, typer.Option(help="In m.")] = None,
    max_slowdown: Annotated[float | None, typer.Option(help="Time of a step over the baseline's.")] = None,
    min_order: Annotated[float | None, typer.Option(help="Of the slope over all time steps.")] = None,
    json: JsonFile = None,
    junit: Annotated[Path | None, typer.Option(metavar="FILE", help="Write JUnit XML; - prints it.")] = None,
    markdown: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write a Markdown table; - prints it.")
    ] = None,
) -> None:
    """Compare integrators with Moreau-Jean and a reference: the check for CI, the way to choose one.

    Exit status 0 if all limits hold, 1 if one is broken or a run ends early, 2 on misuse.
    """
    from saltus.cli.compare import run

    with _misuse():
        ok = run(
            model,
            integrators,
            time_steps,
            json_to=json,
            junit_to=junit,
            markdown_to=markdown,
            baseline=baseline,
            until=until,
            reference=reference,
            max_error=max_error,
            max_energy_drift=max_energy_drift,
            max_impulse_error=max_impulse_error,
            max_penetration=max_penetration,
            max_slowdown=max_slowdown,
            min_order=min_order,
        )
    raise typer.Exit(code=0 if ok else 1)


@app.command()
def converge(
    model: ModelArgument,
    time_steps: Annotated[str, typer.Option(metavar="DT,DT,…", help="At least two time steps in s.")],
    integrators: Integrators = "",
    until: Until = None,
    reference: Reference = None,
    picture: Annotated[Path, typer.Option(metavar="FILE", help="Errors over the time step.")] = Path(
        "out/converge.png"
    ),
    json: JsonFile = None,
) -> None:
    """Measure orders of convergence, against a reference or the integrator's own run, 100 times finer."""
    from saltus.cli.compare import run_converge

    with _misuse():
        run_converge(
            model, integrators, time_steps, picture=picture, json_to=json, until=until, reference=reference
        )


@app.command()
def sweep(
    study: Annotated[
        Path, typer.Argument(metavar="STUDY.py", help="A file with build(**parameters) and PARAMETERS.")
    ],
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder of the results; default: out/sweep/STUDY.")
    ] = None,
    workers: Annotated[
        int | None, typer.Option(metavar="N", help="Processes on this machine; default: one a core.")
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="A dask scheduler, whose workers make the runs.")
    ] = None,
    time_out: Annotated[float | None, typer.Option(help="Of a run, in s.")] = None,
    keep: Annotated[bool, typer.Option("--keep", help="Keep every trajectory, HDF5.")] = False,
    retry_failed: Annotated[bool, typer.Option("--retry-failed", help="Make failed runs again.")] = False,
    json: Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")] = False,
) -> None:
    """Run a study over parameters, integrators and time steps: a table and a picture.

    What is there already is not made again, so that a sweep that was stopped goes on where it was.
    Exit status 0 if every run has a result, 1 if one failed, 2 on misuse, 130 after Ctrl-C.
    """
    from saltus.cli.sweep import run

    with _misuse():
        try:
            ok = run(
                study,
                out,
                as_json=json,
                workers=workers,
                scheduler=scheduler,
                time_out=time_out,
                keep=keep,
                retry_failed=retry_failed,
            )
        except KeyboardInterrupt:
            _fail("stopped; what was done is kept, and the same command goes on", 130)
    raise typer.Exit(code=0 if ok else 1)


@app.command()
def conformance(
    integrators: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[INTEGRATOR]...",
            help="NAME, NAME(option=value), library:Class or file.py:Class; all registered if none is given.",
        ),
    ] = None,
    cost: Annotated[
        bool, typer.Option("--cost", help="Time a step as well, as `saltus bench` does.")
    ] = False,
    json: Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")] = False,
) -> None:
    """Measure whether integrators keep what their line in the table says, and figures to choose them by.

    Exit status 0 if they do, 1 if one does not, 2 if there is none of that name.
    """
    from saltus.cli.conformance import run

    with _misuse():
        ok = run(integrators or [], cost=cost, as_json=json)
    raise typer.Exit(code=0 if ok else 1)


def main() -> None:
    """Run the command; an error that a user can mend is one line on stderr."""
    with _one_line(1):
        app()


def _misuse() -> AbstractContextManager[None]:
    """Where 1 says that a limit is broken, misuse is 2."""
    return _one_line(2)


@contextmanager
def _one_line(status: int) -> Iterator[None]:
    try:
        yield
    except ValueError as error:
        _fail(str(error), status)
    except OSError as error:
        text = error.strerror or str(error)
        _fail(f"{error.filename}: {text}" if error.filename else text, status)


def _fail(text: str, status: int) -> None:
    Console(stderr=True, soft_wrap=True).print(f"saltus: {text}", style="red", markup=False)
    sys.exit(status)
