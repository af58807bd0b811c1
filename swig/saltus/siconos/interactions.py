"""Relations, laws and interactions as scripts compose them."""

from __future__ import annotations

from itertools import count
from typing import TYPE_CHECKING, Any

import numpy as np

from saltus import _core
from saltus import kernel as native
from saltus.siconos.arrays import Named, NotThere, methods, refuse_late, to_matrix, to_vector
from saltus.siconos.dynamical_system import read_only
from saltus.siconos.first_order_relations import FirstOrderLaw, FirstOrderR
from saltus.siconos.plugins import PluginFunction, split

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from saltus.typing import FloatArray

_numbers = count()
_NOTHING = np.zeros(0)  # z of Siconos's signatures


class NonSmoothLaw(Named):
    """A law of `saltus.kernel`, `native`, with the methods of scripts."""

    def __init__(self, law: native.NonSmoothLaw) -> None:
        self.native = law

    def size(self) -> int:
        """Number of rows."""
        return self.native.size


class NewtonImpactNSL(NonSmoothLaw):
    """Unilateral contact, restitution e in [0, 1]. Raises ValueError if it is outside."""

    def __init__(self, e: float) -> None:
        super().__init__(native.NewtonImpactNSL(e))
        self._e = float(e)

    def e(self) -> float:
        return self._e


class NewtonImpactFrictionNSL(NonSmoothLaw):
    """Unilateral contact with Coulomb friction mu, restitution en and et, in dim = 2 or 3 dimensions.

    Raises ValueError if one of them is outside what is allowed.
    """

    def __init__(self, en: float, et: float, mu: float, dim: int) -> None:
        super().__init__(native.NewtonImpactFrictionNSL(en, et, mu, dim))
        self._en, self._et, self._mu = float(en), float(et), float(mu)

    def en(self) -> float:
        return self._en

    def et(self) -> float:
        return self._et

    def mu(self) -> float:
        return self._mu


class EqualityConditionNSL(NonSmoothLaw):
    """A bilateral constraint of n rows."""

    def __init__(self, n: int) -> None:
        super().__init__(native.EqualityConditionNSL(n))


class Relation(Named):
    """What relations have in common: H(q), (rows, n), written by computeJachq or set."""

    _signatures: tuple[str, ...] = ()  # of plugins that may be given, in that order

    def __init__(self, *plugins: str) -> None:
        self._jachq: FloatArray | None = None
        self._impulse = _NOTHING
        self._constant = False  # as soon as a simulation has taken H
        if len(plugins) > len(self._signatures):
            raise TypeError(
                f"{type(self).__name__} takes {len(self._signatures)} plugins, got {len(plugins)}"
            )
        self._plugins = [
            PluginFunction(*split(plugin), signature)
            for plugin, signature in zip(plugins, self._signatures, strict=False)
        ]

    def follow(self, impulse: FloatArray) -> None:
        """Be told lambda_(1) of the interaction, live."""
        self._impulse = impulse

    def _call_plugin(self, which: int, *arguments: Any, out: FloatArray, missing: str) -> None:
        if which >= len(self._plugins):
            raise NotThere(f"{type(self).__name__} must define {missing}")
        columns = np.zeros(out.shape, order="F")
        self._plugins[which](*arguments, columns, z=np.zeros(1))
        out[:] = columns

    def overrides(self, base: type, *methods: str) -> bool:
        """Say whether the script's class defines one of the methods of `base`."""
        return any(getattr(type(self), name) is not getattr(base, name) for name in methods)

    def jachq(self) -> FloatArray:
        """(rows, n) H, to be written by computeJachq; there once it is set or the interaction is linked.

        Raises ValueError before that.
        """
        if self._jachq is None:
            raise ValueError("expected an interaction that is linked, or setJachqPtr(), before jachq()")
        return self._jachq

    def C(self) -> FloatArray:
        """(rows, n) H, as jachq()."""
        return self.jachq()

    def setJachqPtr(self, H: Any) -> None:
        refuse_late(self._constant, "H")
        self._jachq = np.asarray(to_matrix(H, "H"))

    def link(self, rows: int, freedoms: int) -> None:
        """Gives H the size that laws and systems ask for, unless it is set."""
        if self._jachq is None:
            self._jachq = np.zeros((rows, freedoms))

    def native(self, rows: int) -> Any:
        """The relation of Saltus with that many rows."""
        raise NotImplementedError


