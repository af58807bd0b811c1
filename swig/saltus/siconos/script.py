"""Scripts written for Siconos, run as they are."""

from __future__ import annotations

import ast
import importlib
import io
import os
import runpy
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from pathlib import Path
from typing import Any

from saltus.siconos import simulation
from saltus.siconos.simulation import Changes, Composed, TimeStepping

_NAMES = {name: f"saltus.{name}" for name in ("siconos", "siconos.kernel", "siconos.numerics")}


def run_script(
    path: str | os.PathLike[str], changes: Changes, arguments: list[str] | None = None
) -> dict[str, Any]:
    """Run a Python file as the main program; its ``import siconos.kernel`` is `saltus.siconos.kernel`.

    Siconos need not be there, and is not imported if it is. Pictures of Matplotlib are not shown.
    The simulations that the script makes are then in `changes`, also if it ends with an error.

    Parameters
    ----------
    path : the script
    changes : what is changed in its simulations
    arguments : what it finds in ``sys.argv[1:]``

    Returns
    -------
    dict
        The names that the script defined.

    Raises
    ------
    ValueError
        If there is no such file.
    """
    file = Path(path)
    if not file.is_file():
        raise ValueError(f"expected a Python script, there is no file '{os.fspath(path)}'")
    simulation.change(changes)
    try:
        with _in_place_of_siconos(), _as_program(file, arguments or []):
            return runpy.run_path(str(file), run_name="__main__")
    finally:
        simulation.change(None)


def is_script(path: str | os.PathLike[str]) -> bool:
    """Say whether a Python file imports siconos, and is no model of Saltus with a ``build()``."""
    try:
        tree = ast.parse(Path(path).read_bytes())
    except (OSError, SyntaxError, ValueError):
        return False
    imported: list[str] = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            imported += [name.name for name in node.names]
        elif isinstance(node, ast.ImportFrom):
            imported.append(node.module or "")
    defined = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
    return "build" not in defined and any(name.partition(".")[0] == "siconos" for name in imported)


def compose(path: str | os.PathLike[str]) -> TimeStepping:
    """Run a script until its first simulation would take a step; what it prints is not shown.

    Raises
    ------
    ValueError
        If there is no such file, it ends before, or with an error.
    """
    text = os.fspath(path)
    try:
        with redirect_stdout(io.StringIO()):
            run_script(path, Changes(compose=True))
    except Composed as composed:
        return composed.simulation
    except SystemExit as end:
        raise ValueError(f"'{text}' must simulate something, got sys.exit({end.code})") from end
    except Exception as error:
        raise ValueError(f"'{text}' failed: {type(error).__name__}: {error}") from error
    raise ValueError(f"'{text}' must simulate something, got to its end without a step")


@contextmanager
def _in_place_of_siconos() -> Iterator[None]:
    theirs = {key: sys.modules.pop(key) for key in list(sys.modules) if key.partition(".")[0] == "siconos"}
    for name, ours in _NAMES.items():
        sys.modules[name] = importlib.import_module(ours)
    try:
        yield
    finally:
        for name in _NAMES:
            del sys.modules[name]
        sys.modules.update(theirs)


@contextmanager
def _as_program(file: Path, arguments: list[str]) -> Iterator[None]:
    """As `python3 FILE ARGUMENTS` finds it, with a Matplotlib that opens no window."""
    argv, path, backend = sys.argv, list(sys.path), os.environ.get("MPLBACKEND")
    sys.argv = [str(file), *arguments]
    sys.path.insert(0, str(file.resolve().parent))
    os.environ["MPLBACKEND"] = "Agg"
    try:
        yield
    finally:
        sys.argv, sys.path[:] = argv, path
        if backend is None:
            del os.environ["MPLBACKEND"]
        else:
            os.environ["MPLBACKEND"] = backend
