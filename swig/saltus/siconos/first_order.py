"""First-order systems, their relations, laws and integrator as scripts compose them."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from saltus import first_order as native
from saltus.siconos.arrays import Named, NotThere, refuse_plugins, to_dense, to_matrix, to_vector
from saltus.siconos.systems import _numbers, read_only

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from saltus.typing import FloatArray


def _dense(matrix: Any, what: str) -> FloatArray:
    return to_dense(to_matrix(matrix, what))


class FirstOrderNonLinearDS(Named):
    """M ẋ = f(t, x) + r.

    Derive from it and override

        def computef(self, time, state): ...             # writes into self.f(), or setFPtr()
        def computeJacobianfx(self, time, state): ...    # likewise self.jacobianfx(), setJacobianfxPtr()

    ∂f/∂x is found by differences if the second is left out, f is zero if both are.

    Parameters
    ----------
    x0 : (n,) initial state

    Raises
    ------
    ValueError
        When the simulation is made: if shapes disagree, or a value is not finite.
    NotImplementedError
        For "Plugin:function".
    """

    def __init__(self, x0: ArrayLike, *plugins: str) -> None:
        refuse_plugins(*plugins)
        self._x0 = to_vector(x0, "x0").copy()
        self._M: FloatArray | None = None
        self._f: FloatArray | None = None
        self._jacobianfx: FloatArray | None = None
        self._z = np.zeros(1)
        self._rhs = np.zeros(len(self._x0))
        self._jacobianRhsx = np.zeros((len(self._x0), len(self._x0)))
        self._number = next(_numbers)
        #: x and r, kept by the simulation
        self.live = self._x0.copy(), np.zeros(len(self._x0))
        self._seen = tuple(read_only(array) for array in self.live)

    def x(self) -> FloatArray:
        """(n,) the state now, live."""
        return self._seen[0]

    def r(self) -> FloatArray:
        """(n,) the input of all relations in the last step, live."""
        return self._seen[1]

    def x0(self) -> FloatArray:
        return read_only(self._x0)

    def dimension(self) -> int:
        return len(self._x0)

    n = dimension

    def number(self) -> int:
        """Of all systems that were ever made."""
        return self._number

    def isLinear(self) -> bool:
        return False

    def M(self) -> FloatArray | None:
        """(n, n), None for the identity."""
        return self._M

    def setMPtr(self, M: Any) -> None:
        self._M = _dense(M, "M")

    def z(self) -> FloatArray:
        """Parameters that relations can use, y = ... + F z; one zero unless setzPtr() says otherwise."""
        return self._z

    def setzPtr(self, z: ArrayLike) -> None:
        self._z = to_vector(z, "z")

    def f(self) -> FloatArray | None:
        """(n,) to be written by computef; None as long as there is none."""
        if self._f is None and self.overrides("computef"):
            self._f = np.zeros(self.dimension())
        return self._f

    def setFPtr(self, f: ArrayLike) -> None:
        self._f = to_vector(f, "f")

    def jacobianfx(self) -> FloatArray | None:
        """(n, n) ∂f/∂x, to be written by computeJacobianfx; None as long as there is none."""
        if self._jacobianfx is None and self.overrides("computeJacobianfx"):
            self._jacobianfx = np.zeros((self.dimension(), self.dimension()))
        return self._jacobianfx

    def setJacobianfxPtr(self, jacobian: Any) -> None:
        self._jacobianfx = _dense(jacobian, "jacobianfx")

    def computef(self, time: float, state: FloatArray) -> None:
        """To be overridden."""

    def computeJacobianfx(self, time: float, state: FloatArray) -> None:
        """To be overridden."""

    def rhs(self) -> FloatArray:
        """(n,) M⁻¹ (f + r) of the last computeRhs()."""
        return self._rhs

    def jacobianRhsx(self) -> FloatArray:
        """(n, n) M⁻¹ ∂f/∂x of the last computeJacobianRhsx()."""
        return self._jacobianRhsx

    def computeRhs(self, time: float) -> None:
        """At the state now."""
        self.computef(time, self.x())
        f = self.f()
        self._rhs[:] = self.r() if f is None else f + self.r()
        if self._M is not None:
            self._rhs[:] = np.linalg.solve(self._M, self._rhs)

    def computeJacobianRhsx(self, time: float) -> None:
        """At the state now."""
        self.computeJacobianfx(time, self.x())
        jacobian = self.jacobianfx()
        self._jacobianRhsx[:] = 0.0 if jacobian is None else jacobian
        if self._M is not None:
            self._jacobianRhsx[:] = np.linalg.solve(self._M, self._jacobianRhsx)

    def update(self, time: float) -> None:
        """Right-hand side and its derivative, at the state now."""
        self.computeRhs(time)
        self.computeJacobianRhsx(time)

    initRhs = update

    def resetToInitialState(self) -> None:
        self.live[0][:] = self._x0

    def resetAllNonSmoothParts(self) -> None:
        self.live[1][:] = 0.0

    def resetNonSmoothPart(self, level: int) -> None:
        """There is one level, whatever is said."""
        self.resetAllNonSmoothParts()

    initializeNonSmoothInput = resetNonSmoothPart

    def display(self, brief: bool = True) -> None:
        print(f"{type(self).__name__} {self._number}: x = {self.x()}, x0 = {self._x0}, r = {self.r()}")

    def overrides(self, *methods: str) -> bool:
        """Say whether the script's class defines one of them."""
        return _overrides(self, *methods)

    def native(self) -> native.FirstOrderNonLinearDS:
        """The system of Saltus. What is not overridden is constant from here on: its arrays are read-only."""
        _freeze(self._M)
        if not self.overrides("computef"):
            _freeze(self._f)
            return native.FirstOrderLinearTIDS(self._x0, None, self._f, self._M)
        methods: dict[str, Callable[..., None]] = {"f": self._write_f}
        if self.overrides("computeJacobianfx"):
            methods["jacobian"] = self._write_jacobian
        made: native.FirstOrderNonLinearDS = _derived(native.FirstOrderNonLinearDS, methods)(
            self._x0, self._M
        )
        return made

    def _write_f(self, t: float, x: FloatArray, out: FloatArray) -> None:
        self.computef(t, x)
        out[:] = self.f()

    def _write_jacobian(self, t: float, x: FloatArray, out: FloatArray) -> None:
        self.computeJacobianfx(t, x)
        out[:] = self.jacobianfx()


