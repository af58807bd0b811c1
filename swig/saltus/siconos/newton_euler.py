"""Rigid bodies in space, contacts told by their points and normal, and rotations, as scripts use them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from saltus import kernel as native
from saltus.siconos.arrays import NotThere, refuse_late, to_matrix, to_vector
from saltus.siconos.dynamical_system import DynamicalSystem, difference, read_only
from saltus.siconos.interactions import Relation

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from saltus.typing import FloatArray

_SPACE, _BODY = slice(0, 3), slice(3, 7)  # of q: centre of mass, quaternion (w, x, y, z)


class NewtonEulerDS(DynamicalSystem):
    """m ẍ = F_ext, J Ω̇ + Ω × J Ω = M_ext: q = (x, quaternion), twist = (ẋ, Ω), Ω in the frame of the body.

    Derive from it and override, where the load is not a constant that is set,

        def computeFExt(self, time): ...     # writes into self.fExt(), or setFExtPtr(): in space
        def computeMExt(self, time): ...     # self.mExt(), setMExtPtr(): in the frame of the body

    Parameters
    ----------
    q0 : (7,) centre of mass [m] and unit quaternion (w, x, y, z)
    twist0 : (6,) velocity [m/s] and angular velocity [rad/s]
    mass : [kg]
    inertia : (3, 3) about the centre of mass, in the frame of the body [kg m²]

    Raises
    ------
    ValueError
        If shapes disagree; when the simulation is made: if mass or inertia are not positive definite.
    """

    hints: ClassVar[dict[str, str]] = DynamicalSystem.hints | dict.fromkeys(
        ("setComputeJacobianFIntqByFD", "setComputeJacobianFIntvByFD"), "derivatives are found by differences"
    )

    def __init__(self, q0: ArrayLike, twist0: ArrayLike, mass: float, inertia: Any) -> None:
        super().__init__(q0, twist0)
        if self._q0.shape != (7,) or self._v0.shape != (6,):
            raise ValueError(f"expected 7 coordinates and 6 velocities, got {len(self._q0)}, {len(self._v0)}")
        self._scalar_mass = float(mass)
        self._inertia: FloatArray = np.asarray(to_matrix(inertia, "inertia"))
        if self._inertia.shape != (3, 3):
            raise ValueError(f"expected an inertia of (3, 3), got {self._inertia.shape}")
        self._fExt, self._mExt = np.zeros(3), np.zeros(3)
        self._in_space = False
        self._acceleration = np.zeros(6)
        self._jacobian = np.zeros((6, 6))

    def twist(self) -> FloatArray:
        """(6,) velocity of the centre of mass and angular velocity in the frame of the body, live."""
        return self.velocity()

    def twist0(self) -> FloatArray:
        return self.velocity0()

    def scalarMass(self) -> float:
        """[kg]."""
        return self._scalar_mass

    def inertia(self) -> FloatArray:
        """(3, 3) [kg m²]."""
        return self._inertia

    def mass(self) -> FloatArray:
        """(6, 6) diag(m, m, m, J)."""
        result = np.zeros((6, 6))
        result[:3, :3] = self._scalar_mass * np.eye(3)
        result[3:, 3:] = self._inertia
        return result

    def fExt(self) -> FloatArray:
        """(3,) force in space [N], to be written by computeFExt."""
        return self._fExt

    def mExt(self) -> FloatArray:
        """(3,) moment [N m], to be written by computeMExt."""
        return self._mExt

    def setFExtPtr(self, force: ArrayLike) -> None:
        refuse_late(self._simulated and not _overridden(self, "computeFExt"), "fExt")
        self._fExt = _three(force, "fExt")

    def setMExtPtr(self, moment: ArrayLike) -> None:
        refuse_late(self._simulated and not _overridden(self, "computeMExt"), "mExt")
        self._mExt = _three(moment, "mExt")

    def setIsMextExpressedInInertialFrame(self, value: bool) -> None:
        """Let M_ext be in space, not in the frame of the body."""
        self._in_space = bool(value)

    def computeFExt(self, time: float) -> None:
        """To be overridden."""

    def computeMExt(self, time: float) -> None:
        """To be overridden."""

    def isLinear(self) -> bool:
        return False

    def computeKineticEnergy(self) -> float:
        """½ m ẋ² + ½ Ωᵀ J Ω [J] now."""
        return float(0.5 * self.twist() @ self.mass() @ self.twist())

    def computeForces(self, time: float, position: ArrayLike, twist: ArrayLike) -> None:
        """forces() at this time and state."""
        self._forces = self._evaluate(time, to_vector(position, "position"), to_vector(twist, "twist"))

    def forces(self) -> FloatArray:
        """(6,) force, and moment less Ω × J Ω, of the last computeForces()."""
        return self._forces

    def _evaluate(self, time: float, q: FloatArray, v: FloatArray) -> FloatArray:
        self.computeFExt(time)
        self.computeMExt(time)
        turned = native.rotation_matrix(q[_BODY]).T @ self._mExt if self._in_space else self._mExt
        return np.concatenate([self._fExt, turned - np.cross(v[3:], self._inertia @ v[3:])])

    def computeRhs(self, time: float) -> None:
        """rhs() now."""
        self.computeForces(time, self.q(), self.twist())
        self._acceleration[:] = np.linalg.solve(self.mass(), self._forces + self.p(2))

    initRhs = computeRhs

    def rhs(self) -> FloatArray:
        """(13,) q̇ now and the accelerations of the last computeRhs()."""
        w, axis = self.q()[3], self.q()[4:]
        turn = self.twist()[3:]
        rate = 0.5 * np.concatenate([[-axis @ turn], w * turn + np.cross(axis, turn)])
        return np.concatenate([self.twist()[:3], rate, self._acceleration])

    def acceleration(self) -> FloatArray:
        """(6,) of the last computeRhs()."""
        return read_only(self._acceleration)

    def computeJacobianRhsx(self, time: float) -> None:
        """jacobianRhsx() now."""
        q = self.q().copy()
        forces = difference(lambda v: self._evaluate(time, q, v), self.twist().copy())
        self._jacobian[:] = np.linalg.solve(self.mass(), forces)

    def jacobianRhsx(self) -> FloatArray:
        """(6, 6) ∂v̇/∂v of the last computeJacobianRhsx()."""
        return self._jacobian

    def update(self, time: float) -> None:
        """computeRhs() and computeJacobianRhsx()."""
        self.computeRhs(time)
        self.computeJacobianRhsx(time)

    def native(self) -> native.NewtonEulerDS:
        """The body of Saltus. What is not overridden is constant from here on: its arrays are read-only."""
        self._simulated = True
        varying = {name: _overridden(self, name) for name in ("computeFExt", "computeMExt")}
        for array, method in ((self._fExt, "computeFExt"), (self._mExt, "computeMExt")):
            array.flags.writeable = varying[method]
        q, v, _, _ = self._live
        if any(varying.values()):
            return _Loaded(self, q.copy(), v.copy())
        kind = "moment" if self._in_space else "body_moment"
        loads = {"force": self._fExt, kind: self._mExt}
        return native.NewtonEulerDS(q, v, self._scalar_mass, self._inertia, **loads)


class _Loaded(native.NewtonEulerDS):
    """Loads by a script's overrides."""

    def __init__(self, ds: NewtonEulerDS, q: FloatArray, v: FloatArray) -> None:
        super().__init__(q, v, ds.scalarMass(), ds.inertia())
        self._ds = ds

    def force(self, t: float, q: FloatArray, v: FloatArray, out: FloatArray) -> None:
        self._ds.computeFExt(t)
        out[:] = self._ds.fExt()

    def body_moment(self, t: float, q: FloatArray, v: FloatArray, out: FloatArray) -> None:
        out[:] = self._ds._evaluate(t, q, np.zeros(6))[3:]


