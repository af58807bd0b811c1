"""``saltus conformance``: what is printed; saltus.conformance does the work."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, replace
from math import isfinite
from typing import Any

import numpy as np
from rich.console import Console

from saltus import kernel, registry
from saltus.cli.bench import REPEATS, time_bare_loop, time_loop
from saltus.conformance import Finding, findings
from saltus.examples.slider_crank import slider_crank
from saltus.models import MODELS


def run(specs: Sequence[str], *, cost: bool, as_json: bool) -> bool:
    """Measure integrators, all registered if none is named, and print what is found.

    Returns
    -------
    bool
        Do they keep what they claim?

    Raises
    ------
    ValueError
        If there is none of that name.
    """
    console = Console(soft_wrap=True, quiet=as_json)
    content, ok = [], True
    for spec in specs:  # before anything is measured
        registry.make_integrator(spec)
    for spec in specs or [entry["name"] for entry in kernel.integrators()]:
        console.print(spec, style="bold", markup=False)
        found = []
        for finding in _all(spec, cost):
            console.print(str(finding), highlight=False, markup=False, style=None if finding.ok else "red")
            found.append(finding)
        kept = all(finding.ok for finding in found)
        content.append({"integrator": spec, "ok": kept, "findings": [_to_json(f) for f in found]})
        ok = ok and kept
    if as_json:
        print(json.dumps({"ok": ok, "integrators": content}, indent=2, ensure_ascii=False))
    return ok


def _all(spec: str, cost: bool) -> Iterator[Finding]:
    yield from findings(spec)
    if cost:
        yield cost_of_a_step(spec)


def cost_of_a_step(spec: str) -> Finding:
    """Of the slider crank in C++ as in ``saltus bench``; without friction if the scheme takes none."""
    model, friction = MODELS["slider-crank"], registry.properties(spec)["friction"]
    if not friction:
        model = replace(model, build=lambda: slider_crank.build("frictionless"))
    # In turn, so that a disturbance of the machine does not hit one of them alone.
    seconds, bare = np.median(
        [(time_loop(model, spec), time_bare_loop(model)) for _ in range(REPEATS)], axis=0
    )
    note = f"{seconds / bare:.1f} times the bare loop" if friction else "without friction"
    return Finding("slider crank: µs a step", float(1e6 * seconds / model.steps), note=note)


def _to_json(finding: Finding) -> dict[str, Any]:
    """`expected` is null for a mere figure, `measured` if it is no number."""
    measured = finding.measured if isfinite(finding.measured) else None
    return {**asdict(finding), "measured": measured, "expected": finding.expected or None}
