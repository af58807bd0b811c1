"""The picture of a sweep: its first figure over the first parameter that is swept."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure

from saltus.panels.drawing import MOST_LINES, STYLE
from saltus.sweep.runs import figures_of
from saltus.sweep.table import UNITS
from saltus.sweep.worker import DONE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from saltus.sweep.runs import Sweep

Record = Mapping[str, Any]
DOTS = 20_000  #: more of them are drawn smaller


def write_picture(sweep: Sweep) -> None:
    """Write sweep.png."""
    import matplotlib as mpl

    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8, 4.8), layout="constrained")
        draw(figure.add_subplot(), sweep)
        figure.savefig(sweep.folder / "sweep.png", dpi=130)


def draw(ax: Axes, sweep: Sweep) -> None:
    """Draw lines where each value stands alone, dots where a run has several or points are scattered.

    A line each for all combinations of what else is swept. Of more than 12 numbers the second parameter
    is a colour. Grey crosses on the axis are runs without result.
    """
    records = sweep.records
    swept = [name for name in _quantities(records) if len({_of(record, name) for record in records}) > 1]
    numeric = [name for name in swept if not any(isinstance(_of(r, name), str) for r in records)]
    across = (numeric or swept or ["time_step"])[0]
    figure = figures_of(records)[0]
    others = [name for name in swept if name != across]
    groups: dict[tuple[Any, ...], list[Record]] = {}
    for record in records:
        groups.setdefault(tuple(_of(record, name) for name in others), []).append(record)
    units = {**UNITS, **sweep.study.units}
    colours = _colours(ax, groups, others, units) if len(groups) > MOST_LINES else {}
    scattered = len(groups) > MOST_LINES and max(map(len, groups.values())) < 3
    if scattered and colours:
        _scatter(ax, groups, across, figure, colours)
        groups = {}
    for key, group in groups.items():
        label = ", ".join(_word(name, value) for name, value in zip(others, key, strict=True))
        _draw_group(ax, group, across, figure, label, colours.get(key))
    lost = [_of(record, across) for record in records if record["status"] != DONE]
    if lost:
        ax.plot(
            lost,
            [0.0] * len(lost),
            "x",
            color="0.5",
            transform=ax.get_xaxis_transform(),
            clip_on=False,
            label=f"no result: {len(lost)} of {len(records)}",
        )
    if across == "time_step":
        ax.set_xscale("log")
    ax.set_xlabel(_label(across, units))
    ax.set_ylabel(_label(figure, units))
    if not colours and len(groups) <= MOST_LINES and ax.get_legend_handles_labels()[1]:
        ax.legend()


def _quantities(records: Sequence[Record]) -> list[str]:
    """Parameters, then what else may be swept."""
    return [*dict.fromkeys(name for r in records for name in r["parameters"]), "integrator", "time_step"]


def _of(record: Record, name: str) -> Any:
    return record[name] if name in ("integrator", "time_step") else record["parameters"].get(name)


def _dots(group: Sequence[Record], across: str, figure: str) -> tuple[Any, Any]:
    """All values of the figure, and where they are."""
    there = [record for record in group if figure in record.get("figures", {})]
    values = [np.atleast_1d(record["figures"][figure]) for record in there]
    x = np.repeat([_of(record, across) for record in there], [len(value) for value in values])
    return x, np.concatenate(values) if values else np.array([])


def _scatter(
    ax: Axes,
    groups: Mapping[tuple[Any, ...], Sequence[Record]],
    across: str,
    figure: str,
    colours: Mapping[tuple[Any, ...], Any],
) -> None:
    dots = {key: _dots(group, across, figure) for key, group in groups.items()}
    x, y = (np.concatenate([dot[k] for dot in dots.values()]) for k in range(2))
    ax.scatter(x, y, s=9, linewidths=0, c=[colours[key] for key, dot in dots.items() for _ in dot[0]])


def _draw_group(ax: Axes, group: Sequence[Record], across: str, figure: str, label: str, colour: Any) -> None:
    x, y = _dots(group, across, figure)
    style: dict[str, Any] = {"color": colour} if colour is not None else {}
    if any(isinstance(record.get("figures", {}).get(figure), list) for record in group):
        style |= {"linestyle": "", "marker": ".", "markersize": 1.2 if len(y) > DOTS else 2.5}
        style["markeredgewidth"] = 0
    else:
        order = np.argsort(x, kind="stable")
        x, y = x[order], y[order]
        style |= {"marker": ".", "markersize": 4, "linestyle": "-"}
    ax.plot(x, y, label=label, **style)


def _colours(
    ax: Axes, groups: Mapping[tuple[Any, ...], Any], others: Sequence[str], units: Mapping[str, str]
) -> dict[tuple[Any, ...], Any]:
    """A colour for each group, by the first of the other quantities that is a number."""
    numbers = [k for k in range(len(others)) if all(isinstance(key[k], (int, float)) for key in groups)]
    if not numbers:
        return {}
    k = numbers[0]
    values = [key[k] for key in groups]
    norm = (LogNorm if others[k] == "time_step" else Normalize)(min(values), max(values))
    scale = ScalarMappable(norm, "viridis")
    ax.figure.colorbar(scale, ax=ax, label=_label(others[k], units))
    return {key: scale.to_rgba(key[k]) for key in groups}


def _label(name: str, units: Mapping[str, str]) -> str:
    words = {"time_step": "Δt"}.get(name, name.replace("_", " "))
    return f"{words} [{units[name]}]" if units.get(name, "1") != "1" else words


def _word(name: str, value: Any) -> str:
    if name == "integrator":
        return str(value)
    text = f"{value:g}" if isinstance(value, float) else str(value)
    return f"Δt = {text} s" if name == "time_step" else f"{name.replace('_', ' ')} = {text}"