class NewtonEuler1DR(Relation):
    """y = h(t, q) of a contact that is told by its points and its normal, without friction.

    Derive from it and override

        def computeh(self, time, q, y): ...    # writes y[0], and calls setnc(), setpc1(), setpc2()

    q is [q1; q2] between two bodies. The velocity of the contact is nᵀ (ẋ1 + ω1 × (p − x1) − …), p = pc1.
    """

    tangents = 0

    def __init__(self) -> None:
        super().__init__()
        self._points = {name: np.zeros(3) for name in ("nc", "pc1", "pc2")}

    def setnc(self, normal: ArrayLike) -> None:
        """The normal, from the second body to the first, of length 1."""
        self._points["nc"][:] = _three(normal, "nc")

    def setpc1(self, point: ArrayLike) -> None:
        """The point of the first body [m]."""
        self._points["pc1"][:] = _three(point, "pc1")

    def setpc2(self, point: ArrayLike) -> None:
        """The point of the second body [m]."""
        self._points["pc2"][:] = _three(point, "pc2")

    def nc(self) -> FloatArray:
        return self._points["nc"]

    def pc1(self) -> FloatArray:
        return self._points["pc1"]

    def pc2(self) -> FloatArray:
        return self._points["pc2"]

    def contactForce(self) -> FloatArray:
        """(3,) the impulse of the last step on the first body, in space [N s]."""
        rows = 1 + self.tangents
        directions = np.vstack([self.nc(), *_tangents(self.nc())])[:rows]
        return np.asarray(directions.T @ self._impulse)

    def distance(self) -> float:
        """From point to point, along the normal [m]."""
        return float(self.nc() @ (self.pc1() - self.pc2()))

    def computeh(self, time: float, q: FloatArray, y: FloatArray) -> None:
        raise NotThere(f"{type(self).__name__} must define computeh(self, time, q, y)")

    def native(self, rows: int) -> native.LagrangianRheonomousR:
        if rows != 1 + self.tangents:
            raise ValueError(f"{type(self).__name__} needs a law of {1 + self.tangents} rows, got {rows}")
        return _Points(self, rows)


