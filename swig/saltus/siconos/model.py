"""Models as scripts compose them: systems and the interactions between them."""

from __future__ import annotations

from typing import Any, ClassVar, TypeAlias

import numpy as np

from saltus import kernel as native
from saltus.siconos.arrays import Named, methods, refuse_late
from saltus.siconos.dynamical_system import DynamicalSystem
from saltus.siconos.first_order import FirstOrderNonLinearDS
from saltus.siconos.interactions import Interaction

System: TypeAlias = DynamicalSystem | FirstOrderNonLinearDS


class NonSmoothDynamicalSystem(Named):
    """Systems and the interactions between them, from t0 to T [s]."""

    def __init__(self, t0: float, T: float) -> None:
        self._t0, self._T = float(t0), float(T)
        self._systems: list[Any] = []  # of one kind where a simulation is made
        self._links: list[tuple[Interaction, Any, Any]] = []
        self._simulated = False

    def insertDynamicalSystem(self, ds: System) -> None:
        """Nothing if it is inserted already.

        Raises TypeError if it is no system of this package, NotImplementedError once the simulation is made.
        """
        refuse_late(self._simulated, "a model")
        if not isinstance(ds, System):
            raise TypeError(
                "expected a LagrangianDS, a FirstOrderNonLinearDS or one derived from them, "
                f"got {type(ds).__name__}"
            )
        if not any(ds is known for known in self._systems):
            self._systems.append(ds)

    def link(self, interaction: Interaction, ds1: System, ds2: System | None = None) -> None:
        """Let it act between ds1 and the ground or ds2; nothing if it does so already.

        Raises ValueError if a system is not inserted or the interaction is linked elsewhere, TypeError if
        the system is of another kind than the relation, NotImplementedError once the simulation is made.
        """
        refuse_late(self._simulated, "a model")
        for known, *ends in self._links:
            if known is interaction:
                if ends[0] is ds1 and ends[1] is ds2:
                    return
                raise ValueError("expected an interaction that is not linked to other systems")
        for ds in (ds1, *(() if ds2 is None else (ds2,))):
            if not any(ds is known for known in self._systems):
                raise ValueError("expected a system that is inserted, insertDynamicalSystem(), before link()")
            if isinstance(ds, FirstOrderNonLinearDS) != interaction._first_order:
                relation = type(interaction.relation()).__name__
                raise TypeError(
                    f"expected a relation and systems of one kind, got {relation} and {type(ds).__name__}"
                )
        if not interaction._first_order:
            freedoms = sum(methods(ds).dimension() for ds in (ds1, ds2) if ds is not None)
            methods(interaction.relation()).link(methods(interaction).dimension(), freedoms)
        self._links.append((interaction, ds1, ds2))

    hints: ClassVar[dict[str, str]] = dict.fromkeys(
        ("setTitle", "setAuthor", "setDescription", "setDate", "setName"), "not asked"
    )

    def t0(self) -> float:
        return self._t0

    def finalT(self) -> float:
        return self._T

    def setT(self, T: float) -> None:
        self._T = float(T)

    def dynamicalSystem(self, number: int) -> Any:
        """The one that has this number(). Raises ValueError if there is none."""
        for ds in self._systems:
            if ds.number() == number:
                return ds
        raise ValueError(f"no system has the number {number}, got {[ds.number() for ds in self._systems]}")

    def interaction(self, number: int) -> Interaction:
        """The one that has this number(). Raises ValueError if there is none."""
        for interaction, _, _ in self._links:
            if interaction.number() == number:
                return interaction
        raise ValueError(f"no interaction has the number {number}")

    def getNumberOfDS(self) -> int:
        return len(self._systems)

    def getNumberOfInteractions(self) -> int:
        return len(self._links)

    @property
    def _first_order(self) -> bool:
        """Is it made of first-order systems? Raises ValueError if some are and some are not."""
        kinds = {isinstance(ds, FirstOrderNonLinearDS) for ds in self._systems}
        if len(kinds) == 2:
            raise ValueError("expected Lagrangian or first-order systems in a simulation, got both")
        return True in kinds

    def first_order_native(self) -> native.FirstOrderSystem:
        """The model of Saltus, as it is now, of first-order systems."""
        self._simulated = True
        made = {id(ds): methods(ds).native() for ds in self._systems}
        system = native.FirstOrderSystem(list(made.values()), self._t0)
        for interaction, ds1, ds2 in self._links:
            ends = [ds for ds in (ds1, ds2) if ds is not None]
            z = np.concatenate([methods(ds).z() for ds in ends])
            relation = methods(interaction.relation()).native(methods(interaction).dimension(), z)
            system.link(relation, interaction.nonSmoothLaw().native, *(made[id(ds)] for ds in ends))
        return system

    def native(self) -> native.NonSmoothDynamicalSystem:
        """The model of Saltus, as it is now, of Lagrangian systems."""
        self._simulated = True
        made = {id(ds): methods(ds).native() for ds in self._systems}
        system = native.NonSmoothDynamicalSystem(list(made.values()), self._t0)
        for interaction, ds1, ds2 in self._links:
            freedoms = sum(methods(ds).dimension() for ds in (ds1, ds2) if ds is not None)
            second = None if ds2 is None else made[id(ds2)]
            system.link(methods(interaction).native(freedoms), made[id(ds1)], second)
        for ds in self._systems:
            if (held := methods(ds).held()) is not None:
                system.link(held, made[id(ds)])
        return system
