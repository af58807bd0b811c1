"""Nonsmooth first-order systems: circuits with ideal diodes, relays, switched feedback.

M ẋ = f(t, x) + r, y = h(t, x, λ), r = g(t, x, λ), and a law between y and λ: see docs/first-order.md.
All names are those of `saltus.kernel` as well.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from numbers import Real
from typing import Any, TypeAlias

from saltus import _core, notebook, registry
from saltus._core import (
    BoxLaws,
    EqualityConditionNSL,
    FirstOrderLinearDS,
    FirstOrderLinearR,
    FirstOrderLinearTIDS,
    FirstOrderLinearTIR,
    FirstOrderNonLinearDS,
    FirstOrderNonLinearR,
    FirstOrderReport,
    SimulationError,
)
from saltus.io import FirstOrderLayout, FirstOrderTrajectory, Provenance
from saltus.io.records import plain

__all__ = [
    "BoxLaws",
    "ComplementarityConditionNSL",
    "EulerMoreauOSI",
    "FirstOrderLinearDS",
    "FirstOrderLinearR",
    "FirstOrderLinearTIDS",
    "FirstOrderLinearTIR",
    "FirstOrderNonLinearDS",
    "FirstOrderNonLinearR",
    "FirstOrderReport",
    "FirstOrderSystem",
    "FirstOrderTimeStepping",
    "MixedComplementarityConditionNSL",
    "RelayNSL",
    "ZeroOrderHoldOSI",
]


def ComplementarityConditionNSL(n: int) -> BoxLaws:
    """0 ≤ y ⊥ λ ≥ 0 in n rows. Raises ValueError if n < 1."""
    return _core.complementarity_laws(n)


def RelayNSL(n: int, lb: float = -1.0, ub: float = 1.0) -> BoxLaws:
    """−y in the normal cone of [lb, ub] at λ in n rows: λ = lb where y > 0, ub where y < 0.

    Raises ValueError if n < 1, lb > ub, or a bound is not finite.
    """
    return _core.relay_laws(n, lb, ub)


def MixedComplementarityConditionNSL(equalities: int, inequalities: int) -> BoxLaws:
    """Y = 0 in the first rows, 0 ≤ y ⊥ λ ≥ 0 in the others.

    Raises ValueError if a number is negative, or both are zero.
    """
    return _core.mixed_complementarity_laws(equalities, inequalities)


@dataclass(frozen=True)
class EulerMoreauOSI:
    """The scheme of Euler and Moreau.

    M (x⁺ − x) = Δt (θ f(t⁺, x⁺) + (1−θ) f(t, x)) + Δt (γ r⁺ + (1−γ) r), with y⁺ = h(t⁺, x⁺, λ⁺),
    r⁺ = g(t⁺, x⁺, λ⁺) and the law between y⁺ and λ⁺.

    Parameters
    ----------
    theta : θ in [0, 1], weight of f at the end of the step; ½ is of second order where λ is smooth
    gamma : γ in [0, 1], weight of r likewise
    gamma_for_relation : γ is that of the relation instead: r⁺ has the weight 1, and the law holds between
        λ⁺ and h(t⁺, γ x⁺ + (1−γ) x, λ⁺)
    """

    theta: float = 1.0
    gamma: float = 1.0
    gamma_for_relation: bool = False


@dataclass(frozen=True)
class ZeroOrderHoldOSI:
    """Exact steps of linear systems with constant A and M, for inputs that are constant over the step.

    x⁺ = exp(M⁻¹A Δt) x + ∫ exp(M⁻¹A s) ds M⁻¹ (b + r⁺), b at the start of the step, with the law between y⁺
    and λ⁺: what a sampled controller does to a process.
    """


Scheme: TypeAlias = EulerMoreauOSI | ZeroOrderHoldOSI
SCHEMES: dict[str, Callable[..., Scheme]] = {
    "EulerMoreauOSI": EulerMoreauOSI,
    "ZeroOrderHoldOSI": ZeroOrderHoldOSI,
}


def make_scheme(spec: str) -> Scheme:
    """An integrator of first-order systems from its name and options: ``"EulerMoreauOSI(theta=0.5)"``.

    Raises
    ------
    ValueError
        If there is none of that name, no such option, or an option is not a number.
    """
    name, options = registry.parse(spec)
    if name not in SCHEMES:
        there = ", ".join(SCHEMES)
        raise ValueError(f"no integrator of first-order systems named '{name}', there are {there}")
    known = {field.name for field in fields(EulerMoreauOSI)} if name == "EulerMoreauOSI" else set()
    if not known.issuperset(options) or not all(isinstance(value, float) for value in options.values()):
        expected = ", ".join(sorted(known)) or "none"
        raise ValueError(f"options of {name} are numbers: {expected}; got '{spec}'")
    return SCHEMES[name](**options)


class FirstOrderSystem(_core.FirstOrderSystemBase):
    """First-order systems, and the relations between them with their laws.

    Parameters
    ----------
    systems : their states x one after the other are that of the whole
    t0 : initial time [s]
    parameters : what the model was made with, by name, to be kept with its runs

    Raises
    ------
    ValueError
        If there is no system, one stands twice, t0 is not finite, or parameters cannot be kept.
    """

    def __init__(
        self,
        systems: Sequence[FirstOrderNonLinearDS],
        t0: float = 0.0,
        *,
        parameters: Mapping[str, Any] | None = None,
    ) -> None:
        super().__init__(list(systems), t0)
        self.parameters = plain(parameters or {})

    def link(
        self,
        relation: FirstOrderNonLinearR,
        law: BoxLaws | EqualityConditionNSL,
        ds1: FirstOrderNonLinearDS,
        ds2: FirstOrderNonLinearDS | None = None,
        *,
        name: str = "",
    ) -> None:
        """Let a relation act on ds1, or on both, with a law between its y and λ; results carry the name.

        Raises
        ------
        ValueError
            If a system is not part of this one, the name is taken, or sizes disagree.
        """
        laws = _core.equality_laws(law.size) if isinstance(law, EqualityConditionNSL) else law
        self.connect(relation, laws, ds1, ds2, name)

    def __repr__(self) -> str:
        return notebook.first_order_model_text(self)

    def _repr_html_(self) -> str:
        return notebook.first_order_model(self)


class FirstOrderTimeStepping(_core.FirstOrderTimeSteppingBase):
    """Simulation of a first-order model with fixed steps, t_k = t0 + k Δt.

    Parameters
    ----------
    system : FirstOrderSystem, as it is now: relations linked later are not seen
    integrator : EulerMoreauOSI or ZeroOrderHoldOSI, or a name with options, "EulerMoreauOSI(theta=0.5)"
    time_step : Δt > 0 [s]
    solver : of the complementarity problems, see ``saltus.numerics.solvers()``
    tolerance : of these problems and of Newton's method, relative to the terms that cancel
    record_every : keep every n-th row

    Raises
    ------
    ValueError
        If Δt is not positive and finite, a weight is outside [0, 1], the solver is unknown or cannot take the
        model, f, y or r is not finite at t0, or ZeroOrderHoldOSI is given a system that is not linear with
        constant A, or whose M is singular.
    """

    def __init__(
        self,
        system: FirstOrderSystem,
        integrator: Scheme | str,
        time_step: float,
        *,
        solver: str = "auto",
        tolerance: float = 1e-12,
        record_every: int = 1,
    ) -> None:
        if not isinstance(system, FirstOrderSystem):
            raise TypeError(f"system must be a FirstOrderSystem, got {type(system).__name__}")
        scheme = make_scheme(integrator) if isinstance(integrator, str) else integrator
        if not isinstance(scheme, Scheme):
            raise TypeError(f"integrator must be an EulerMoreauOSI or ZeroOrderHoldOSI, got {integrator!r}")
        if not isinstance(time_step, Real):
            raise TypeError(f"time_step must be a number, got {type(time_step).__name__}")
        hold = isinstance(scheme, ZeroOrderHoldOSI)
        weights = EulerMoreauOSI(theta=0.0) if hold else scheme
        super().__init__(
            system,
            **asdict(weights),
            hold=hold,
            time_step=float(time_step),
            solver=registry.solver(solver),
            tolerance=tolerance,
        )
        recording = _core.FirstOrderRecording(record_every)
        self.add_observer(recording)
        self._trajectory: FirstOrderTrajectory = FirstOrderTrajectory(
            recording,
            FirstOrderLayout(tuple(system.dimensions), tuple(system.interactions)),
            Provenance(
                type(scheme).__name__,
                asdict(scheme),
                float(time_step),
                solver,
                int(record_every),
                system.parameters,
            ),
        )

    @property
    def trajectory(self) -> FirstOrderTrajectory:
        """What is recorded so far."""
        return self._trajectory

    def run(self, until: float, progress: Callable[[float], None] | None = None) -> FirstOrderTrajectory:
        """Take all steps with t_k <= until (1 + 1e-12), never a shortened one; a further call continues.

        `progress` is called with the time every few hundred steps.

        Raises
        ------
        SimulationError
            If a step cannot be taken; its ``trajectory`` is what was recorded so far.
        ValueError
            If until is not finite.
        """
        try:
            self.advance(until, progress)
        except SimulationError as error:
            error.trajectory = self._trajectory
            raise
        return self._trajectory

    def step(self) -> FirstOrderReport:
        """Take one step. Raises SimulationError if it cannot be taken."""
        try:
            return self.take_step()
        except SimulationError as error:
            error.trajectory = self._trajectory
            raise

    def __repr__(self) -> str:
        scheme = self._trajectory.provenance.integrator
        return (
            f"<FirstOrderTimeStepping {scheme}: t = {self.t:g} s, {self.steps} steps of {self.time_step:g} s>"
        )
