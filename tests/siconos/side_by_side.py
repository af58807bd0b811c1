"""Scripts of this folder by Saltus and by Siconos: what a step costs, and how far they are apart.

    python tests/siconos/side_by_side.py [SCRIPT]...

prints a table, of all that both can run if none is named. The time is that of the calls that take a step,
without what the script does between them, the median of five runs. Needs Debian's python3-siconos.
"""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
from pathlib import Path
from typing import Any

SCRIPTS = Path(__file__).parent / "scripts"
SICONOS = "/usr/bin/python3"  # Debian's packages are not seen by others
RUNS = 5
# Siconos 4.4 has no hDot() to write into and no Equality from Python; the last needs a library.
ALONE = ("moving_floor", "rod", "plugin_pendulum")

# Runs in either Python: prints the script's dataPlot, and seconds and number of its steps.
CHILD = """
import json, runpy, sys, time
if sys.argv[2] == "saltus":
    from saltus.siconos import kernel, numerics
    import saltus.siconos
    sys.modules.update({"siconos": saltus.siconos, "siconos.kernel": kernel, "siconos.numerics": numerics})
import siconos.kernel as sk

seconds, calls = 0.0, {}

def timed(cls, name):
    method = getattr(cls, name)
    def call(*arguments):
        global seconds
        start = time.perf_counter()
        try:
            return method(*arguments)
        finally:
            seconds += time.perf_counter() - start
            calls[name] = calls.get(name, 0) + 1
    setattr(cls, name, call)

for cls, names in ((sk.TimeStepping, ("computeOneStep", "advanceToEvent", "nextStep")),
                   (sk.EventDriven, ("advanceToEvent", "processEvents"))):
    for name in names:
        timed(cls, name)
data = runpy.run_path(sys.argv[1])["dataPlot"].tolist()
print(json.dumps({"data": data, "seconds": seconds, "steps": max(calls.values(), default=0)}))
"""


def run(python: str, who: str, script: Path) -> dict[str, Any]:
    """Run a script once. Raises CalledProcessError if it cannot be run."""
    command = [python, "-c", CHILD, str(script), who]
    out = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    result: dict[str, Any] = json.loads(out.splitlines()[-1])
    return result


def difference(ours: list[list[float]], theirs: list[list[float]]) -> float:
    """The largest of all columns, over their scales in `theirs`."""
    columns = zip(zip(*ours, strict=True), zip(*theirs, strict=True), strict=True)
    return max(
        max(abs(a - b) for a, b in zip(mine, other, strict=True)) / max(abs(b) for b in other)
        for mine, other in columns
    )


def row(script: Path) -> str:
    """A line of the table."""
    runs = [(run(sys.executable, "saltus", script), run(SICONOS, "siconos", script)) for _ in range(RUNS)]
    first, second = runs[0]
    off = difference(first["data"], second["data"])
    if not first["steps"]:
        return f"| {script.stem} | – | – | {off:.1e} |"
    ours, theirs = (
        statistics.median(1e6 * pair[k]["seconds"] / pair[k]["steps"] for pair in runs) for k in (0, 1)
    )
    return f"| {script.stem} | {ours:.1f} | {theirs:.1f} | {off:.1e} |"


def main() -> None:
    both = (file for file in sorted(SCRIPTS.glob("*.py")) if file.stem not in ALONE)
    scripts = [SCRIPTS / f"{name}.py" for name in sys.argv[1:]] or list(both)
    print("| script | Saltus [µs a step] | Siconos | largest difference |\n|---|---|---|---|")
    for script in scripts:
        try:
            print(row(script), flush=True)
        except subprocess.CalledProcessError as error:
            print(f"| {script.stem} | {(error.stderr or '').strip().splitlines()[-1:]} |", flush=True)


if __name__ == "__main__":
    main()
