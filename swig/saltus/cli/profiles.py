"""The picture of ``saltus bench solvers``: performance profiles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeAlias

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from saltus import plot

Profile: TypeAlias = Mapping[str, Sequence[tuple[float, float]]]

LINES = ("-", "--", "-.", ":")


def draw(profiles: Mapping[float, Profile]) -> Figure:
    """A panel for each tolerance, a curve for each solver: ρ(τ) on a logarithmic axis."""
    with plt.rc_context(plot.STYLE):
        curves = [steps for profile in profiles.values() for steps in profile.values()]
        last = 1.3 * max((ratio for steps in curves for ratio, _ in steps), default=1.0)
        width = 2.2 + 4.0 * len(profiles)
        figure, [axes] = plt.subplots(
            1,
            len(profiles),
            figsize=(width, 4.4),
            sharex=True,
            sharey=True,
            squeeze=False,
            layout="constrained",
        )
        for ax, (tolerance, profile) in zip(axes, profiles.items(), strict=True):
            draw_profile(ax, profile, last)
            ax.set_title(f"tolerance {tolerance:g}", loc="left")
            ax.set_xlabel("τ: time / time of the fastest")
        axes[0].set_ylabel("ρ: fraction of the problems\nsolved within τ")
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside right center", handlelength=4)
        return figure


def draw_profile(ax: Axes, profile: Profile, last: float) -> None:
    """Later curves are thinner and their dashes differ, so that one on top of another leaves it visible."""
    widths = np.linspace(3.0, 1.2, len(profile))
    for index, (solver, steps) in enumerate(profile.items()):
        ratios = [1.0, *(ratio for ratio, _ in steps), last]
        fractions = [0.0, *(fraction for _, fraction in steps)]
        line = LINES[index % len(LINES)]
        ax.step(
            ratios, [*fractions, fractions[-1]], line, where="post", label=solver, linewidth=widths[index]
        )
    ax.set_xscale("log")
    ax.set_xlim(1.0, last)
    ax.set_ylim(-0.02, 1.02)