class FirstOrderLinearDS(FirstOrderNonLinearDS):
    """M ẋ = A(t) x + b(t) + r.

    Derive from it and override what varies,

        def computeA(self, time): ...          # writes into self.A(), or setAPtr()
        def computeb(self, time): ...          # self.b(), setbPtr()

    Parameters
    ----------
    x0 : (n,) initial state
    A : (n, n), b : (n,), zero if left out
    """

    def __init__(self, x0: ArrayLike, A: Any = None, b: ArrayLike | None = None) -> None:
        super().__init__(x0)
        self._A = None if A is None else _dense(A, "A")
        self._b = None if b is None else to_vector(b, "b")

    def isLinear(self) -> bool:
        return True

    def A(self) -> FloatArray | None:
        """(n, n), None if there is none."""
        if self._A is None and self.overrides("computeA"):
            self._A = np.zeros((self.dimension(), self.dimension()))
        return self._A

    def b(self) -> FloatArray | None:
        """(n,), None if there is none."""
        if self._b is None and self.overrides("computeb"):
            self._b = np.zeros(self.dimension())
        return self._b

    def setAPtr(self, A: Any) -> None:
        self._A = _dense(A, "A")

    def setbPtr(self, b: ArrayLike) -> None:
        self._b = to_vector(b, "b")

    setA, setb = setAPtr, setbPtr

    def computeA(self, time: float) -> None:
        """To be overridden."""

    def computeb(self, time: float) -> None:
        """To be overridden."""

    def computef(self, time: float, state: FloatArray) -> None:
        """A x + b, in f()."""
        self.computeA(time)
        self.computeb(time)
        A, b = self.A(), self.b()
        if A is None and b is None:
            return
        self._f = np.zeros(self.dimension())
        if A is not None:
            self._f += A @ state
        if b is not None:
            self._f += b

    def jacobianfx(self) -> FloatArray | None:
        """(n, n) A."""
        return self.A()

    def computeJacobianfx(self, time: float, state: FloatArray) -> None:
        self.computeA(time)

    def native(self) -> native.FirstOrderNonLinearDS:
        _freeze(self._M)
        methods: dict[str, Callable[..., None]] = {}
        if self.overrides("computeA"):
            methods["A"] = self._write_A
        else:
            _freeze(self._A)
        if self.overrides("computeb"):
            methods["b"] = self._write_b
        else:
            _freeze(self._b)
        if not methods:
            return native.FirstOrderLinearTIDS(self._x0, self._A, self._b, self._M)
        made: native.FirstOrderNonLinearDS = _derived(native.FirstOrderLinearDS, methods)(
            self._x0, self._A, self._b, self._M
        )
        return made

    def _write_A(self, t: float, out: FloatArray) -> None:
        self.computeA(t)
        out[:] = self.A()

    def _write_b(self, t: float, out: FloatArray) -> None:
        self.computeb(t)
        out[:] = self.b()


