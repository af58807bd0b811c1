"""Names of solvers, ids and options as scripts use them."""

from __future__ import annotations

import numpy as np

from saltus.siconos.arrays import Named, NotThere

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


def __getattr__(name: str) -> int:
    if name in SOLVERS:
        return SOLVERS[name][0]
    raise AttributeError(f"saltus.siconos.numerics has no '{name}', of solvers it has {', '.join(SOLVERS)}")


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
