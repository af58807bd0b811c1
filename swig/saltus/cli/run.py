"""``saltus run``."""

from __future__ import annotations

import sys
import traceback
from pathlib import Path

from rich.console import Console

from saltus import registry
from saltus.first_order import SCHEMES, make_scheme
from saltus.kernel import SimulationError
from saltus.siconos.script import run_script
from saltus.siconos.simulation import Changes

_WRITERS = {".h5": "to_hdf5", ".hdf5": "to_hdf5", ".csv": "to_csv"}


def run(script: Path, arguments: list[str], changes: Changes, record: Path | None) -> bool:
    """Run the script, write what its simulations recorded. @return False if the script ended with an error.

    Raises ValueError on misuse, before the script runs.
    """
    if changes.integrator is not None:
        first_order = registry.parse(changes.integrator)[0] in SCHEMES
        make = make_scheme if first_order else registry.make_integrator
        make(changes.integrator)
    if changes.solver is not None:
        registry.solver(changes.solver)
    for name, value in (("--time-step", changes.time_step), ("--until", changes.until)):
        if value is not None and not 0 < value < float("inf"):
            raise ValueError(f"{name} must be positive and finite, got {value:g}")
    if record is not None and record.suffix not in _WRITERS:
        raise ValueError(f"--record must end in one of {', '.join(_WRITERS)}, got '{record}'")
    if not script.is_file():
        raise ValueError(f"expected a Python script, there is no file '{script}'")
    try:
        run_script(script, changes, arguments)
    except Exception as error:
        _report(script, error)
        return False
    finally:
        if record is not None:
            _write(changes, record)
    return True


def _report(script: Path, error: Exception) -> None:
    """The error and the script's own line, not the frames between."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if Path(frame.filename).resolve() == script.resolve()]
    place = f", line {own[-1].lineno}" if own else ""
    kind = "" if isinstance(error, SimulationError) else f"{type(error).__name__}: "
    console = Console(stderr=True, soft_wrap=True)
    console.print(f"saltus: {script}{place}: {kind}{error}", style="red", markup=False)
    if isinstance(error, ModuleNotFoundError) and (error.name or "").startswith("siconos."):
        console.print("saltus: siconos.kernel and siconos.numerics are there", style="red", markup=False)


def _write(changes: Changes, record: Path) -> None:
    """The simulations in FILE, FILE-2, ..."""
    runs = [simulation for simulation in changes.simulations if simulation.started]
    if not runs:
        print(f"nothing is written to '{record}': the script made no simulation", file=sys.stderr)
    for k, simulation in enumerate(runs, start=1):
        path = record if k == 1 else record.with_stem(f"{record.stem}-{k}")
        getattr(simulation.trajectory, _WRITERS[record.suffix])(path)
        print(f"{path}: {len(simulation.trajectory)} rows", file=sys.stderr)