class FirstOrderLinearTIDS(FirstOrderLinearDS):
    """M ẋ = A x + b + r, all constant."""

    def __init__(self, x0: ArrayLike, A: Any, b: ArrayLike | None = None) -> None:
        super().__init__(x0, A, b)


class FirstOrderR(Named):
    """What relations y = h(t, x, λ), r = g(t, x, λ) have in common.

    C = ∂h/∂x, D = ∂h/∂λ, K = ∂g/∂x, B = ∂g/∂λ.
    """

    def __init__(self) -> None:
        self._matrices: dict[str, FloatArray] = {}
        self._e: FloatArray | None = None

    def C(self) -> FloatArray | None:
        """(rows, n), None if it is not set, likewise the others."""
        return self._matrices.get("C")

    def D(self) -> FloatArray | None:
        """(rows, rows)."""
        return self._matrices.get("D")

    def F(self) -> FloatArray | None:
        """(rows, entries of z), y = ... + F z."""
        return self._matrices.get("F")

    def B(self) -> FloatArray | None:
        """(n, rows)."""
        return self._matrices.get("B")

    def K(self) -> FloatArray | None:
        """(n, n)."""
        return self._matrices.get("K")

    def e(self) -> FloatArray | None:
        """(rows,)."""
        return self._e

    def setCPtr(self, C: Any) -> None:
        self._matrices["C"] = _dense(C, "C")

    def setDPtr(self, D: Any) -> None:
        self._matrices["D"] = _dense(D, "D")

    setConstantD = setDPtr  # of later versions

    def setFPtr(self, F: Any) -> None:
        self._matrices["F"] = _dense(F, "F")

    def setBPtr(self, B: Any) -> None:
        self._matrices["B"] = _dense(B, "B")

    def setKPtr(self, K: Any) -> None:
        self._matrices["K"] = _dense(K, "K")

    def setePtr(self, e: ArrayLike) -> None:
        self._e = to_vector(e, "e")

    def isLinear(self) -> bool:
        return False

    def display(self) -> None:
        entries = ", ".join(f"{name} = {matrix.tolist()}" for name, matrix in self._matrices.items())
        print(f"{type(self).__name__}: {entries}, e = {self._e}")

    def native(self, rows: int, z: FloatArray) -> native.FirstOrderNonLinearR:
        """The relation of Saltus with that many rows, for systems with these parameters."""
        raise NotImplementedError


class FirstOrderLinearR(FirstOrderR):
    """y = C x + D λ + F z + e, r = B λ.

    Derive from it and override what varies with the time,

        def computeC(self, time, z, C): ...    # writes into C; likewise computeD, computeB
        def computee(self, time, z, e): ...

    Parameters
    ----------
    C : (rows, n)
    B : (n, rows)
    D, F, e : instead FirstOrderLinearR(C, D, F, e, B); or setDPtr(), setFPtr(), setePtr()

    Raises
    ------
    TypeError
        If it is given another number of arguments.
    """

    def __init__(self, *matrices: Any) -> None:
        super().__init__()
        refuse_plugins(*matrices)
        if len(matrices) not in (2, 5):
            name = type(self).__name__
            raise TypeError(f"{name} takes C, B or C, D, F, e, B, got {len(matrices)} arguments")
        self.setCPtr(matrices[0])
        self.setBPtr(matrices[-1])
        if len(matrices) == 5:
            self.setDPtr(matrices[1])
            self.setFPtr(matrices[2])
            self.setePtr(matrices[3])

    def isLinear(self) -> bool:
        return True

    def computeC(self, time: float, z: FloatArray, C: FloatArray) -> None:
        """To be overridden, likewise the next ones."""

    def computeD(self, time: float, z: FloatArray, D: FloatArray) -> None:
        """(rows, rows)."""

    def computeB(self, time: float, z: FloatArray, B: FloatArray) -> None:
        """(n, rows)."""

    def computee(self, time: float, z: FloatArray, e: FloatArray) -> None:
        """(rows,)."""

    def native(self, rows: int, z: FloatArray) -> native.FirstOrderNonLinearR:
        constant = self._F_times(rows, z)
        methods: dict[str, Callable[..., None]] = {}
        for name in ("C", "D", "B"):
            if _overrides(self, f"compute{name}"):
                methods[name] = partial(self._write, getattr(self, f"compute{name}"), z, None)
            else:
                _freeze(self._matrices.get(name))
        if _overrides(self, "computee"):
            methods["e"] = partial(self._write, self.computee, z, constant)
        else:
            _freeze(self._e)
            if self._e is not None:
                constant = self._e if constant is None else self._e + constant
        base: Any = _derived(native.FirstOrderLinearR, methods) if methods else native.FirstOrderLinearTIR
        made: native.FirstOrderNonLinearR = base(self.C(), self.B(), self.D(), constant)
        return made

    def _F_times(self, rows: int, z: FloatArray) -> FloatArray | None:
        """F z, None if there is no F."""
        F = self.F()
        if F is None:
            return None
        if F.shape != (rows, len(z)):
            raise ValueError(f"F must be {(rows, len(z))} as z has {len(z)} entries, got {F.shape}")
        _freeze(F)
        product: FloatArray = F @ z
        return product

    @staticmethod
    def _write(
        compute: Callable[..., None], z: FloatArray, offset: FloatArray | None, t: float, out: FloatArray
    ) -> None:
        compute(t, z, out)
        if offset is not None:
            out += offset