class LagrangianLinearTIR(Relation):
    """y = H q + b, H (rows, n), b (rows,) zero if left out."""

    def __init__(self, H: Any, b: ArrayLike | None = None) -> None:
        super().__init__()
        self.setJachqPtr(H)
        self._b = None if b is None else to_vector(b, "b")

    def e(self) -> FloatArray | None:
        """(rows,) b."""
        return self._b

    def native(self, rows: int) -> native.LagrangianLinearTIR:
        self._constant = True
        return native.LagrangianLinearTIR(methods(self).jachq(), self._b)


class LagrangianScleronomousR(Relation):
    """y = h(q).

    Derive from it and override

        def computeh(self, q, z, y): ...       # writes into y, (rows,)
        def computeJachq(self, q, z): ...      # writes into self.jachq(), or setJachqPtr()

    or give plugins, LagrangianScleronomousR("Plugin:h", "Plugin:H"[, "Plugin:dotH"]):

        void h(unsigned n, double* q, unsigned rows, double* y, unsigned size_z, double* z)
        void H(unsigned n, double* q, unsigned rows, double* H, unsigned size_z, double* z)
        void dotH(unsigned n, double* q, unsigned n, double* v, double* out, unsigned size_z, double* z)

    with matrices column by column. q is [q1; q2] between two systems; z is empty, for plugins one zero.

    Raises ValueError if there is no such plugin.
    """

    _signatures = ("nana", "nana", "nanaa")

    def computeh(self, q: FloatArray, z: FloatArray, y: FloatArray) -> None:
        self._call_plugin(0, len(q), q, len(y), out=y, missing="computeh(self, q, z, y)")

    def computeJachq(self, q: FloatArray, z: FloatArray) -> None:
        H = self.jachq()
        self._call_plugin(1, len(q), q, len(H), out=H, missing="computeJachq(self, q, z)")

    def native(self, rows: int) -> Any:
        if len(self._plugins) >= 2 and not self.overrides(
            LagrangianScleronomousR, "computeh", "computeJachq"
        ):
            h, H, rate = [*self._plugins, None][:3]
            return _core.PluggedRelation(rows, h, H, rate)
        return _Scleronomous(self, rows)


class LagrangianRheonomousR(Relation):
    """y = h(t, q).

    Derive from it and override

        def computeh(self, time, q, z, y): ...
        def computehDot(self, time, q, z): ...     # ∂h/∂t into self.hDot(), (rows,)
        def computeJachq(self, time, q, z): ...

    or give plugins, LagrangianRheonomousR("Plugin:h", "Plugin:H", "Plugin:hDot"), each

        void f(unsigned n, double* q, double t, unsigned rows, double* out, unsigned size_z, double* z)

    Raises ValueError if there is no such plugin.
    """

    _signatures = ("natna", "natna", "natna")

    def __init__(self, *plugins: str) -> None:
        super().__init__(*plugins)
        self._hDot = _NOTHING

    def hDot(self) -> FloatArray:
        """(rows,) ∂h/∂t, to be written by computehDot."""
        return self._hDot

    def link(self, rows: int, freedoms: int) -> None:
        super().link(rows, freedoms)
        self._hDot = np.zeros(rows)

    def computeh(self, time: float, q: FloatArray, z: FloatArray, y: FloatArray) -> None:
        self._call_plugin(0, len(q), q, time, len(y), out=y, missing="computeh(self, time, q, z, y)")

    def computehDot(self, time: float, q: FloatArray, z: FloatArray) -> None:
        rate = self.hDot()
        self._call_plugin(2, len(q), q, time, len(rate), out=rate, missing="computehDot(self, time, q, z)")

    def computeJachq(self, time: float, q: FloatArray, z: FloatArray) -> None:
        H = self.jachq()
        self._call_plugin(1, len(q), q, time, len(H), out=H, missing="computeJachq(self, time, q, z)")

    def native(self, rows: int) -> Any:
        methods = "computeh", "computehDot", "computeJachq"
        if len(self._plugins) == 3 and not self.overrides(LagrangianRheonomousR, *methods):
            return _core.PluggedRheonomousRelation(rows, *self._plugins)
        return _Rheonomous(self, rows)


class _Scleronomous(native.LagrangianScleronomousR):
    """Asks a script's relation; a contact's gap is the first entry of y."""

    def __init__(self, relation: LagrangianScleronomousR, rows: int) -> None:
        super().__init__(rows)
        self._relation: Any = relation
        self._y = np.zeros(rows)

    def gap(self, q: FloatArray, out: FloatArray) -> None:
        self._relation.computeh(q, _NOTHING, self._y)
        out[:] = self._y[: len(out)]

    def jacobian(self, q: FloatArray, out: FloatArray) -> None:
        self._relation.computeJachq(q, _NOTHING)
        out[:] = self._relation._jachq


