"""Models by name: the table of the examples, Python files, and models that a plugin composes."""

from __future__ import annotations

import os
import traceback
from collections.abc import Callable
from dataclasses import dataclass, replace
from math import pi
from numbers import Real
from pathlib import Path
from types import ModuleType
from typing import Any

from saltus import _core, registry
from saltus._core import NonSmoothDynamicalSystemBase
from saltus.examples.ball_in_box import ball_in_box
from saltus.examples.ball_on_string import ball_on_string
from saltus.examples.bouncing_ball import bouncing_ball
from saltus.examples.chain_of_bodies import chain_of_bodies
from saltus.examples.disc_pile import disc_pile
from saltus.examples.dry_friction import dry_friction
from saltus.examples.elastic_bar import elastic_bar
from saltus.examples.heavy_top import heavy_top
from saltus.examples.impact_oscillator import impact_oscillator
from saltus.examples.newtons_cradle import newtons_cradle
from saltus.examples.rocking_block import rocking_block
from saltus.examples.rolling_sphere import rolling_sphere
from saltus.examples.rotor import rotor
from saltus.examples.slider_crank import slider_crank
from saltus.examples.woodpecker import woodpecker
from saltus.siconos.arrays import methods
from saltus.siconos.script import compose, is_script


@dataclass(frozen=True)
class Model:
    """How a model is composed, and how it is run where nothing else is said."""

    name: str
    summary: str
    build: Callable[[], NonSmoothDynamicalSystemBase]
    time_step: float | None  #: Δt [s], None if its author names none
    until: float | None  #: [s], likewise
    reference: str | None = None  #: INTEGRATOR@DT whose run stands for the truth


@dataclass(frozen=True)
class Example(Model):
    """A model of the table."""

    time_step: float  #: Δt [s]
    until: float  #: [s]
    bare_loop: Callable[[float, int], object] | None = None  #: the same in C++, written by hand: (Δt, steps)
    bench_steps: int = 40_000  #: at least, in whole runs, of one repeat of ``saltus bench``

    @property
    def steps(self) -> int:
        """Of one run."""
        return round(self.until / self.time_step)


def _bar(
    elements: int, what: str, time_step: float, until: float, reference: str, gap: float | None = None
) -> Example:
    standard = elastic_bar.Parameters()
    parameters = standard if gap is None else replace(standard, gap=gap)
    return Example(
        f"bar-{elements}",
        f"elastic bar of {elements} elements {what}",
        lambda: elastic_bar.build(elements, parameters=parameters),
        time_step,
        until,
        f"HalfExplicitTrapezoidalOSI@{reference}",
        lambda dt, steps: _core.bare_elastic_bar(elements, 0.0, parameters.gap, dt, steps),
        40_000 * 50 // elements,
    )


MODELS = {
    model.name: model
    for model in (
        Example(
            "slider-crank",
            "slider crank with impacts and dry friction, Table 3 of the paper",
            slider_crank.build,
            1e-5,
            0.1,
            "HalfExplicitTrapezoidalOSI@1e-7",
            _core.bare_slider_crank,
        ),
        Example(
            "bouncing-ball",
            "a ball that bounces ever faster until it lies still at 4.06 s",
            bouncing_ball.build,
            1e-4,
            5.0,
        ),
        Example(
            "ball-in-box",
            "a ball in an oblique box, at rest on two sides in the end, Section 5.2 of the paper",
            ball_in_box.build,
            5e-3,
            2.0,
        ),
        Example(
            "newtons-cradle",
            "five balls that hit each other one after the other, nearly a period",
            newtons_cradle.build,
            newtons_cradle.TIME_STEP,
            0.7,
        ),
        Example(
            "dry-oscillator",
            "a block on a spring that dry friction brings to rest at 1.26 s",
            dry_friction.oscillator,
            2e-4,
            2.0,
        ),
        Example(
            "impact-oscillator",
            "a driven mass that hits its stop once in every period, ten times",
            impact_oscillator.build,
            impact_oscillator.TIME_STEP,
            2.6,
            bench_steps=5_000,
        ),
        Example(
            "ball-on-string",
            "a ball on a string that goes slack, and is taut again with a jerk at 1.07 s; in Python",
            ball_on_string.build,
            ball_on_string.TIME_STEP,
            1.3,
            bench_steps=5_000,
        ),
        Example(
            "rocking-block",
            "a block that rocks from corner to corner until it stands still at 1.04 s",
            rocking_block.build,
            rocking_block.TIME_STEP,
            1.5,
        ),
        Example(
            "heavy-top",
            "a top that precesses and nods on a ball joint, a rigid body in space",
            heavy_top.build,
            heavy_top.TIME_STEP,
            1.0,
            "HalfExplicitRungeKuttaOSI(tableau=HEM5)@1e-4",
        ),
        Example(
            "rolling-sphere",
            "a sphere with spin that slides on a plane, and rolls from 0.62 s on",
            rolling_sphere.build,
            rolling_sphere.TIME_STEP,
            1.0,
        ),
        Example(
            "chain-of-bodies",
            "ten rods in space under ball joints, let go from the horizontal",
            lambda: chain_of_bodies.build(angles=pi / 2),
            chain_of_bodies.TIME_STEP,
            1.0,
            bench_steps=4_000,
        ),
        Example(
            "woodpecker",
            "the woodpecker toy on its limit cycle of 0.146 s, five impacts a period",
            woodpecker.build,
            woodpecker.TIME_STEP,
            1.0,
        ),
        Example(
            "disc-pile",
            "16 discs that fall into a container and lie still after 1 s, 168 contacts",
            disc_pile.build,
            disc_pile.TIME_STEP,
            1.5,
            bench_steps=2_000,
        ),
        Example(
            "rotor",
            "a flexible rotor that hits and slides in its journal bearing, Section 6.2 of the paper",
            rotor.build,
            rotor.TIME_STEP,
            rotor.END,
            f"{rotor.STABILISED}@5e-7",
            bench_steps=10_000,
        ),
        _bar(50, "that hits an obstacle, Section 6.1 of the paper", 1e-7, 1.5e-3, "1e-9"),
        _bar(1000, "that hits an obstacle, Section 6.1 of the paper", 1e-7, 1.5e-3, "1e-8"),
        _bar(100_000, "on an obstacle, for what a step costs", 1e-9, 2e-7, "1e-10", gap=1.05e-9),
    )
}