class FirstOrderLinearTIR(FirstOrderLinearR):
    """The same with constant matrices."""


class FirstOrderNonLinearR(FirstOrderR):
    """y = h(t, x, λ), r = g(t, x, λ).

    Derive from it and override, each writing into its last argument,

        def computeh(self, time, x, l, z, y): ...
        def computeg(self, time, x, l, z, r): ...
        def computeJachx(self, time, x, l, z, C): ...
        def computeJachlambda(self, time, x, l, z, D): ...
        def computeJacgx(self, time, x, l, z, K): ...
        def computeJacglambda(self, time, x, l, z, B): ...

    x is [x1; x2] between two systems. A derivative that is set, setCPtr() and so on, is not asked for; one
    that is neither set nor defined is found by differences.

    Raises NotImplementedError for "Plugin:function".
    """

    #: derivatives: what sets it, its name in `saltus.kernel`, what computes it
    JACOBIANS = (
        ("C", "output_dx", "computeJachx"),
        ("D", "output_dlambda", "computeJachlambda"),
        ("K", "input_dx", "computeJacgx"),
        ("B", "input_dlambda", "computeJacglambda"),
    )

    def __init__(self, *plugins: str) -> None:
        super().__init__()
        refuse_plugins(*plugins)

    def arguments(self, method: str, x: FloatArray, lam: FloatArray, z: FloatArray) -> tuple[FloatArray, ...]:
        """What stands between the time and the last argument of the method."""
        return x, lam, z

    def native(self, rows: int, z: FloatArray) -> native.FirstOrderNonLinearR:
        def caller(name: str) -> Callable[..., None]:
            compute = getattr(self, name)

            def call(t: float, x: FloatArray, lam: FloatArray, out: FloatArray) -> None:
                compute(t, *self.arguments(name, x, lam, z), out)

            return call

        def constant(matrix: FloatArray) -> Callable[..., None]:
            def write(t: float, x: FloatArray, lam: FloatArray, out: FloatArray) -> None:
                out[:] = matrix

            return write

        for name, signature in (("computeh", "y"), ("computeg", "r")):
            if not hasattr(type(self), name):
                raise NotThere(f"{type(self).__name__} must define {name}(self, ..., {signature})")
        methods = {"output": caller("computeh"), "input": caller("computeg")}
        for entry, method, compute in self.JACOBIANS:
            if entry in self._matrices:
                methods[method] = constant(self._matrices[entry])
            elif hasattr(type(self), compute):
                methods[method] = caller(compute)
        made: native.FirstOrderNonLinearR = _derived(native.FirstOrderNonLinearR, methods)(rows)
        return made


class FirstOrderType1R(FirstOrderNonLinearR):
    """y = h(t, x), r = g(t, λ).

    computeh(time, x, z, y), computeg(time, l, z, r), and their derivatives likewise.
    """

    def arguments(self, method: str, x: FloatArray, lam: FloatArray, z: FloatArray) -> tuple[FloatArray, ...]:
        return (x, z) if method in ("computeh", "computeJachx") else (lam, z)


