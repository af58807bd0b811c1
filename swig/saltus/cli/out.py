"""Files that commands leave in their folder."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")  # no display is needed

import matplotlib.pyplot as plt
from matplotlib.figure import Figure


def require_writable(out: Path) -> None:
    """Make the folder and try it, before anything is computed."""
    try:
        out.mkdir(parents=True, exist_ok=True)
        probe = out / ".writable"
        probe.touch()
        probe.unlink()
    except OSError as error:
        reason = f"cannot write into '{out}': expected a writable folder, got: {error.strerror}"
        raise OSError(error.errno or 0, reason) from error


def require_picture(path: Path) -> None:
    """Raise ValueError if no picture can be written under that name."""
    known = sorted(Figure().canvas.get_supported_filetypes())
    if path.suffix.removeprefix(".").lower() not in known:
        raise ValueError(f"a picture must end in one of .{', .'.join(known)}, got '{path}'")


def write_json(content: Any, path: Path) -> None:
    """Write JSON that people can read."""
    path.write_text(json.dumps(content, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")


def save(picture: Figure, path: Path) -> None:
    """Write the picture and let go of it."""
    picture.savefig(path, dpi=130)
    plt.close(picture)
