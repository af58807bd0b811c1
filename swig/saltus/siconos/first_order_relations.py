"""Relations, laws and integrators of first-order systems as scripts compose them."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

from saltus import first_order as native
from saltus.siconos.arrays import Named, NotThere, refuse_late, refuse_plugins, to_vector
from saltus.siconos.first_order import dense, derived, freeze, overrides

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from saltus.typing import FloatArray


class FirstOrderR(Named):
    """What relations y = h(t, x, λ), r = g(t, x, λ) have in common.

    C = ∂h/∂x, D = ∂h/∂λ, K = ∂g/∂x, B = ∂g/∂λ.
    """

    def __init__(self) -> None:
        self._matrices: dict[str, FloatArray] = {}
        self._e: FloatArray | None = None
        self._simulated = False

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

    def _set(self, name: str, matrix: Any) -> None:
        refuse_late(self._simulated, name)
        self._matrices[name] = dense(matrix, name)

    def setCPtr(self, C: Any) -> None:
        self._set("C", C)

    def setDPtr(self, D: Any) -> None:
        self._set("D", D)

    setConstantD = setDPtr  # of later versions

    def setFPtr(self, F: Any) -> None:
        self._set("F", F)

    def setBPtr(self, B: Any) -> None:
        self._set("B", B)

    def setKPtr(self, K: Any) -> None:
        self._set("K", K)

    def setePtr(self, e: ArrayLike) -> None:
        refuse_late(self._simulated, "e")
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
    D, F, e : instead FirstOrderLinearR(C, D, F, e, B); or setDPtr(), setFPtr(), setePtr(). Without
        arguments setCPtr() and setBPtr() as well

    Raises
    ------
    TypeError
        If it is given another number of arguments.
    """

    def __init__(self, *matrices: Any) -> None:
        super().__init__()
        refuse_plugins(*matrices)
        if len(matrices) not in (0, 2, 5):
            name = type(self).__name__
            raise TypeError(f"{name} takes C, B or C, D, F, e, B, got {len(matrices)} arguments")
        if not matrices:
            return
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
            if overrides(self, f"compute{name}"):
                methods[name] = partial(self._write, getattr(self, f"compute{name}"), z, None)
            else:
                freeze(self._matrices.get(name))
        if overrides(self, "computee"):
            methods["e"] = partial(self._write, self.computee, z, constant)
        else:
            freeze(self._e)
            if self._e is not None:
                constant = self._e if constant is None else self._e + constant
        base: Any = derived(native.FirstOrderLinearR, methods) if methods else native.FirstOrderLinearTIR
        C, B, D = map(self._matrices.get, ("C", "B", "D"))
        if C is None or B is None:
            raise ValueError("expected setCPtr() and setBPtr() of a linear relation before the first step")
        self._simulated = True
        made: native.FirstOrderNonLinearR = base(C, B, D, constant)
        return made

    def _F_times(self, rows: int, z: FloatArray) -> FloatArray | None:
        """F z, None if there is no F."""
        F = self._matrices.get("F")
        if F is None:
            return None
        if F.shape != (rows, len(z)):
            raise ValueError(f"F must be {(rows, len(z))} as z has {len(z)} entries, got {F.shape}")
        freeze(F)
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

        self._simulated = True
        for name, signature in (("computeh", "y"), ("computeg", "r")):
            if not hasattr(type(self), name):
                raise NotThere(f"{type(self).__name__} must define {name}(self, ..., {signature})")
        methods = {"output": caller("computeh"), "input": caller("computeg")}
        for entry, method, compute in self.JACOBIANS:
            if entry in self._matrices:
                methods[method] = constant(self._matrices[entry])
            elif hasattr(type(self), compute):
                methods[method] = caller(compute)
        made: native.FirstOrderNonLinearR = derived(native.FirstOrderNonLinearR, methods)(rows)
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

    Raises ValueError at the first step if a weight is outside [0, 1], NotImplementedError if one is set
    after it.
    """

    def __init__(self, theta: float, gamma: float | None = None) -> None:
        self._theta = float(theta)
        self._gamma = 1.0 if gamma is None else float(gamma)
        self._useGamma = gamma is not None
        self._useGammaForRelation = False
        self._simulated = False

    def theta(self) -> float:
        return self._theta

    def setTheta(self, theta: float) -> None:
        refuse_late(self._simulated, "theta")
        self._theta = float(theta)

    def gamma(self) -> float:
        return self._gamma

    def setGamma(self, gamma: float) -> None:
        refuse_late(self._simulated, "gamma")
        self._gamma, self._useGamma = float(gamma), True

    def useGamma(self) -> bool:
        """Say whether gamma is the weight of r."""
        return self._useGamma

    def setUseGamma(self, use: bool) -> None:
        refuse_late(self._simulated, "the use of gamma")
        self._useGamma = bool(use)

    def useGammaForRelation(self) -> bool:
        """Say whether gamma is the weight of x in the relation instead."""
        return self._useGammaForRelation

    def setUseGammaForRelation(self, use: bool) -> None:
        refuse_late(self._simulated, "the use of gamma")
        self._useGammaForRelation = bool(use)
        if use:
            self._useGamma = False

    def native(self) -> native.EulerMoreauOSI:
        """The integrator of Saltus."""
        self._simulated = True
        used = self._useGamma or self._useGammaForRelation
        return native.EulerMoreauOSI(self._theta, self._gamma if used else 1.0, self._useGammaForRelation)


class ZeroOrderHoldOSI(Named):
    """`saltus.kernel.ZeroOrderHoldOSI`.

    Raises ValueError at the first step if a system is not linear with constant A, or its M is singular.
    """

    def native(self) -> native.ZeroOrderHoldOSI:
        """The integrator of Saltus."""
        return native.ZeroOrderHoldOSI()