class FirstOrderType2R(FirstOrderNonLinearR):
    """y = h(t, x, λ), r = g(t, λ).

    computeh(time, x, l, y), computeg(time, l, r), and their derivatives likewise.
    """

    def arguments(self, method: str, x: FloatArray, lam: FloatArray, z: FloatArray) -> tuple[FloatArray, ...]:
        return (lam,) if method in ("computeg", "computeJacglambda") else (x, lam)


class FirstOrderLaw(Named):
    """Laws of `saltus.kernel` between y and λ, with the methods of scripts."""

    def __init__(self, laws: native.BoxLaws) -> None:
        self.native = laws

    def size(self) -> int:
        """Number of rows."""
        return self.native.size

    def display(self) -> None:
        print(f"{type(self).__name__}: {self.size()} rows")


class ComplementarityConditionNSL(FirstOrderLaw):
    """0 ≤ y ⊥ λ ≥ 0 in n rows."""

    def __init__(self, n: int) -> None:
        super().__init__(native.ComplementarityConditionNSL(n))


class RelayNSL(FirstOrderLaw):
    """−y in the normal cone of [lb, ub] at λ in n rows: λ = lb where y > 0, ub where y < 0.

    Raises ValueError if lb > ub, or one is not finite.
    """

    def __init__(self, n: int, lb: float = -1.0, ub: float = 1.0) -> None:
        super().__init__(native.RelayNSL(n, lb, ub))
        self._lb, self._ub = float(lb), float(ub)

    def lb(self) -> float:
        return self._lb

    def ub(self) -> float:
        return self._ub

    def display(self) -> None:
        print(f"RelayNSL: {self.size()} rows, lb = {self._lb}, ub = {self._ub}")


class MixedComplementarityConditionNSL(FirstOrderLaw):
    """y = 0 in the first `equalities` rows, complementarity in `inequalities` others."""

    def __init__(self, inequalities: int, equalities: int) -> None:
        super().__init__(native.MixedComplementarityConditionNSL(equalities, inequalities))
        self._equalities = equalities

    def equalitySize(self) -> int:
        return self._equalities


class EulerMoreauOSI(Named):
    """The scheme of `saltus.kernel.EulerMoreauOSI`; gamma is one as long as it is not given.

    Raises ValueError at the first step if a weight is outside [0, 1].
    """

    def __init__(self, theta: float, gamma: float | None = None) -> None:
        self._theta = float(theta)
        self._gamma = 1.0 if gamma is None else float(gamma)
        self._useGamma = gamma is not None
        self._useGammaForRelation = False

    def theta(self) -> float:
        return self._theta

    def setTheta(self, theta: float) -> None:
        self._theta = float(theta)

    def gamma(self) -> float:
        return self._gamma

    def setGamma(self, gamma: float) -> None:
        self._gamma, self._useGamma = float(gamma), True

    def useGamma(self) -> bool:
        """Say whether gamma is the weight of r."""
        return self._useGamma

    def setUseGamma(self, use: bool) -> None:
        self._useGamma = bool(use)

    def useGammaForRelation(self) -> bool:
        """Say whether gamma is the weight of x in the relation instead."""
        return self._useGammaForRelation

    def setUseGammaForRelation(self, use: bool) -> None:
        self._useGammaForRelation = bool(use)
        if use:
            self._useGamma = False

    def native(self) -> native.EulerMoreauOSI:
        """The integrator of Saltus."""
        used = self._useGamma or self._useGammaForRelation
        return native.EulerMoreauOSI(self._theta, self._gamma if used else 1.0, self._useGammaForRelation)


class ZeroOrderHoldOSI(Named):
    """`saltus.kernel.ZeroOrderHoldOSI`.

    Raises ValueError at the first step if a system is not linear with constant A, or its M is singular.
    """

    def native(self) -> native.ZeroOrderHoldOSI:
        """The integrator of Saltus."""
        return native.ZeroOrderHoldOSI()


def _overrides(instance: object, *methods: str) -> bool:
    """Say whether a script's class defines one of them: those here come from this file."""
    return any(getattr(type(instance), name).__module__ != __name__ for name in methods)


def _freeze(array: FloatArray | None) -> None:
    """What is not overridden is constant from here on."""
    if array is not None:
        array.flags.writeable = False


def _derived(base: type, methods: dict[str, Callable[..., None]]) -> Any:
    """A class derived from one of `saltus.kernel` that has just these methods."""

    def bound(function: Callable[..., None]) -> Callable[..., None]:
        return lambda _self, *arguments: function(*arguments)

    return type(base.__name__, (base,), {name: bound(function) for name, function in methods.items()})
