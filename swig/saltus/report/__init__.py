"""The report of a run: one HTML page with its animation, its plots and its contacts.

`page.html` is the frame. The scripts are put into it in the order of `SCRIPTS`, with numbers and texts
of the run from `content`, so that it needs no network. Plots are drawn by uPlot, whose licence is beside it
in `vendor/`.
"""

from __future__ import annotations

import base64
import gzip
import html
import json
import math
import os
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from saltus.io.files import new_file
from saltus.report.content import Content, content_of

if TYPE_CHECKING:
    from saltus.io import FirstOrderTrajectory, Trajectory

SIZES = (
    8_000_000,
    4_000_000,
    2_000_000,
    1_000_000,
)  #: bytes of numbers: how far they can be packed is not known
PACKED = 2_000_000  #: at most, so that the page stays below 3 MB
SCRIPTS = ("data.js", "view.js", "scene.js", "timeline.js", "plots.js", "page.js")


def write_report(
    trajectory: Trajectory | FirstOrderTrajectory,
    path: str | os.PathLike[str],
    title: str | None = None,
    caption: str | None = None,
) -> Path:
    """Write the page of a run and return where it is; an existing file is replaced as a whole.

    Parameters
    ----------
    trajectory : the run
    path : of the page
    title : its heading; the integrator's name if it is left out
    caption : what there is to see, a sentence or two above the animation

    Raises
    ------
    ValueError
        If the run has no rows, or times that are not finite.
    OSError
        If the file cannot be written; what was there is untouched.
    """
    for what, words in (("title", title), ("caption", caption)):
        if words is not None and not isinstance(words, str):
            raise TypeError(f"{what} must be text, got {type(words).__name__}")
    content, packed = _packed(trajectory)
    text = _page(content.texts, packed, title or f"Run of {trajectory.provenance.integrator}", caption or "")
    with new_file(path) as file:
        file.part.write_text(text, encoding="utf-8")
    return file.target


def _packed(trajectory: Trajectory | FirstOrderTrajectory) -> tuple[Content, bytes]:
    """As many rows as the page can carry."""
    for size in SIZES:
        content = content_of(trajectory, size)
        packed = gzip.compress(content.numbers, 6, mtime=0)
        if len(packed) <= PACKED:
            break
    return content, packed


def _page(texts: dict[str, Any], packed: bytes, title: str, caption: str) -> str:
    parts = {
        "style": _read("vendor/uPlot.min.css") + _read("page.css"),
        "plot-library": _read("vendor/uPlot.iife.min.js"),
        "scripts": "\n".join(_read(name) for name in SCRIPTS),
        "numbers": base64.b64encode(packed).decode("ascii"),
        "run": _script_safe(texts),
        "caption": html.escape(caption),
        "title": html.escape(title),
    }
    text = _read("page.html")
    for name, part in parts.items():
        text = text.replace(f"<!--{name}-->", part)
    return text


def _read(name: str) -> str:
    return resources.files(__name__).joinpath(name).read_text(encoding="utf-8")


def _script_safe(texts: dict[str, Any]) -> str:
    """JSON that cannot end the element it stands in."""
    return json.dumps(_finite(texts), ensure_ascii=False, allow_nan=False).replace("<", "\\u003c")


def _finite(content: Any) -> Any:
    """Without NaN and infinity, which JSON does not have."""
    if isinstance(content, dict):
        return {name: _finite(value) for name, value in content.items()}
    if isinstance(content, list):
        return [_finite(value) for value in content]
    return None if isinstance(content, float) and not math.isfinite(content) else content
