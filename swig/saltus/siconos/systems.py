"""Lagrangian systems as scripts compose them: values that can be set, and overrides of single terms."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from scipy import sparse

from saltus import _core
from saltus import kernel as native
from saltus.siconos.arrays import methods, refuse_late, to_dense, to_matrix, to_vector
from saltus.siconos.dynamical_system import DynamicalSystem, difference, read_only
from saltus.siconos.overridden import Driven, DrivenLinear, Nonlinear, VaryingMass, start
from saltus.siconos.plugins import PluggedTerms, split

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from saltus.typing import FloatArray, Matrix


class LagrangianDS(PluggedTerms, DynamicalSystem):
    """M(q) v̇ + F_int(t, q, v) + F_gyr(q, v) = F_ext(t) + p, q̇ = v.

    Derive from it and override, where the term is not a constant that is set,

        def computeFExt(self, time): ...                          # writes into self.fExt(), or setFExtPtr()
        def computeFInt(self, time, position, velocity): ...      # self.fInt(), setFIntPtr()
        def computeFGyr(self, position, velocity): ...            # self.fGyr(), setFGyrPtr()
        def computeMass(self, position): ...                      # self.mass(), setMassPtr()

    Derivatives of the forces are found by differences where a scheme needs them.

    Parameters
    ----------
    q0, v0 : (n,) initial position and velocity
    mass : (n, n), or "Plugin:function"; the identity if neither it nor computeMass is given

    Raises
    ------
    ValueError
        If there is no such plugin. When the simulation is made: if shapes disagree, or a value is not finite.
    """

    hints: ClassVar[dict[str, str]] = DynamicalSystem.hints | dict.fromkeys(
        (
            "setJacobianFIntqPtr",
            "setJacobianFIntqDotPtr",
            "setJacobianFGyrqPtr",
            "setJacobianFGyrqDotPtr",
        ),
        "derivatives of forces are found by differences",
    )

    def __init__(self, q0: ArrayLike = (), v0: ArrayLike = (), mass: Any = None) -> None:
        DynamicalSystem.__init__(self, q0, v0)
        PluggedTerms.__init__(self)
        if isinstance(mass, str):
            self.setComputeMassFunction(*split(mass))
            mass = None
        self._mass: Matrix | None = None if mass is None else to_matrix(mass, "mass")
        self._K: Matrix | None = None
        self._C: Matrix | None = None
        self._fExt: FloatArray | None = None
        self._fInt: FloatArray | None = None
        self.evaluated_at = np.nan  #: [s] time of fExt() in a simulation
        self._fGyr: FloatArray | None = None
        self._taken: set[str] = set()  # terms that are constants of a simulation
        self._forces: FloatArray | None = None
        self._acceleration = np.zeros(self.dimension())
        self._jacobians: tuple[FloatArray, FloatArray] | None = None

    def mass(self) -> Any:
        """(n, n), to be written by computeMass; fixed for the simulation if that is not overridden."""
        if self._mass is None:
            self._mass = np.eye(len(self._v0))
        return self._mass

    def fExt(self) -> FloatArray:
        """(n,), to be written by computeFExt; fixed for the simulation if that is not overridden."""
        if self._fExt is None:
            self._fExt = np.zeros(len(self._v0))
        return self._fExt

    def fInt(self) -> FloatArray:
        """(n,), likewise of computeFInt."""
        if self._fInt is None:
            self._fInt = np.zeros(len(self._v0))
        return self._fInt

    def fGyr(self) -> FloatArray:
        """(n,), likewise of computeFGyr."""
        if self._fGyr is None:
            self._fGyr = np.zeros(len(self._v0))
        return self._fGyr

    def _refuse_late(self, term: str) -> None:
        """Raises NotImplementedError if a simulation has taken the term as a constant."""
        if term in self._taken:  # overrides set their term in every step
            refuse_late(True, f"{term}, unless compute{term} is overridden,")

    def setMassPtr(self, mass: Any) -> None:
        self._refuse_late("Mass")
        self._mass = to_matrix(mass, "mass")

    def setFExtPtr(self, force: ArrayLike) -> None:
        self._refuse_late("FExt")
        self._fExt = to_vector(force, "fExt")

    def setFIntPtr(self, force: ArrayLike) -> None:
        self._refuse_late("FInt")
        self._fInt = to_vector(force, "fInt")

    def setFGyrPtr(self, force: ArrayLike) -> None:
        self._refuse_late("FGyr")
        self._fGyr = to_vector(force, "fGyr")

    def computeFExt(self, time: float) -> None:
        """To be overridden, unless it is a plugin's."""
        self._call_plugin("FExt", time, self.dimension(), out=self.fExt())

    def computeFInt(self, time: float, position: FloatArray, velocity: FloatArray) -> None:
        """Likewise."""
        self._call_plugin("FInt", time, self.dimension(), position, velocity, out=self.fInt())

    def computeFGyr(self, position: FloatArray, velocity: FloatArray) -> None:
        """Likewise."""
        self._call_plugin("FGyr", self.dimension(), position, velocity, out=self.fGyr())

    def computeMass(self, position: FloatArray) -> None:
        """Likewise."""
        self._call_plugin("Mass", self.dimension(), position, out=self.mass())

    def computeKineticEnergy(self) -> float:
        """½ vᵀ M v [J] now."""
        self.computeMass(self.q())
        return float(0.5 * self.velocity() @ (self.mass() @ self.velocity()))

    def isLinear(self) -> bool:
        return False

    def computeForces(self, time: float, position: ArrayLike, velocity: ArrayLike) -> None:
        """forces() at this time and state."""
        q, v = to_vector(position, "position"), to_vector(velocity, "velocity")
        self._forces = self.evaluate_forces(time, q, v)

    def forces(self) -> FloatArray | None:
        """(n,) F_ext − F_int − F_gyr of the last computeForces(), of linear systems − K q − C v too."""
        return self._forces

    def computeRhs(self, time: float) -> None:
        """rhs() and acceleration() now: M⁻¹ (forces + p(2))."""
        self.computeMass(self.q())
        self.computeForces(time, self.q(), self.velocity())
        total = np.asarray(self._forces) + self.p(2)
        self._acceleration[:] = np.linalg.solve(to_dense(self.mass()), total)

    initRhs = computeRhs

    def rhs(self) -> FloatArray:
        """(2n,) [q̇, v̇] of the last computeRhs()."""
        return np.concatenate([self.velocity(), self._acceleration])

    def acceleration(self) -> FloatArray:
        """(n,) of the last computeRhs()."""
        return read_only(self._acceleration)

    def computeJacobianqForces(self, time: float) -> None:
        """jacobianqForces() and jacobianvForces() now, by central differences."""
        q, v = self.q().copy(), self.velocity().copy()
        self._jacobians = (
            difference(lambda x: -self.evaluate_forces(time, x, v), q),
            difference(lambda x: -self.evaluate_forces(time, q, x), v),
        )

    computeJacobianvForces = computeJacobianqForces

    def jacobianqForces(self) -> FloatArray | None:
        """(n, n) −∂forces/∂q, K of a linear system; None before it is computed."""
        return None if self._jacobians is None else self._jacobians[0]

    def jacobianvForces(self) -> FloatArray | None:
        """(n, n) −∂forces/∂v, C of a linear system; None before it is computed."""
        return None if self._jacobians is None else self._jacobians[1]

    def computeJacobianRhsx(self, time: float) -> None:
        """jacobianRhsx() now, with M kept."""
        self.computeMass(self.q())
        self.computeJacobianqForces(time)

    def jacobianRhsx(self) -> FloatArray:
        """(2n, 2n) [[0, 1], [−M⁻¹K, −M⁻¹C]], with the last jacobianqForces() and jacobianvForces()."""
        n = self.dimension()
        result = np.zeros((2 * n, 2 * n))
        result[:n, n:] = np.eye(n)
        if self._jacobians is not None:
            result[n:] = -np.linalg.solve(to_dense(self.mass()), np.hstack(self._jacobians))
        return result

    def update(self, time: float) -> None:
        """computeRhs() and computeJacobianRhsx()."""
        self.computeRhs(time)
        self.computeJacobianRhsx(time)

    def overrides(self, *methods: str) -> bool:
        """Say whether the script's class defines one of them."""
        return any(getattr(type(self), name) is not getattr(LagrangianDS, name) for name in methods)

    def varies(self, term: str) -> bool:
        """Say whether a term is an override or a plugin's: "Mass", "FExt", "FInt" or "FGyr"."""
        return term in self._plugins or LagrangianDS.overrides(self, f"compute{term}")

    def _plugged(self) -> native.LagrangianDS:
        """With the functions of plugins and the constants, without Python in a step."""
        own = methods(self)
        M, K, C = (None if matrix is None else to_dense(matrix) for matrix in (own.mass(), self._K, self._C))
        force = np.zeros(own.dimension())
        for term, sign in (("FExt", 1.0), ("FInt", -1.0), ("FGyr", -1.0)):
            if term not in self._plugins:
                force += sign * getattr(own, f"f{term[1:]}")()
        M = None if "Mass" in self._plugins else M
        return _core.PluggedDS(*start(self), self._plugins, M, K, C, force, self._z)

    def native(self) -> native.LagrangianDS:
        """The system of Saltus. What is not overridden is constant from here on: its arrays are read-only."""
        own = methods(self)
        terms: tuple[tuple[Any, str], ...] = (
            (own.mass(), "Mass"),
            (own.fExt(), "FExt"),
            (own.fInt(), "FInt"),
            (own.fGyr(), "FGyr"),
            (self._K, ""),
            (self._C, ""),
        )
        for array, term in terms:
            if term and own.varies(term):
                continue
            self._taken.add(term)
            if isinstance(array, np.ndarray):
                array.flags.writeable = False
        self._simulated = True
        if self._plugins and not own.overrides("computeMass", "computeFInt", "computeFGyr", "computeFExt"):
            return LagrangianDS._plugged(self)
        if own.varies("Mass"):
            return VaryingMass(self)
        if own.varies("FInt") or own.varies("FGyr"):
            return Nonlinear(self, to_dense(own.mass()))
        if own.varies("FExt"):
            return DrivenLinear(self) if own.isLinear() else Driven(self)
        force = own.fExt() - own.fInt() - own.fGyr()
        return native.LagrangianLinearTIDS(*start(self), own.mass(), self._K, self._C, force)

    def evaluate_forces(self, t: float, q: FloatArray, v: FloatArray) -> FloatArray:
        """(n,) forces() of the overrides and the constants; meanwhile q() and velocity() are these."""
        kept = start(self)
        self._live[0][:], self._live[1][:] = q, v
        self.computeFExt(t)
        self.computeFInt(t, q, v)
        self.computeFGyr(q, v)
        self._live[0][:], self._live[1][:] = kept
        total = self.fExt() - self.fInt() - self.fGyr()
        for matrix, factor in ((self._K, q), (self._C, v)):
            if matrix is not None:
                total -= matrix @ factor
        return total


