"""Integrators compared with each other and with a reference: `compare` and `converge`.

The rule, which C++ (saltus/compare.hpp) and the command line share
-------------------------------------------------------------------
*Common times.* A run is compared at the times of all its own steps, t0 excepted, up to the end of the
shorter of run and reference. Where the reference has no step at such a time, within 1e-6 of its Δt, it is
interpolated between two: q by the cubic through both states, v by a straight line; where the later one is
impulsive, q by a straight line, and v is that of the earlier one. A run that ends early is compared as far as
it came.

*Impacts.* Every unilateral contact has impacts of its own. Impulses of a contact that follow each other
within three steps (of the coarser of the two runs) are one impact: the end of an accumulation, which no
step resolves, and the impulses in every step by which Moreau-Jean holds a closed contact, where an impulse
ten times the one before it begins a new impact. Its time is that of its first step, its impulse Σ Λ_N over
three steps. Going through both runs in the order of time, impacts within 20 steps, or 1 % of the time that
is compared, are pairs; where two compete the nearer one wins. One without partner counts as an error of its
whole impulse, unless it is smaller than 1 % of the reference's largest, or so near to the end that its
partner can be behind it.

*States.* The error of q is the largest difference over all common times, each component over the range that
it covers in the reference (at least 1e-3 of that of the component that moves most). The error of v
likewise, without the times from three steps before to three steps after an impact of either run, nor those
between the two of a pair. `spectral` is the spectral norm of all differences of q as one matrix, as in
Tables 2 and 3 of the paper; orders are slopes of spectral/√(common times).

*Energy.* T + V − Σ(work of λ and Λ) changes by the work of other forces only. Its largest difference from
that of the reference, over the reference's largest T, is the energy drift. V is left out where the model
has none.

*Time of a step* is the median of five timings in which the integrators take turns, nothing recorded;
slowdown is its ratio to that of the baseline.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

from saltus import _core, models, registry
from saltus._core import NonSmoothDynamicalSystemBase, OneStepIntegrator
from saltus._core import integrators as registered
from saltus.io import Trajectory, read_hdf5
from saltus.models import Model

BASELINE = "MoreauJeanOSI"
REFINEMENT = 100  #: of the reference that `converge` makes

Progress: TypeAlias = Callable[[str, float], object]
"""What is being computed, and the fraction of it that is done."""
ModelLike: TypeAlias = (
    str | os.PathLike[str] | Model | NonSmoothDynamicalSystemBase | Callable[[], NonSmoothDynamicalSystemBase]
)


@dataclass(frozen=True)
class Row:
    """One integrator with one time step; None is what cannot be told."""

    integrator: str
    baseline: bool  #: runs beside the others, keeps no limits
    time_step: float  #: Δt [s]
    common_times: int
    end: float  #: of the common times [s]
    error_q: float | None
    error_v: float | None
    spectral: float | None  #: as in Tables 2 and 3 [m or rad]
    normalised: float | None  #: spectral / √common_times
    order: float | None  #: from `normalised` of this Δt and the coarser one before
    energy_drift: float | None
    impacts: int
    reference_impacts: int
    unmatched: int  #: of both
    impact_time_error: float | None  #: [s]
    impulse_error: float | None  #: over the reference's largest impulse
    steps: int
    impulsive_steps: int
    closed: float  #: mean number of closed contacts
    penetration: float  #: [m]
    residual: float  #: largest of all steps [m/s]
    us_per_step: float | None  #: [µs]
    slowdown: float | None  #: over the baseline
    ended: str  #: why the run ended early, or empty


@dataclass(frozen=True)
class Breach:
    """A limit that does not hold; "until" if a run ended early."""

    integrator: str
    time_step: float | None  #: [s], None for an order
    limit: str
    value: float | None
    allowed: float | None
    message: str


@dataclass(frozen=True)
class Comparison:
    """What `compare` found; prints as a table."""

    model: str
    until: float  #: [s]
    rows: tuple[Row, ...]  #: the baseline first, every integrator from coarse to fine
    orders: Mapping[str, float | None]  #: slope over all time steps, by integrator
    reference: str
    reference_step: float  #: [s]
    reference_moves: float | None  #: error of q of the reference with its step doubled, None if it is a file
    limits: Mapping[str, float]  #: by the names that breaches have
    refused: Mapping[str, str]  #: integrators that were left out because they cannot take the model, and why
    warnings: tuple[str, ...]
    breaches: tuple[Breach, ...]
    text: str

    @property
    def ok(self) -> bool:
        """True if every limit holds."""
        return not self.breaches

    def __str__(self) -> str:
        return self.text

    def to_json(self) -> dict[str, Any]:
        """Everything but the text, as JSON can hold it."""
        content = asdict(self)
        del content["text"]
        return {"ok": self.ok, **content}


def compare(
    model: ModelLike,
    integrators: Sequence[str | OneStepIntegrator] = (),
    *,
    baseline: str | None = BASELINE,
    time_steps: Sequence[float] = (),
    until: float | None = None,
    reference: str | os.PathLike[str] | Trajectory | None = None,
    max_error: float | None = None,
    max_energy_drift: float | None = None,
    max_impulse_error: float | None = None,
    max_penetration: float | None = None,
    max_slowdown: float | None = None,
    min_order: float | None = None,
    timings: int = 5,
    progress: Progress | None = None,
) -> Comparison:
    """Run integrators beside a baseline and compare all with a reference, as the module's docstring says.

    Parameters
    ----------
    model : as `saltus.models.model` takes it, or a system, or a function that composes one
    integrators : names with options; all registered ones that take the model if none is given
    baseline : another one, which keeps no limits; None for none
    time_steps, until : [s], those of the model if not given
    reference : "INTEGRATOR@DT", a recorded run, or its HDF5 file. If not given the model's own, otherwise
        HalfExplicitTrapezoidalOSI with 1/100 of the finest step
    max_error, max_energy_drift, max_impulse_error : of scaled errors [1]
    max_penetration : [m]
    max_slowdown : over the baseline [1]
    min_order : of the slope over all time steps
    timings : how often runs are timed, 0 for not at all
    progress : called with a label and the fraction of it that is done

    Raises
    ------
    ValueError
        If there is no such model or integrator, an integrator that is named cannot take the model, or a
        time step, limit or reference makes no sense.
    OSError
        If the reference's file cannot be read.
    """
    about = _model(model)
    steps, end = _times(about, time_steps, until)
    chosen, refused = _candidates(about, integrators, baseline, steps)
    given = {
        "max-error": max_error,
        "max-energy-drift": max_energy_drift,
        "max-impulse-error": max_impulse_error,
        "max-penetration": max_penetration,
        "max-slowdown": max_slowdown,
        "min-order": min_order,
    }
    return _run(
        about,
        steps,
        end,
        chosen,
        _named(baseline) if baseline is not None else None,
        _reference(about.reference if reference is None else reference),
        limits={name: float(limit) for name, limit in given.items() if limit is not None},
        timings=timings,
        refused=refused,
        progress=progress,
    )


def converge(
    model: ModelLike,
    integrators: Sequence[str | OneStepIntegrator] = (),
    *,
    time_steps: Sequence[float],
    until: float | None = None,
    reference: str | os.PathLike[str] | Trajectory | None = None,
    progress: Progress | None = None,
) -> list[Comparison]:
    """Errors over the time step, a comparison for each integrator.

    Parameters
    ----------
    time_steps : at least two [s]
    reference : as in `compare`; if not given, each integrator's own run with 1/100 of the finest step
    model, integrators, until, progress : as in `compare`

    Raises
    ------
    ValueError, OSError
        As `compare`, ValueError also if there are fewer than two time steps.
    """
    if len(set(time_steps)) < 2:
        raise ValueError(f"an order needs at least two time steps, got {len(set(time_steps))}")
    about = _model(model)
    steps, end = _times(about, time_steps, until)
    chosen, refused = _candidates(about, integrators, None, steps)
    results = []
    for name, scheme in chosen:
        own = _Reference((name, scheme), None, name, min(steps) / REFINEMENT)
        results.append(
            _run(
                about,
                steps,
                end,
                [(name, scheme)],
                None,
                own if reference is None else _reference(reference),
                limits={},
                timings=0,
                refused=refused,
                progress=progress,
            )
        )
    return results


def find_reference(text: str) -> tuple[str, float] | None:
    """The parts of "INTEGRATOR@DT", None if the text has another form."""
    name, at, step = text.rpartition("@")
    try:
        return (name, float(step)) if at and name else None
    except ValueError:
        return None


Named: TypeAlias = tuple[str, OneStepIntegrator]


class _Reference(NamedTuple):
    """A run to be made, a recorded one, or neither: the default."""

    made: Named | None = None
    recorded: Mapping[str, Any] | None = None
    name: str = ""
    time_step: float = 0.0


def _run(
    about: Model,
    steps: Sequence[float],
    until: float,
    chosen: Sequence[Named],
    baseline: Named | None,
    reference: _Reference,
    *,
    limits: Mapping[str, float],
    timings: int,
    refused: Mapping[str, str],
    progress: Progress | None,
) -> Comparison:
    found = _core.compare_integrators(
        about.build(), chosen, baseline, steps, until, *reference, limits, timings, progress
    )
    return Comparison(
        model=about.name,
        until=until,
        limits=limits,
        refused=refused,
        rows=tuple(Row(**row) for row in found.pop("rows")),
        breaches=tuple(Breach(**breach) for breach in found.pop("breaches")),
        warnings=tuple(found.pop("warnings")),
        **found,
    )


def _model(model: ModelLike) -> Model:
    if isinstance(model, Model):
        about = model
    elif isinstance(model, (str, os.PathLike)):
        about = models.model(model)
    elif isinstance(model, NonSmoothDynamicalSystemBase):
        about = Model("system", "", lambda: model, None, None)
    elif callable(model):
        about = Model(getattr(model, "__name__", "model"), "", model, None, None)
    else:
        raise ValueError(f"a model must be a name, a system or a function, got {type(model).__name__}")
    system = about.build()
    if not isinstance(system, NonSmoothDynamicalSystemBase):
        raise ValueError(f"'{about.name}' must build a NonSmoothDynamicalSystem, got {type(system).__name__}")
    return about


def _times(about: Model, time_steps: Sequence[float], until: float | None) -> tuple[list[float], float]:
    steps = [float(step) for step in time_steps]
    if not steps and about.time_step is not None:
        steps = [about.time_step]
    end = about.until if until is None else float(until)
    if not steps:
        raise ValueError(f"'{about.name}' has no time step of its own (TIME_STEP): time steps are needed")
    for step in steps:
        if not 0 < step < float("inf"):
            raise ValueError(f"time steps must be positive and finite, got {step:g}")
    if end is None:
        raise ValueError(f"'{about.name}' has no end of its own (UNTIL): until is needed")
    return steps, end


def _candidates(
    about: Model, wanted: Sequence[str | OneStepIntegrator], baseline: str | None, steps: Sequence[float]
) -> tuple[list[Named], dict[str, str]]:
    """Those that are wanted, or all registered ones that take the model, and why others do not."""
    if wanted:
        return [_named(scheme) for scheme in wanted], {}
    chosen, refused = [], {}
    for entry in registered():
        if entry["name"] == baseline:
            continue
        scheme = _named(entry["name"])
        try:
            _core.TimeSteppingBase(about.build(), scheme[1], max(steps), "auto")
        except ValueError as error:
            refused[entry["name"]] = str(error)
        else:
            chosen.append(scheme)
    return chosen, refused


def _named(scheme: str | OneStepIntegrator) -> Named:
    if isinstance(scheme, str):
        try:
            return scheme, registry.make_integrator(scheme)
        except TypeError as error:  # it names something else than an integrator
            raise ValueError(str(error)) from error
    if not isinstance(scheme, OneStepIntegrator):
        raise ValueError(f"an integrator must be a name or a OneStepIntegrator, got {type(scheme).__name__}")
    return registry.label(scheme), scheme


def _reference(given: str | os.PathLike[str] | Trajectory | None) -> _Reference:
    if given is None:
        return _Reference()
    if isinstance(given, str) and (made := find_reference(given)) is not None:
        name, step = made
        return _Reference(_named(name), None, name, step)
    if not isinstance(given, Trajectory) and not Path(given).exists():
        raise ValueError(f"a reference must be INTEGRATOR@DT or an HDF5 file that exists, got '{given}'")
    run = given if isinstance(given, Trajectory) else read_hdf5(given)
    name = run.provenance.integrator if isinstance(given, Trajectory) else os.fspath(given)
    return _Reference(None, dict(run.columns()), name, run.provenance.time_step)
