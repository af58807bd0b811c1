"""Examples that show themselves.

The module NAME/NAME.py of an example has a function ``run()``, which returns the run that it shows,
``picture(run())``, which draws it, ``CAPTION``, what should be seen there, and ``WATCH``, what should be seen
in the page ``run().report(PATH)``. Drawing takes a second to load: ``picture`` imports it, so that models do
without.
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, cast

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from saltus.io import Trajectory


class Example(Protocol):
    """What the module of an example offers."""

    __name__: str
    __doc__: str | None
    CAPTION: str
    WATCH: str

    def run(self) -> Trajectory:
        """The run that is shown."""

    def picture(self, shown: Trajectory, /) -> Figure:
        """Draw it."""


def examples() -> dict[str, Example]:
    """All examples by name, in alphabetical order."""
    files = Path(__file__).parent.glob("*/*.py")
    names = sorted(file.stem for file in files if file.stem == file.parent.name)
    modules = {name: import_module(f"saltus.examples.{name}.{name}") for name in names}
    return {name: cast("Example", module) for name, module in modules.items() if hasattr(module, "CAPTION")}
