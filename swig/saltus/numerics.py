"""Solvers of contact problems: find P such that xi = G P + b, and every contact's law holds."""

from saltus._core import ContactSolution, Coulomb, Equality, NonNegative, solve, solvers

__all__ = ["ContactSolution", "Coulomb", "Equality", "NonNegative", "solve", "solvers"]
