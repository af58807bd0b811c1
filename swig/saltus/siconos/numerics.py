"""Problems, drivers, ids and options as scripts of `siconos.numerics` use them, over `saltus.numerics`."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from saltus import numerics as native
from saltus.siconos.arrays import Named, NotThere, to_matrix

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from saltus.typing import FloatArray, Matrix

__all__ = [
    "LCP",
    "MLCP",
    "FrictionContactProblem",
    "NumericsMatrix",
    "SolverOptions",
    "frictionContact_new_from_filename",
    "linearComplementarity_newFromFilename",
    "mixedLinearComplementarity_newFromFilename",
]

SICONOS_IPARAM_MAX_ITER, SICONOS_IPARAM_ITER_DONE = 0, 1
SICONOS_DPARAM_TOL, SICONOS_DPARAM_RESIDU = 0, 1

#: The one table of solvers: Siconos's name, its id, and the method of Saltus that takes its place
SOLVERS = {
    "SICONOS_MLCP_PGS": (100, "pgs"),
    "SICONOS_MLCP_PSOR": (102, "psor"),
    "SICONOS_MLCP_ENUM": (105, "enumeration"),
    "SICONOS_LCP_LEMKE": (200, "lemke"),
    "SICONOS_LCP_NSGS_SBM": (201, "pgs"),
    "SICONOS_LCP_PGS": (202, "pgs"),
    "SICONOS_LCP_QP": (206, "interior-point"),
    "SICONOS_LCP_NEWTONMIN": (208, "semismooth-newton"),
    "SICONOS_LCP_NEWTON_FB_FBLSA": (209, "fischer-burmeister"),
    "SICONOS_LCP_PSOR": (210, "psor"),
    "SICONOS_LCP_ENUM": (213, "enumeration"),
    "SICONOS_LCP_NEWTON_MIN_FBLSA": (218, "damped-newton"),
    "SICONOS_RELAY_PGS": (300, "pgs"),
    "SICONOS_RELAY_ENUM": (301, "enumeration"),
    "SICONOS_RELAY_LEMKE": (303, "lemke"),
    "SICONOS_FRICTION_2D_NSGS": (400, "nsgs"),
    "SICONOS_FRICTION_2D_LEMKE": (404, "lemke"),
    "SICONOS_FRICTION_2D_ENUM": (405, "enumeration"),
    "SICONOS_FRICTION_3D_NSGS": (500, "nsgs"),
    "SICONOS_FRICTION_3D_PROX": (502, "proximal-newton"),
    "SICONOS_FRICTION_3D_NSN_AC": (504, "semismooth-newton"),
    "SICONOS_FRICTION_3D_DSFP": (505, "prox-fixed-point"),
    "SICONOS_FRICTION_3D_NSN_FB": (513, "damped-newton"),
    "SICONOS_FRICTION_3D_ADMM": (523, "proximal-newton"),
}
_METHODS = dict(SOLVERS.values())

#: Drivers: Siconos's name and the method of Saltus, None where the options say which
DRIVERS = {
    "linearComplementarity_driver": None,
    "lcp_lexicolemke": "lemke",
    "lcp_pgs": "pgs",
    "lcp_psor": "psor",
    "lcp_enum": "enumeration",
    "lcp_qp": "interior-point",
    "lcp_newton_min": "semismooth-newton",
    "lcp_newton_FB": "fischer-burmeister",
    "mlcp_driver": None,
    "mlcp_pgs": "pgs",
    "mlcp_psor": "psor",
    "mlcp_enum": "enumeration",
    "fc2d_driver": None,
    "fc2d_nsgs": "nsgs",
    "fc2d_lemke": "lemke",
    "fc3d_driver": None,
    "fc3d_nsgs": "nsgs",
    "fc3d_nonsmooth_Newton_AlartCurnier": "semismooth-newton",
    "fc3d_nonsmooth_Newton_FischerBurmeister": "damped-newton",
    "fc3d_admm": "proximal-newton",
}

#: Functions that are taken and change nothing, and why
HINTS = {
    "numerics_set_verbose": "solvers print nothing",
    "setNumericsVerbose": "likewise",
    "mlcp_driver_init": "solvers size their own memory",
    "mlcp_driver_reset": "likewise",
}


__all__ += [*SOLVERS, *DRIVERS, *HINTS, *(name for name in globals() if name.startswith("SICONOS_"))]


def __getattr__(name: str) -> int | Callable[..., int]:
    if name in SOLVERS:
        return SOLVERS[name][0]
    if name in DRIVERS:
        return partial(_drive, DRIVERS[name])
    if name in HINTS:
        return lambda *_: 0
    raise AttributeError(
        f"saltus.siconos.numerics has no '{name}', it has {', '.join((*__all__, *SOLVERS, *DRIVERS, *HINTS))}"
    )


def NumericsMatrix(matrix: ArrayLike | Matrix) -> Matrix:
    """A matrix for a problem: an array or one of scipy.sparse, as it is."""
    result: Matrix = to_matrix(matrix, "the matrix")
    return result


class LCP(native.LCP):
    """A linear complementarity problem, see `saltus.numerics.LCP`; without arguments one to be read."""

    def __init__(self, M: ArrayLike | Matrix | None = None, q: ArrayLike = ()) -> None:
        super().__init__(np.zeros((0, 0)) if M is None else M, _column(q))

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return self.q.size


class MLCP(native.MLCP):
    """A mixed linear complementarity problem, see `saltus.numerics.MLCP`; without arguments one to be read.

    Parameters
    ----------
    n_equalities : number of equalities, which come first, or (n,) of bool, true in their rows
    """

    def __init__(
        self, n_equalities: ArrayLike = 0, M: ArrayLike | Matrix | None = None, q: ArrayLike = ()
    ) -> None:
        super().__init__(np.zeros((0, 0)) if M is None else M, _column(q), n_equalities)

    @property
    def n(self) -> int:
        """Number of equalities."""
        return int(self.equalities.sum())

    @property
    def m(self) -> int:
        """Number of inequalities."""
        return self.q.size - self.n


class FrictionContactProblem(native.FrictionProblem):
    """Contacts with Coulomb friction in dim = 2 or 3 dimensions: see `saltus.numerics.FrictionProblem`."""

    def __init__(self, dim: int, M: ArrayLike | Matrix, q: ArrayLike, mu: ArrayLike) -> None:
        super().__init__(M, _column(q), mu, dim)

    @property
    def M(self) -> Matrix:
        """(n, n) W [1/kg]."""
        return self.W

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return self.dim

    @property
    def numberOfContacts(self) -> int:
        return self.contacts


def linearComplementarity_newFromFilename(problem: LCP, filename: str) -> int:
    """Fill an `LCP()` from a file. Raises ValueError if it holds something else."""
    read = _read(filename, native.LCP)
    LCP.__init__(problem, read.M, read.q)
    return 0


def mixedLinearComplementarity_newFromFilename(problem: MLCP, filename: str) -> int:
    """Fill an `MLCP()` from a file. Raises ValueError if it holds something else."""
    read = _read(filename, native.MLCP)
    MLCP.__init__(problem, read.equalities, read.M, read.q)
    return 0


def frictionContact_new_from_filename(filename: str) -> FrictionContactProblem:
    """The contacts in a file. Raises ValueError if it holds something else."""
    read = _read(filename, native.FrictionProblem)
    return FrictionContactProblem(read.dim, read.W, read.q, read.mu)


_P = TypeVar("_P", bound=native.Problem)


def _read(filename: str, kind: type[_P]) -> _P:
    read = native.read_problem(filename)
    if not isinstance(read, kind):
        raise ValueError(f"{filename}: expected the problem to be a {kind.__name__}, got {read!r}")
    return read


def _column(q: ArrayLike) -> FloatArray:
    """(n,) of q, which can be (n, 1) as well."""
    array = np.asarray(q, dtype=float)
    return array[:, 0] if array.ndim == 2 and array.shape[1] == 1 else array


def _drive(
    method: str | None, problem: native.Problem, z: FloatArray, w: FloatArray, options: SolverOptions
) -> int:
    """Solve w = M z + q with the problem's law, from z on.

    Parameters
    ----------
    z : (n,) in: first guess, out: solution
    w : (n,) out
    options : tolerance, and the method unless the driver has one; takes iterations and residual

    Returns
    -------
    int
        0 if it is solved, else 1.

    Raises
    ------
    TypeError
        If z or w is an array that cannot hold real numbers.
    """
    for name, array in (("z", z), ("w", w)):
        if isinstance(array, np.ndarray) and not np.issubdtype(array.dtype, np.floating):
            raise TypeError(f"{name} is written into: expected an array of float64, got {array.dtype}")
    tolerance = float(options.dparam[SICONOS_DPARAM_TOL])
    solution = problem.solve(method or options.method, tolerance, np.array(z))
    z[:] = solution.solution
    w[:] = problem.dense() @ z + problem.q
    options.iparam[SICONOS_IPARAM_ITER_DONE] = solution.iterations
    options.dparam[SICONOS_DPARAM_RESIDU] = solution.residual
    return 0 if solution.status == "solved" else 1


class SolverOptions(Named):
    """Which solver, and its options.

    `dparam[SICONOS_DPARAM_TOL]` is the tolerance of the contact problems, relative to the terms that cancel
    in them. `iparam` is kept and not asked: solvers stop by rules of their own.

    Parameters
    ----------
    arguments : the id of a solver; a problem can stand before it

    Raises
    ------
    NotImplementedError
        If there is no such solver.
    """

    def __init__(self, *arguments: Any) -> None:
        if not 1 <= len(arguments) <= 2:
            raise TypeError(f"SolverOptions takes the id of a solver, got {len(arguments)} arguments")
        id = arguments[-1]
        if id not in _METHODS:
            there = ", ".join(f"{name} = {number}" for name, (number, _) in SOLVERS.items())
            raise NotThere(f"solver {id} is not there, there are {there}")
        self.solverId = id
        self.iparam = np.zeros(20, dtype=int)
        self.dparam = np.zeros(20)
        self.dparam[SICONOS_DPARAM_TOL] = 1e-12

    @property
    def method(self) -> str:
        """Name of the solver in `saltus.numerics.solvers()`."""
        return _METHODS[self.solverId]
