"""What commands print, and the files that they leave."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")  # no display is needed

import matplotlib.pyplot as plt
from matplotlib.figure import Figure
from rich.console import Console

from saltus.io.files import writable_folder

LEAST_WIDTH = 200  #: of the tables: a pipe is taken for 80 columns, and numbers must not be cut


def wide_console() -> Console:
    """Prints tables to stdout, as wide as they are."""
    return Console(width=max(Console().width, LEAST_WIDTH))


def require_targets(paths: Sequence[Path]) -> bool:
    """Try the folders before anything is computed, and say whether one of the targets is "-", stdout."""
    to_stdout = [path for path in paths if str(path) == "-"]
    if len(to_stdout) > 1:
        raise ValueError("only one output can go to stdout, got '-' more than once")
    for path in paths:
        if str(path) == "-":
            continue
        if path.is_dir():
            raise ValueError(f"expected a file to write, got the folder '{path}'")
        writable_folder(path.parent)
    return bool(to_stdout)


def require_picture(path: Path) -> None:
    """Raise ValueError if no picture can be written under that name."""
    known = sorted(Figure().canvas.get_supported_filetypes())
    if path.suffix.removeprefix(".").lower() not in known:
        raise ValueError(f"a picture must end in one of .{', .'.join(known)}, got '{path}'")


def write_json(content: Any, path: Path) -> None:
    """Write JSON that people can read."""
    path.write_text(json.dumps(content, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")


def write(text: str, path: Path) -> None:
    """Write the text to a file, or to stdout if that is "-"."""
    if str(path) == "-":
        print(text, end="")
    else:
        path.write_text(text, encoding="utf-8")


def save(picture: Figure, path: Path) -> None:
    """Write the picture and let go of it."""
    picture.savefig(path, dpi=130)
    plt.close(picture)
