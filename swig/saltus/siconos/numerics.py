"""Problems, drivers, ids and options as scripts of `siconos.numerics` use them, over `saltus.numerics`."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from saltus import numerics as native
from saltus.numerics import LCP
from saltus.siconos.arrays import Named, NotThere

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from saltus.typing import FloatArray, Matrix

__all__ = ["LCP", "MLCP", "FrictionContactProblem", "SolverOptions"]

SICONOS_IPARAM_MAX_ITER, SICONOS_IPARAM_ITER_DONE = 0, 1
SICONOS_DPARAM_TOL, SICONOS_DPARAM_RESIDU = 0, 1

#: The one table of solvers: Siconos's name, its id, and the method of Saltus that takes its place
SOLVERS = {
    "SICONOS_MLCP_PGS": (100, "pgs"),
    "SICONOS_MLCP_PSOR": (102, "psor"),
    "SICONOS_MLCP_ENUM": (105, "enumeration"),
    "SICONOS_LCP_LEMKE": (200, "lemke"),
    "SICONOS_LCP_PGS": (202, "pgs"),
    "SICONOS_LCP_NEWTONMIN": (208, "semismooth-newton"),
    "SICONOS_LCP_NEWTON_FB_FBLSA": (209, "fischer-burmeister"),
    "SICONOS_LCP_PSOR": (210, "psor"),
    "SICONOS_LCP_ENUM": (213, "enumeration"),
    "SICONOS_LCP_NEWTON_MIN_FBLSA": (218, "damped-newton"),
    "SICONOS_FRICTION_2D_NSGS": (400, "nsgs"),
    "SICONOS_FRICTION_2D_LEMKE": (404, "lemke"),
    "SICONOS_FRICTION_2D_ENUM": (405, "enumeration"),
    "SICONOS_FRICTION_3D_NSGS": (500, "nsgs"),
    "SICONOS_FRICTION_3D_PROX": (502, "proximal-newton"),
    "SICONOS_FRICTION_3D_NSN_AC": (504, "semismooth-newton"),
    "SICONOS_FRICTION_3D_DSFP": (505, "prox-fixed-point"),
    "SICONOS_FRICTION_3D_NSN_FB": (513, "damped-newton"),
}
_METHODS = dict(SOLVERS.values())

#: Drivers: Siconos's name and the method of Saltus, None where the options say which
DRIVERS = {
    "linearComplementarity_driver": None,
    "lcp_lexicolemke": "lemke",
    "lcp_pgs": "pgs",
    "lcp_psor": "psor",
    "lcp_enum": "enumeration",
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
}

#: Functions that are taken and change nothing, and why
HINTS = {
    "numerics_set_verbose": "solvers print nothing",
    "mlcp_driver_init": "solvers size their own memory",
    "mlcp_driver_reset": "likewise",
}


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


def MLCP(n_equalities: int, M: ArrayLike | Matrix, q: ArrayLike) -> native.MLCP:
    """A mixed linear complementarity problem, the equalities first: see `saltus.numerics.MLCP`."""
    return native.MLCP(M, q, n_equalities)


def FrictionContactProblem(
    dim: int, M: ArrayLike | Matrix, q: ArrayLike, mu: ArrayLike
) -> native.FrictionProblem:
    """Contacts with Coulomb friction in dim = 2 or 3 dimensions: see `saltus.numerics.FrictionProblem`."""
    return native.FrictionProblem(M, q, mu, dim)


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
    """
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

    Raises NotImplementedError if there is no such solver.
    """

    def __init__(self, id: int) -> None:  # Siconos's name
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
