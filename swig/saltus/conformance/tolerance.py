"""Of schemes that choose steps of their own: their errors over the tolerance that they were given."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

import numpy as np

import saltus.kernel as sk
from saltus import _core, registry
from saltus.conformance.measure import Finding, end, slope
from saltus.conformance.models import (
    MU,
    RADIUS,
    SLIDE,
    SUNKEN,
    ball,
    bowl,
    double_pendulum,
    exact_ball,
    exact_double_pendulum,
    exact_sledge,
    exact_swing,
    exact_top,
    pendulum,
    sledge,
    top,
)

if TYPE_CHECKING:
    from saltus.typing import FloatArray

STEPS = 4  # of the simulation in a run: inner steps are not longer
TOLERANCES = np.array([1e-5, 1e-7, 1e-9])  # rtol and atol
MOST = 100.0  # tolerances that an error may be
ROUNDING = 1e-11  # errors below say nothing of the tolerance


def tolerances(spec: str, *, friction: bool) -> Iterator[Finding]:
    """Errors of q and v at the end of runs in free motion, under constraints, in sliding, after an impact."""
    yield from _errors("free motion", spec, double_pendulum, exact_double_pendulum(0.5), 0.5)
    yield from _errors("bilateral constraint", spec, pendulum, exact_swing(0.0, RADIUS, 0.25), 0.25)
    yield from _errors("top on a ball joint", spec, top, exact_top(0.2), 0.2)
    if friction:
        exact = exact_swing(MU, SUNKEN, SLIDE)
        yield from _errors("sliding", spec, bowl, exact, SLIDE)
        yield from _errors("sliding that turns in space", spec, sledge, exact_sledge(0.25), 0.25)
    height = exact_ball(0.05, 0.5, 0.15)
    yield from _errors("a ball that has bounced", spec, lambda: ball(0.05, 0.5), (height, None), 0.15)


def _errors(
    what: str,
    spec: str,
    build: Callable[[], sk.NonSmoothDynamicalSystem],
    exact: tuple[FloatArray | float, FloatArray | None],
    until: float,
) -> Iterator[Finding]:
    errors = []
    for tolerance in TOLERANCES:
        q, v = end(build(), with_tolerance(spec, tolerance), until / STEPS, until)
        error = np.abs(q - exact[0]).max()
        errors.append(error if exact[1] is None else max(error, np.abs(v - exact[1]).max()))
    ratio = float((np.array(errors) / TOLERANCES).max())
    yield Finding(f"error over tolerance, {what}", ratio, f"<= {MOST:g}", ratio <= MOST)
    if errors[-1] > ROUNDING:
        yield Finding(f"slope of error over tolerance, {what}", slope(TOLERANCES, np.array(errors)))


def with_tolerance(spec: str, tolerance: float) -> sk.OneStepIntegrator:
    """The integrator with rtol, and atol if it has one, set to a tolerance."""
    scheme = registry.make_integrator(spec)
    options = {key: tolerance if key in ("rtol", "atol") else value for key, value in scheme.options.items()}
    return _core.make_integrator(scheme.name, options)