def model(name: str | os.PathLike[str]) -> Model:
    """The model of that name.

    Parameters
    ----------
    name : in the table; "file.py" or "package.module" with ``build() -> NonSmoothDynamicalSystem`` and, if
        wanted, TIME_STEP [s], UNTIL [s] and REFERENCE ("INTEGRATOR@DT"); "library:function" of a plugin; the
        file of a script for Siconos, whose first simulation is taken

    Raises
    ------
    ValueError
        If there is none, or what the name says cannot be loaded.
    """
    text = os.fspath(name)
    if text in MODELS:
        return MODELS[text]
    if text.endswith(".py") and is_script(text):
        return _of_script(text)
    module = registry.load_module(text)
    if module is not None:
        return _of_module(text, module)
    if ":" in text:
        _core.load_model(text)  # an error now, not when it is run
        return Model(text, "", lambda: _core.load_model(text), None, None)
    raise ValueError(
        f"no model named '{text}', there are {', '.join(MODELS)}; a file must end in .py, a plugin be named "
        "library:function"
    )


def _of_script(text: str) -> Model:
    """Every build() runs the script anew up to its first step, as its systems carry their state."""
    simulation = compose(text)
    nsds = simulation.nonSmoothDynamicalSystem()
    if nsds._first_order:
        raise ValueError(f"'{text}' is of first order, expected a mechanical model: run it by `saltus run`")

    def build_it() -> NonSmoothDynamicalSystemBase:
        made: NonSmoothDynamicalSystemBase = methods(compose(text).nonSmoothDynamicalSystem()).native()
        return made

    return Model(text, "script for Siconos", build_it, simulation.timeStep(), nsds.finalT())


def _of_module(text: str, module: ModuleType) -> Model:
    build = getattr(module, "build", None)
    if not callable(build):
        raise ValueError(f"'{text}' must define build() -> NonSmoothDynamicalSystem, got no such function")
    numbers = {}
    for name in ("TIME_STEP", "UNTIL"):
        value = getattr(module, name, None)
        if value is not None and (not isinstance(value, Real) or isinstance(value, bool)):
            raise ValueError(f"'{text}': {name} must be a number of seconds, got {value!r}")
        numbers[name] = None if value is None else float(value)
    reference = getattr(module, "REFERENCE", None)
    if reference is not None and not isinstance(reference, str):
        raise ValueError(f"'{text}': REFERENCE must be a text INTEGRATOR@DT, got {reference!r}")
    summary = (module.__doc__ or "").partition("\n")[0]

    def build_it() -> Any:
        try:
            return build()
        except Exception as error:
            where = traceback.extract_tb(error.__traceback__)[-1]
            place = f"{Path(where.filename).name}, line {where.lineno}"
            raise ValueError(
                f"build() of '{text}' failed: {type(error).__name__}: {error} ({place})"
            ) from error

    return Model(text, summary, build_it, numbers["TIME_STEP"], numbers["UNTIL"], reference)
