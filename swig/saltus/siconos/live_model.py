"""Models that were made with Siconos, as models of Saltus: `adopt`."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from saltus import kernel

if TYPE_CHECKING:
    from saltus.typing import FloatArray


def adopt(nsds: Any) -> kernel.NonSmoothDynamicalSystem:
    """The model of a `siconos.kernel.NonSmoothDynamicalSystem`, as its systems are linked now.

    It starts from q0 and velocity0 at t0. Laws and matrices of linear systems and relations are copied; what
    may be an override or a plugin is asked of the live objects, in which its last position is then seen.
    Objects of Python classes must be kept as long as the model, as for Siconos. The name of an interaction
    is "interaction" and its number().

    Parameters
    ----------
    nsds : of LagrangianDS, LagrangianLinearTIDS, LagrangianLinearDiagonalDS; LagrangianLinearTIR,
        LagrangianScleronomousR, LagrangianRheonomousR, and of Python classes that derive from these;
        NewtonImpactNSL, NewtonImpactFrictionNSL

    Raises
    ------
    TypeError
        If it is no NonSmoothDynamicalSystem of Siconos, or made of something else, which is named.
    ValueError
        If a value is not finite or shapes disagree.
    """
    sk = import_module("siconos.kernel")
    if not isinstance(nsds, sk.NonSmoothDynamicalSystem):
        raise TypeError(f"expected a siconos.kernel.NonSmoothDynamicalSystem, got {type(nsds).__name__}")
    systems = {ds.number(): _system(sk, ds, nsds.t0()) for ds in nsds.dynamicalSystemsVector()}
    model = kernel.NonSmoothDynamicalSystem(list(systems.values()), nsds.t0())
    for interaction in nsds.interactions().interactions():
        linked = nsds.topology().dynamicalSystemsForInteraction(interaction)
        law = _law(sk, interaction.nonSmoothLaw())
        relation = _relation(sk, interaction, linked)
        name = f"interaction {interaction.number()}"
        ends = [systems[ds.number()] for ds in linked]
        model.link(kernel.Interaction(relation, law, name=name), *ends)
    return model


def _refuse(what: str, there: str, got: Any) -> TypeError:
    return TypeError(f"{what} must be {there}, got a {type(got).__name__}")


def _dense(matrix: Any) -> FloatArray:
    return np.array(matrix.toarray() if hasattr(matrix, "toarray") else matrix, dtype=float)


def _system(sk: Any, ds: Any, t0: float) -> kernel.LagrangianDS:
    if not isinstance(ds, sk.LagrangianDS):
        raise _refuse("a system", "a LagrangianDS", sk.cast_NewtonEulerDS(ds) or ds)
    if ds.boundaryConditions() is not None:
        raise _refuse(f"boundary conditions of system {ds.number()}", "none", ds.boundaryConditions())
    if not isinstance(ds, sk.LagrangianLinearTIDS):
        return _Live(ds)
    ds.computeFExt(t0)  # an override may make the array
    if ds.fExt() is None:
        K, C = (None if A is None else _dense(A) for A in (ds.K(), ds.C()))
        return kernel.LagrangianLinearTIDS(ds.q0(), ds.velocity0(), _dense(ds.mass()), K, C)
    return _Driven(ds)


# Siconos shows a law as the base class
def _law(sk: Any, law: Any) -> kernel.NonSmoothLaw:
    if friction := sk.cast_NewtonImpactFrictionNSL(law):
        return kernel.NewtonImpactFrictionNSL(friction.en(), friction.et(), friction.mu(), friction.size())
    impact = sk.cast_NewtonImpactNSL(law)
    if impact and impact.size() == 1:
        return kernel.NewtonImpactNSL(impact.e())
    raise _refuse(
        "a law", "a NewtonImpactNSL of one row or a NewtonImpactFrictionNSL", sk.cast_RelayNSL(law) or law
    )


def _relation(sk: Any, interaction: Any, systems: Any) -> Any:
    relation = interaction.relation()
    if isinstance(relation, sk.LagrangianLinearTIR):
        return kernel.LagrangianLinearTIR(_dense(relation.C()), relation.e())
    if isinstance(relation, sk.LagrangianScleronomousR):
        return _Scleronomous(interaction, systems)
    if isinstance(relation, sk.LagrangianRheonomousR):
        return _Rheonomous(interaction, systems)
    there = "a LagrangianLinearTIR, a LagrangianScleronomousR or a LagrangianRheonomousR"
    raise _refuse("a relation", there, relation)


class _Live(kernel.LagrangianDS):
    """M and F of a live system; derivatives by differences."""

    def __init__(self, ds: Any) -> None:
        super().__init__(ds.q0(), ds.velocity0())
        self.ds = ds
        ds.init_forces()
        self.q, self.v = ds.q(), ds.velocity()  # live: terms may look at them

    def mass(self, q: FloatArray, out: FloatArray) -> None:
        self.q[:] = q
        self.ds.computeMass(self.q)
        M = self.ds.mass()
        out[:] = np.eye(len(q)) if M is None else _dense(M)

    def forces(self, t: float, q: FloatArray, v: FloatArray, out: FloatArray) -> None:
        self.q[:] = q
        self.v[:] = v
        self.ds.computeForces(t, self.q, self.v)
        F = self.ds.forces()
        if F is not None:
            out[:] = F


class _Driven(kernel.LagrangianDS):
    """A linear system whose external force may depend on the time."""

    def __init__(self, ds: Any) -> None:
        n = ds.dimension()
        super().__init__(ds.q0(), ds.velocity0(), _dense(ds.mass()))
        self.ds = ds
        self.jacobians = np.zeros((2, n, n))
        for k, matrix in enumerate((ds.K(), ds.C())):
            if matrix is not None:
                self.jacobians[k] = -_dense(matrix)
        self.q, self.v = ds.q(), ds.velocity()

    def forces(self, t: float, q: FloatArray, v: FloatArray, out: FloatArray) -> None:
        self.q[:] = q
        self.v[:] = v
        self.ds.computeFExt(t)
        out[:] = self.ds.fExt()
        out += self.jacobians[0] @ q
        out += self.jacobians[1] @ v

    def force_jacobians(self, t: float, q: FloatArray, v: FloatArray, out: FloatArray) -> None:
        out[:] = self.jacobians


class _Output:
    """y and H of a live interaction; its computeOutput() reads the states of the systems."""

    def __init__(self, interaction: Any, systems: Any) -> None:
        self.interaction, self.relation = interaction, interaction.relation()
        self.q = [ds.q() for ds in systems]
        self.v = [ds.velocity() for ds in systems]
        self.kept = systems  # owners of these arrays

    def gap(self, t: float, q: FloatArray, out: FloatArray) -> None:
        _spread(q, self.q)
        self.interaction.computeOutput(t, 0)
        out[:] = self.interaction.y(0)[: len(out)]

    def jacobian(self, t: float, q: FloatArray, out: FloatArray) -> None:
        _spread(q, self.q)
        self.interaction.computeOutput(t, 1)  # y(1) = H v, for which it computes H
        out[:] = _dense(self.relation.jachq())

    def motion(self, t: float, q: FloatArray, out: FloatArray) -> None:
        _spread(q, self.q)
        for v in self.v:
            v[:] = 0.0
        self.interaction.computeOutput(t, 1)  # y(1) = H v + ∂h/∂t
        out[:] = self.interaction.y(1)


def _spread(values: FloatArray, parts: list[FloatArray]) -> None:
    first = 0
    for part in parts:
        part[:] = values[first : first + len(part)]
        first += len(part)


class _Scleronomous(kernel.LagrangianScleronomousR):
    def __init__(self, interaction: Any, systems: Any) -> None:
        super().__init__(interaction.dimension())
        self.output = _Output(interaction, systems)

    def gap(self, q: FloatArray, out: FloatArray) -> None:
        self.output.gap(0.0, q, out)

    def jacobian(self, q: FloatArray, out: FloatArray) -> None:
        self.output.jacobian(0.0, q, out)


class _Rheonomous(kernel.LagrangianRheonomousR):
    def __init__(self, interaction: Any, systems: Any) -> None:
        super().__init__(interaction.dimension())
        self.output = _Output(interaction, systems)

    def gap(self, t: float, q: FloatArray, out: FloatArray) -> None:
        self.output.gap(t, q, out)

    def jacobian(self, t: float, q: FloatArray, out: FloatArray) -> None:
        self.output.jacobian(t, q, out)

    def motion(self, t: float, q: FloatArray, out: FloatArray) -> None:
        self.output.motion(t, q, out)