class NewtonEuler3DR(NewtonEuler1DR):
    """The same with friction: two tangents behind the normal, that nearest to a coordinate axis first."""

    tangents = 2


class _Points(native.LagrangianRheonomousR):
    """Asks a script's relation for its points."""

    def __init__(self, relation: NewtonEuler1DR, rows: int) -> None:
        super().__init__(rows)
        self._relation = relation
        self._y = np.zeros(rows)

    def gap(self, t: float, q: FloatArray, out: FloatArray) -> None:
        self._relation.computeh(t, q, self._y)
        out[:] = self._y[: len(out)]

    def jacobian(self, t: float, q: FloatArray, out: FloatArray) -> None:
        self._relation.computeh(t, q, self._y)
        normal = self._relation.nc()
        directions = np.vstack([normal, *_tangents(normal)])[: len(out)]
        for body, sign in zip(range(len(q) // 7), (1.0, -1.0), strict=False):
            x, quaternion = q[7 * body :][_SPACE], q[7 * body :][_BODY]
            arms = np.cross(self._relation.pc1() - x, directions)
            out[:, 6 * body : 6 * body + 3] = sign * directions
            out[:, 6 * body + 3 : 6 * body + 6] = sign * (arms @ native.rotation_matrix(quaternion))

    def motion(self, t: float, q: FloatArray, out: FloatArray) -> None:
        out[:] = 0.0


def _tangents(normal: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Two directions, orthogonal to the normal and each other."""
    first = np.eye(3)[int(np.argmin(np.abs(normal)))]
    first = first - (first @ normal) * normal
    first /= np.linalg.norm(first)
    return first, np.cross(normal, first)


def _three(values: ArrayLike, what: str) -> FloatArray:
    array = to_vector(values, what)
    if array.shape != (3,):
        raise ValueError(f"{what} must have 3 entries, got {len(array)}")
    return array


def _overridden(ds: NewtonEulerDS, method: str) -> bool:
    return getattr(type(ds), method) is not getattr(NewtonEulerDS, method)


def quaternionFromRotationVector(rotation: Any, q: Any) -> None:
    """Write the quaternion of a turn about `rotation` (3,), by its length [rad], into q[3:7]."""
    turn = _three(rotation, "the rotation vector")
    angle = float(np.linalg.norm(turn))
    axis = turn * (np.sinc(angle / (2.0 * np.pi)) / 2.0)  # sin(φ/2)/φ, also for φ = 0
    for place, value in zip(range(3, 7), (np.cos(angle / 2.0), *axis), strict=True):
        q[place] = float(value)


def rotationVectorFromQuaternion(w: float, x: float, y: float, z: float, rotation: Any) -> None:
    """Write the axis times the angle [rad], in [0, π], of a unit quaternion into `rotation` (3,)."""
    size = float(np.linalg.norm([x, y, z]))
    sign = -1.0 if w < 0.0 else 1.0  # q and −q are the same turn
    factor = 2.0 if size == 0.0 else 2.0 * np.arctan2(size, abs(w)) / size
    for place, value in enumerate((x, y, z)):
        rotation[place] = float(sign * factor * value)


def rotationVectorFromConfiguration(q: Any, rotation: Any) -> None:
    """The same of q[3:7]."""
    rotationVectorFromQuaternion(q[3], q[4], q[5], q[6], rotation)


def changeFrameBodyToAbs(q: Any, v: Any) -> None:
    """Turn v (3,) from the frame of the body to space, v ← R(q[3:7]) v."""
    _turn(native.rotation_matrix(_quaternion(q)), v)


def changeFrameAbsToBody(q: Any, v: Any) -> None:
    """Turn v (3,) from space to the frame of the body, v ← Rᵀ(q[3:7]) v."""
    _turn(native.rotation_matrix(_quaternion(q)).T, v)


def _quaternion(q: Any) -> FloatArray:
    values = to_vector(q, "q")
    if values.shape != (7,):
        raise ValueError(f"q must have 7 entries, got {len(values)}")
    return values[_BODY]


def _turn(matrix: FloatArray, v: Any) -> None:
    for place, value in enumerate(matrix @ _three(v, "the vector")):
        v[place] = float(value)
