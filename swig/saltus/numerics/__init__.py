"""Solvers of contact problems: find P such that xi = G P + b, and every contact's law holds.

`lcp`, `mlcp` and `friction` solve problems for their own sake, `read_problem` reads them from files,
`dump_problems` writes those of a simulation, `random_lcp` and `random_friction` make some.
"""

from saltus._core import (
    ContactSolution,
    ContactSolver,
    Coulomb,
    Equality,
    NonNegative,
    ProblemSolution,
    solve,
    solvers,
)
from saltus.numerics.dump import ProblemDump, dump_problems
from saltus.numerics.files import read_problem
from saltus.numerics.generate import FRICTION_KINDS, LCP_KINDS, random_friction, random_lcp
from saltus.numerics.problems import LCP, MLCP, FrictionProblem, Problem, friction, lcp, mlcp
from saltus.registry import register_solver

__all__ = [
    "FRICTION_KINDS",
    "LCP",
    "LCP_KINDS",
    "MLCP",
    "ContactSolution",
    "ContactSolver",
    "Coulomb",
    "Equality",
    "FrictionProblem",
    "NonNegative",
    "Problem",
    "ProblemDump",
    "ProblemSolution",
    "dump_problems",
    "friction",
    "lcp",
    "mlcp",
    "random_friction",
    "random_lcp",
    "read_problem",
    "register_solver",
    "solve",
    "solvers",
]
