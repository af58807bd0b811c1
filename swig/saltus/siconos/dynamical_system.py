"""What all mechanical systems of scripts have in common."""

from __future__ import annotations

from itertools import count
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from saltus import kernel as native
from saltus.siconos.arrays import Named, NotThere, refuse_late, to_vector

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from saltus.typing import FloatArray

numbers = count()  #: of systems, of either kind


def read_only(array: FloatArray) -> FloatArray:
    """A view that shows the values and cannot change them."""
    view: FloatArray = array.view()
    view.flags.writeable = False
    return view


class BoundaryCondition(Named):
    """Freedoms whose velocity is zero.

    Raises NotImplementedError for other velocities.

    Parameters
    ----------
    indices : (k,) of velocities
    velocity : (k,) zero
    """

    def __init__(self, indices: ArrayLike, velocity: ArrayLike | None = None) -> None:
        self._indices = np.array(indices, dtype=int, ndmin=1)
        if velocity is not None and np.any(to_vector(velocity, "velocity")):
            raise NotThere(
                "velocities of a boundary condition are zero here; a LagrangianRheonomousR moves them"
            )

    def velocityIndices(self) -> NDArray[np.int_]:
        """(k,), can be written until the simulation is made."""
        return self._indices


class DynamicalSystem(Named):
    """What mechanical systems have in common: a state, and what contacts do to it.

    Parameters
    ----------
    q0, v0 : (coordinates,), (n,) initial position and velocity
    """

    hints: ClassVar[dict[str, str]] = {
        "initializeNonSmoothInput": "impulses and forces of all levels are there",
        "swapInMemory": "the simulation keeps the state that a step starts from",
        "updatePlugins": "terms are evaluated where they are needed",
    }

    def __init__(self, q0: ArrayLike, v0: ArrayLike) -> None:
        self._q0 = to_vector(q0, "q0").copy()
        self._v0 = to_vector(v0, "v0").copy()
        self._number = next(numbers)
        self._simulated = False
        self._boundary: BoundaryCondition | None = None
        #: q, v, p(1) and p(2), kept by the simulation
        self._live = self._q0.copy(), self._v0.copy(), np.zeros(len(self._v0)), np.zeros(len(self._v0))
        self._seen = tuple(read_only(array) for array in self._live)

    def q(self) -> FloatArray:
        """(coordinates,) the position now, live."""
        return self._seen[0]

    def velocity(self) -> FloatArray:
        """(n,) the velocity now, live."""
        return self._seen[1]

    def p(self, level: int) -> FloatArray:
        """(n,) of all interactions p(1) = WΛ, the impulse of the last step [N s], p(2) = Wλ [N] now; live."""
        if level not in (1, 2):
            raise NotThere(f"p(1), the impulse, and p(2), the force, are there, got p({level})")
        return self._seen[1 + level]

    def q0(self) -> FloatArray:
        return read_only(self._q0)

    def velocity0(self) -> FloatArray:
        return read_only(self._v0)

    def setQ(self, q: ArrayLike) -> None:
        """The position to start from. Raises NotImplementedError once the simulation is made."""
        self._take(0, q)

    def setVelocity(self, v: ArrayLike) -> None:
        """The velocity to start from. Raises NotImplementedError once the simulation is made."""
        self._take(1, v)

    def resetToInitialState(self) -> None:
        """Back to q0 and v0. Raises NotImplementedError once the simulation is made."""
        self._take(0, self._q0)
        self._take(1, self._v0)

    def _take(self, index: int, values: ArrayLike) -> None:
        if self._simulated:
            raise NotThere("the state can be set until the simulation is made, its first step does that")
        array = to_vector(values, "the state")
        if array.shape != self._live[index].shape:
            raise ValueError(f"expected {len(self._live[index])} numbers, got {len(array)}")
        self._live[index][:] = array

    def resetNonSmoothPart(self, level: int) -> None:
        """p(level) becomes zero, until the next step."""
        self.p(level)
        self._live[1 + level][:] = 0.0

    def resetAllNonSmoothParts(self) -> None:
        """All p(level) become zero, until the next step."""
        self.resetNonSmoothPart(1)
        self.resetNonSmoothPart(2)

    def setBoundaryConditions(self, condition: BoundaryCondition) -> None:
        """Hold freedoms; the force that this takes is not in p. Raises TypeError if it is something else."""
        if not isinstance(condition, BoundaryCondition):
            raise TypeError(f"expected a BoundaryCondition, got {type(condition).__name__}")
        refuse_late(self._simulated, "a boundary condition")
        self._boundary = condition

    def boundaryConditions(self) -> BoundaryCondition | None:
        return self._boundary

    def driven(self) -> bool:
        """Say whether a force that is an override looks at the state at the start of a step."""
        return False

    def held(self) -> native.Interaction | None:
        """The boundary condition as a bilateral constraint: q_i stays what it is.

        Raises
        ------
        ValueError
            If it names a freedom that there is not.
        NotImplementedError
            For a body with a quaternion.
        """
        if self._boundary is None:
            return None
        indices, n = np.unique(self._boundary.velocityIndices()), len(self._v0)
        if len(self._q0) != n:
            raise NotThere(f"boundary conditions of a {type(self).__name__} are not there, Joint is")
        if len(indices) == 0 or indices[0] < 0 or indices[-1] >= n:
            raise ValueError(f"a boundary condition names velocities from 0 to {n - 1}, got {indices}")
        rows = np.eye(n)[indices]
        relation = native.LagrangianLinearTIR(rows, -rows @ self._live[0])
        return native.Interaction(relation, native.EqualityConditionNSL(len(indices)))

    def dimension(self) -> int:
        """Number of freedoms."""
        return len(self._v0)

    def number(self) -> int:
        """Of all systems that were ever made."""
        return self._number

    def display(self) -> None:
        """Print what it is."""
        q, v, p, force = self._live
        print(f"{type(self).__name__} {self._number}: q = {q}, v = {v}, p(1) = {p}, p(2) = {force}")

    def native(self) -> Any:
        """The system of Saltus."""
        raise NotImplementedError


def difference(function: Callable[[FloatArray], FloatArray], at: FloatArray) -> FloatArray:
    """The derivative by central differences, (n, n); exact to rounding if the function is linear."""
    step = np.cbrt(np.finfo(float).eps) * max(1.0, float(np.abs(at).max(initial=0.0)))
    columns = [function(at + step * e) - function(at - step * e) for e in np.eye(len(at))]
    return np.asarray(np.column_stack(columns) / (2.0 * step))
