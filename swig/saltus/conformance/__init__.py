"""Measure whether an integrator does what its line in the table says, and the figures to choose it by.

Against its properties: orders in free motion, under bilateral constraints and in sliding friction, from
slopes over several Δt against independent solutions, or errors over the tolerance of a scheme that chooses
its own steps; Newton's impact law, in one long fall and in 1000 phases
of a step; a ball at rest; equal runs to the last bit; refusal of friction where it is not taken. Without a
verdict: the stability limit, and the known defects of such schemes, unless an option mends them. For
integrators of the library, of plugins and of Python classes alike, with or without options: ``saltus
conformance NAME``. ``docs/schemes`` quotes it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import saltus.kernel as sk
from saltus import registry
from saltus.conformance.defects import defects, lasting_defects
from saltus.conformance.measure import (
    FREE_STEPS,
    Finding,
    impact_law,
    in_space,
    orders,
    phases,
    refusal,
    repeats,
    rest,
    stability_limit,
)
from saltus.conformance.models import (
    MU,
    RADIUS,
    SLIDE,
    SUNKEN,
    bowl,
    double_pendulum,
    exact_double_pendulum,
    exact_swing,
    pendulum,
)
from saltus.conformance.tolerance import tolerances

__all__ = ["Finding", "check", "findings"]


def check(spec: str) -> list[Finding]:
    """Measure an integrator.

    Parameters
    ----------
    spec : its name, and options if others than its own are meant, as in ``saltus.registry.make_integrator``

    Raises
    ------
    ValueError
        If there is no such integrator or option.
    """
    return list(findings(spec))


def findings(spec: str) -> Iterator[Finding]:
    """The findings one after the other, as they are measured."""
    claims = registry.properties(spec)
    if claims["error_controlled"]:
        yield from tolerances(spec, friction=claims["friction"])

    def make() -> sk.OneStepIntegrator:
        return registry.make_integrator(spec)

    if not claims["error_controlled"]:
        yield from _orders(claims, make)
    if claims["impact_law"]:
        yield impact_law(make)
    yield from phases(make, holds=claims["impact_law"])
    yield from rest(make, forces=claims["forces_at_rest"])
    yield repeats(make)
    if claims["error_controlled"]:
        yield from lasting_defects(make)
    else:
        yield stability_limit(make)
        yield from defects(
            make,
            friction=claims["friction"],
            order_sliding=claims["order_sliding"],
            forces=claims["forces_at_rest"],
        )


def _orders(claims: Mapping[str, Any], make: Callable[[], sk.OneStepIntegrator]) -> Iterator[Finding]:
    free, swing = exact_double_pendulum(0.5), exact_swing(0.0, RADIUS, 0.25)
    yield from orders("free motion", claims["order_free"], make, double_pendulum, free, 0.5, FREE_STEPS)
    yield from orders("bilateral constraint", claims["order_bilateral"], make, pendulum, swing, 0.25)
    yield from in_space(claims["order_bilateral"], make)
    if claims["friction"]:
        yield from orders(
            "sliding", claims["order_sliding"], make, bowl, exact_swing(MU, SUNKEN, SLIDE), SLIDE
        )
    else:
        yield refusal(make)
