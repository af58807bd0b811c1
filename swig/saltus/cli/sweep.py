"""``saltus sweep``: what is printed; saltus.sweep does the work."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rich.console import Console

from saltus.cli.progress import sweep_progress
from saltus.sweep import Sweep, run_study

MOST_FAILURES = 10  #: that are printed, the table has all


def run(study: Path, out: Path | None, *, as_json: bool, **settings: Any) -> bool:
    """Make the missing runs and print what there is. @return True if every run has a result.

    Raises ValueError, OSError as `run_study`, ValueError also if a package is missing. Raises
    KeyboardInterrupt after Ctrl-C.
    """
    try:
        with sweep_progress() as show:
            found = run_study(study, out, progress=show, **settings)
    except ImportError as error:
        raise ValueError(str(error)) from error
    if as_json:
        print(json.dumps(to_json(found), indent=2, ensure_ascii=False))
    print_summary(found, Console(stderr=as_json, soft_wrap=True, highlight=False))
    return not found.failed


def to_json(found: Sweep) -> dict[str, Any]:
    """Where the results are, numbers of runs, and failures."""
    return {
        "table": str(found.table),
        "csv": str(found.folder / "table.csv"),
        "times": str(found.folder / "times.csv"),
        "picture": str(found.folder / "sweep.png"),
        "runs": len(found.records),
        "made": found.made,
        "other_runs": found.other_runs,
        "status": dict(Counter(record["status"] for record in found.records)),
        "failures": [
            {name: record[name] for name in ("id", "parameters", "integrator", "time_step", "status")}
            | {name: record[name] for name in ("error", "message")}
            for record in found.failed
        ],
    }


def print_summary(found: Sweep, console: Console) -> None:
    """Numbers of runs, the first failures, and where the results are."""
    there = len(found.records) - len(found.failed)
    console.print(f"{there} of {len(found.records)} runs have a result, {found.made} made now")
    if found.other_runs:
        console.print(
            f"{found.other_runs} runs in '{found.folder / 'runs'}' are of another state of the study, "
            "or another version of Saltus, and not used"
        )
    for record in found.failed[:MOST_FAILURES]:
        console.print(f"{record['status']}  {_name(record)}: {_said(record)}", style="red", markup=False)
    if len(found.failed) > MOST_FAILURES:
        console.print(f"{len(found.failed) - MOST_FAILURES} more: see the table", style="red")
    if found.failed:
        console.print("failed runs stay as they are; --retry-failed makes them again")
    for path in (found.table, found.folder / "table.csv", found.folder / "sweep.png"):
        console.print(str(path), markup=False)


def _name(record: Mapping[str, Any]) -> str:
    parameters = [f"{name} = {value}" for name, value in record["parameters"].items()]
    return ", ".join([*parameters, record["integrator"], f"Δt = {record['time_step']:g} s"])


def _said(record: Mapping[str, Any]) -> str:
    return f"{record['error']}: {str(record['message']).partition(chr(10))[0]}"
