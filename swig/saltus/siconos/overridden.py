"""Systems of Saltus whose terms are the overrides of a script's class."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from saltus import kernel as native
from saltus.siconos.arrays import methods, to_dense

if TYPE_CHECKING:
    from saltus.siconos.dynamical_system import DynamicalSystem
    from saltus.siconos.systems import LagrangianDS
    from saltus.typing import FloatArray


def start(ds: DynamicalSystem) -> tuple[FloatArray, FloatArray]:
    """Position and velocity that a simulation starts from."""
    return ds._live[0].copy(), ds._live[1].copy()


class Nonlinear(native.LagrangianDS):
    """Forces by overrides, derivatives by differences; meanwhile q() and velocity() are those of the call."""

    def __init__(self, ds: LagrangianDS, mass: Any = None) -> None:
        own = methods(ds)
        super().__init__(*start(ds), mass)
        self.ds: Any = ds
        self._q, self._v, _, _ = ds._live
        self._ext, self._int, self._gyr = (own.varies(name) for name in ("FExt", "FInt", "FGyr"))
        constant = np.zeros(len(ds._v0))
        for varies, term in ((self._ext, own.fExt()), (self._int, -own.fInt()), (self._gyr, -own.fGyr())):
            if not varies:
                constant += term
        self._constant = constant if constant.any() else None
        self._linear = tuple((k, matrix) for k, matrix in enumerate((ds._K, ds._C)) if matrix is not None)

    # Several calls a step: what is zero is left out
    def forces(self, t: float, q: FloatArray, v: FloatArray, out: FloatArray) -> None:
        ds = self.ds
        self._q[:] = q
        self._v[:] = v
        if self._constant is not None:
            out[:] = self._constant
        if self._ext:
            ds.computeFExt(t)
            out += ds._fExt
        if self._int:
            ds.computeFInt(t, q, v)
            out -= ds._fInt
        if self._gyr:
            ds.computeFGyr(q, v)
            out -= ds._fGyr
        for k, matrix in self._linear:
            out -= matrix @ (v if k else q)


class VaryingMass(Nonlinear):
    """A mass by override as well."""

    def mass(self, q: FloatArray, out: FloatArray) -> None:
        self.ds.computeMass(q)
        out[:] = self.ds._mass


class DrivenLinear(native.LagrangianLinearTIDS):
    """An external force by override, all else linear. It may look at the state at the start of the step."""

    def __init__(self, ds: LagrangianDS) -> None:
        own = methods(ds)
        super().__init__(*start(ds), own.mass(), ds._K, ds._C)
        self._ds: Any = ds
        self._constant = own.fInt() + own.fGyr()
        self._plain = not self._constant.any()

    def external_force(self, t: float, out: FloatArray) -> None:
        ds = self._ds
        if t != ds.evaluated_at:  # schemes ask twice at the end of a step
            ds.evaluated_at = t
            ds.computeFExt(t)
        out[:] = ds._fExt
        if not self._plain:
            out -= self._constant


class Driven(Nonlinear):
    """An external force by override, a constant mass: that forces have no derivatives is known."""

    def __init__(self, ds: LagrangianDS) -> None:
        super().__init__(ds, to_dense(methods(ds).mass()))

    def force_jacobians(self, t: float, q: FloatArray, v: FloatArray, out: FloatArray) -> None:
        """Zero, as it is at the call."""
