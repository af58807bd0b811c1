"""Solvers of contact problems: find P such that xi = G P + b, and every contact's law holds."""

from saltus._core import ContactSolution, ContactSolver, Coulomb, Equality, NonNegative, solve, solvers
from saltus.registry import register_solver

__all__ = [
    "ContactSolution",
    "ContactSolver",
    "Coulomb",
    "Equality",
    "NonNegative",
    "register_solver",
    "solve",
    "solvers",
]
