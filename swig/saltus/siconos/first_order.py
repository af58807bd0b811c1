"""First-order systems as scripts compose them."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from saltus import first_order as native
from saltus.siconos.arrays import Named, refuse_late, to_dense, to_matrix, to_vector
from saltus.siconos.dynamical_system import numbers, read_only
from saltus.siconos.plugins import PluginFunction, split

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from saltus.typing import FloatArray


def dense(matrix: Any, what: str) -> FloatArray:
    """(rows, columns), memory shared with an array that is one already. Raises ValueError."""
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
    plugins : "Plugin:function" of f, and of its derivative

    Raises
    ------
    ValueError
        If there is no such plugin. When the simulation is made: if shapes disagree, or a value is not finite.
    """

    def __init__(self, x0: ArrayLike, *plugins: str) -> None:
        self._x0 = to_vector(x0, "x0").copy()
        self._M: FloatArray | None = None
        self._f: FloatArray | None = None
        self._jacobianfx: FloatArray | None = None
        self._z = np.zeros(1)
        self._rhs = np.zeros(len(self._x0))
        self._jacobianRhsx = np.zeros((len(self._x0), len(self._x0)))
        self._number = next(numbers)
        self._simulated = False
        #: x and r, kept by the simulation
        self._live = self._x0.copy(), np.zeros(len(self._x0))
        self._seen = tuple(read_only(array) for array in self._live)
        setters = (self.setComputeFFunction, self.setComputeJacobianfxFunction)
        if len(plugins) > len(setters):
            raise TypeError(f"{type(self).__name__} takes {len(setters)} plugins, got {len(plugins)}")
        for plugin, setter in zip(plugins, setters, strict=False):
            setter(*split(plugin))

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
        refuse_late(self._simulated, "M")
        self._M = dense(M, "M")

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
        refuse_late(self._simulated and not self.overrides("computef"), "f")
        self._f = to_vector(f, "f")

    def jacobianfx(self) -> FloatArray | None:
        """(n, n) ∂f/∂x, to be written by computeJacobianfx; None as long as there is none."""
        if self._jacobianfx is None and self.overrides("computeJacobianfx"):
            self._jacobianfx = np.zeros((self.dimension(), self.dimension()))
        return self._jacobianfx

    def setJacobianfxPtr(self, jacobian: Any) -> None:
        self._jacobianfx = dense(jacobian, "jacobianfx")

    def setComputeFFunction(self, library: str, function: str) -> None:
        """f: void f(double t, unsigned n, double* x, double* out, unsigned size_z, double* z).

        Raises ValueError if there is no such library or function, as all of these methods.
        """
        self._plug("computef", library, function, "tnaa", lambda: self.f())

    def setComputeJacobianfxFunction(self, library: str, function: str) -> None:
        """∂f/∂x, with the arguments of f; column by column."""
        self._plug("computeJacobianfx", library, function, "tnaa", lambda: self.jacobianfx())

    def _plug(
        self,
        method: str,
        library: str,
        function: str,
        signature: str,
        written: Callable[[], FloatArray | None],
    ) -> None:
        """Let a function of a plugin stand for an override, of this instance."""
        call = PluginFunction(library, function, signature)
        sizes = signature.count("n")

        def compute(time: float, *state: FloatArray) -> None:
            out = written()
            assert out is not None  # there is one as soon as there is an override
            columns = np.zeros(out.shape, order="F")
            given = [np.array(array, dtype=float) for array in state]
            call(time, *sizes * (self.dimension(),), *given, columns, z=self._z.copy())
            out[:] = columns

        vars(self)[method] = compute

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
        self._live[0][:] = self._x0

    def resetAllNonSmoothParts(self) -> None:
        self._live[1][:] = 0.0

    def resetNonSmoothPart(self, level: int) -> None:
        """There is one level, whatever is said."""
        self.resetAllNonSmoothParts()

    initializeNonSmoothInput = resetNonSmoothPart

    def display(self, brief: bool = True) -> None:
        print(f"{type(self).__name__} {self._number}: x = {self.x()}, x0 = {self._x0}, r = {self.r()}")

    def overrides(self, *methods: str) -> bool:
        """Say whether the script's class defines one of them."""
        return overrides(self, *methods)

    def native(self) -> native.FirstOrderNonLinearDS:
        """The system of Saltus. What is not overridden is constant from here on: its arrays are read-only."""
        self._simulated = True
        freeze(self._M)
        if not self.overrides("computef"):
            freeze(self._f)
            return native.FirstOrderLinearTIDS(self._x0, None, self._f, self._M)
        methods: dict[str, Callable[..., None]] = {"f": self._write_f}
        if self.overrides("computeJacobianfx"):
            methods["jacobian"] = self._write_jacobian
        made: native.FirstOrderNonLinearDS = derived(native.FirstOrderNonLinearDS, methods)(self._x0, self._M)
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
        self._A = None if A is None else dense(A, "A")
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
        refuse_late(self._simulated and not self.overrides("computeA"), "A, unless computeA is overridden,")
        self._A = dense(A, "A")

    def setbPtr(self, b: ArrayLike) -> None:
        refuse_late(self._simulated and not self.overrides("computeb"), "b, unless computeb is overridden,")
        self._b = to_vector(b, "b")

    setA, setb = setAPtr, setbPtr

    def setComputeAFunction(self, library: str, function: str) -> None:
        """A(t): void f(double t, unsigned n, unsigned n, double* out, unsigned nz, double* z), by columns.

        Raises ValueError if there is no such library or function.
        """
        self._plug("computeA", library, function, "tnna", self.A)

    def setComputebFunction(self, library: str, function: str) -> None:
        """b(t): void f(double t, unsigned n, double* out, unsigned size_z, double* z).

        Raises ValueError if there is no such library or function.
        """
        self._plug("computeb", library, function, "tna", self.b)

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
        self._simulated = True
        freeze(self._M)
        methods: dict[str, Callable[..., None]] = {}
        if self.overrides("computeA"):
            methods["A"] = self._write_A
        else:
            freeze(self._A)
        if self.overrides("computeb"):
            methods["b"] = self._write_b
        else:
            freeze(self._b)
        if not methods:
            return native.FirstOrderLinearTIDS(self._x0, self._A, self._b, self._M)
        made: native.FirstOrderNonLinearDS = derived(native.FirstOrderLinearDS, methods)(
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


def overrides(instance: object, *methods: str) -> bool:
    """Say whether a script's class defines one of them, or a plugin stands for it."""
    here = "saltus.siconos."
    return any(
        name in vars(instance) or not getattr(type(instance), name).__module__.startswith(here)
        for name in methods
    )


def freeze(array: FloatArray | None) -> None:
    """What is not overridden is constant from here on."""
    if array is not None:
        array.flags.writeable = False


def derived(base: type, methods: dict[str, Callable[..., None]]) -> Any:
    """A class derived from one of `saltus.kernel` that has just these methods."""

    def bound(function: Callable[..., None]) -> Callable[..., None]:
        return lambda _self, *arguments: function(*arguments)

    return type(base.__name__, (base,), {name: bound(function) for name, function in methods.items()})