class _Rheonomous(native.LagrangianRheonomousR):
    def __init__(self, relation: LagrangianRheonomousR, rows: int) -> None:
        super().__init__(rows)
        self._relation: Any = relation
        self._y = np.zeros(rows)

    def gap(self, t: float, q: FloatArray, out: FloatArray) -> None:
        self._relation.computeh(t, q, _NOTHING, self._y)
        out[:] = self._y[: len(out)]

    def jacobian(self, t: float, q: FloatArray, out: FloatArray) -> None:
        self._relation.computeJachq(t, q, _NOTHING)
        out[:] = self._relation._jachq

    def motion(self, t: float, q: FloatArray, out: FloatArray) -> None:
        self._relation.computehDot(t, q, _NOTHING)
        out[:] = self._relation.hDot()


class Interaction(Named):
    """A law that acts in a relation.

    Raises TypeError if the arguments are not a law and a relation of this package that go together.
    """

    _law: Any
    _relation: Any

    def __init__(self, law: Any, relation: Any) -> None:
        self._first_order = isinstance(relation, FirstOrderR)
        laws = (FirstOrderLaw, EqualityConditionNSL) if self._first_order else NonSmoothLaw
        if not isinstance(law, laws) or not isinstance(relation, Relation | FirstOrderR):
            got = f"{type(law).__name__}, {type(relation).__name__}"
            raise TypeError(f"an Interaction takes a law and a relation, got {got}: they must go together")
        self._law: Any = law
        self._relation: Any = relation
        self._number = next(_numbers)
        rows = law.size()
        #: kept by the simulation: y(0), y(1), lambda_(1), lambda_(2), of first-order systems y(0), lambda_(0)
        self._live: Any
        if self._first_order:
            self._live = np.zeros(rows), np.zeros(rows)
        else:
            unilateral = not isinstance(law, EqualityConditionNSL)
            gaps = 1 if unilateral else rows
            self._live = np.zeros(gaps), np.zeros(rows), np.zeros(rows), np.zeros(rows)
        seen = [read_only(array) for array in self._live]
        outputs = len(seen) // 2
        self._outputs = dict(enumerate(seen[:outputs]))
        self._multipliers = dict(enumerate(seen[outputs:], start=outputs - 1))
        if isinstance(relation, Relation):
            methods(relation).follow(seen[outputs])

    def y(self, level: int) -> FloatArray:
        """y(0) the gap [m], of a bilateral constraint all rows; y(1) (rows,) the velocities [m/s].

        Of first-order systems y(0) (rows,). Live, and zero before the first step.
        """
        return self._level("y", self._outputs, level)

    def lambda_(self, level: int) -> FloatArray:
        """(rows,) lambda_(1), the impulse of the last step [N s], that of contact forces over it included,
        and lambda_(2), the contact force now [N], of schemes that have one.

        Of first-order systems lambda_(0). Live.
        """
        return self._level("lambda_", self._multipliers, level)

    @staticmethod
    def _level(name: str, levels: dict[int, FloatArray], level: int) -> FloatArray:
        if level not in levels:
            there = " and ".join(f"{name}({k})" for k in levels)
            raise NotThere(f"{there} {'is' if len(levels) == 1 else 'are'} there, got {name}({level})")
        return levels[level]

    def nonSmoothLaw(self) -> Any:
        return self._law

    def relation(self) -> Any:
        return self._relation

    def dimension(self) -> int:
        """Number of rows."""
        return int(self._law.size())

    def number(self) -> int:
        """Of all interactions that were ever made."""
        return self._number

    def display(self) -> None:
        """Print what it is."""
        law, relation = type(self._law).__name__, type(self._relation).__name__
        values = [f"y({k}) = {array}" for k, array in self._outputs.items()]
        values += [f"lambda_({k}) = {array}" for k, array in self._multipliers.items()]
        print(f"Interaction {self._number}, {law}, {relation}: {', '.join(values)}")

    def native(self, freedoms: int) -> native.Interaction:
        """The interaction of Saltus on systems that have that many freedoms together."""
        relation = methods(self._relation)
        rows = self._law.size()
        relation.link(rows, freedoms)
        return native.Interaction(relation.native(rows), self._law.native)