class LagrangianLinearTIDS(LagrangianDS):
    """M v̇ + C v + K q = F_ext + p; computeFExt can be overridden, as in LagrangianDS.

    Parameters
    ----------
    q0, v0 : (n,) initial position and velocity
    mass : (n, n) M
    K, C : (n, n) stiffness [N/m] and damping [N s/m], zero if left out
    """

    def __init__(self, q0: ArrayLike, v0: ArrayLike, mass: Any, K: Any = None, C: Any = None) -> None:
        super().__init__(q0, v0, mass)
        if K is not None:
            self.setKPtr(K)
        if C is not None:
            self.setCPtr(C)

    def isLinear(self) -> bool:
        return True

    def driven(self) -> bool:
        return LagrangianDS.overrides(self, "computeFExt")

    def K(self) -> Matrix | None:
        return self._K

    def C(self) -> Matrix | None:
        return self._C

    def setKPtr(self, K: Any) -> None:
        refuse_late(self._simulated, "K")
        self._K = to_matrix(K, "K")

    def setCPtr(self, C: Any) -> None:
        refuse_late(self._simulated, "C")
        self._C = to_matrix(C, "C")


class LagrangianLinearDiagonalDS(LagrangianLinearTIDS):
    """The same with diagonal matrices, of which k, c and m (n,) are the entries; m is one if left out."""

    def __init__(
        self,
        q0: ArrayLike,
        v0: ArrayLike,
        stiffness: ArrayLike,
        damping: ArrayLike | None = None,
        mass: ArrayLike | None = None,
    ) -> None:
        k = to_vector(stiffness, "stiffness")
        m = np.ones(len(k)) if mass is None else to_vector(mass, "mass")
        C = None if damping is None else _diagonal(to_vector(damping, "damping"))
        super().__init__(q0, v0, _diagonal(m), _diagonal(k), C)


def _diagonal(entries: FloatArray) -> Matrix:
    return sparse.csr_array(sparse.diags_array(entries))
