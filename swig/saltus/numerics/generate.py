"""Random problems, easy and hard, the same for the same seed: for tests and benchmarks."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from saltus.numerics.problems import LCP, FrictionProblem

if TYPE_CHECKING:
    from saltus.typing import FloatArray

    Maker = Callable[[np.random.Generator, int], tuple[FloatArray, FloatArray]]

SPREAD = 6.0  #: "badly-scaled": powers of ten between the smallest and the largest entry or mass


def random_lcp(kind: str, n: int, seed: int) -> LCP:
    """A random linear complementarity problem of n unknowns.

    Parameters
    ----------
    kind : one of `LCP_KINDS`
    n, seed : whole numbers, n >= 1, seed >= 0

    Raises
    ------
    ValueError
        If there is no such kind, or n < 1.
    """
    _require(kind, LCP_KINDS, n, "n")
    return LCP(*_LCPS[kind](np.random.default_rng(seed), n))


def random_friction(kind: str, contacts: int, dim: int, seed: int) -> FrictionProblem:
    """Random contacts with friction, W = Hᵀ M⁻¹ H and q = Hᵀ v, as mechanics makes them; solvable.

    Parameters
    ----------
    kind : one of `FRICTION_KINDS`
    contacts, seed : whole numbers, contacts >= 1, seed >= 0
    dim : 2 or 3

    Raises
    ------
    ValueError
        If there is no such kind, contacts < 1, or dim is not 2 or 3.
    """
    _require(kind, FRICTION_KINDS, contacts, "contacts")
    rng = np.random.default_rng(seed)
    n = contacts * dim
    freedoms = max(3, n // 2) if kind == "rank-deficient" else n + 3
    H = rng.normal(size=(freedoms, n))
    v = rng.normal(size=freedoms)
    if kind == "degenerate":
        H = np.rint(H)
        v = np.rint(v) * (rng.random(freedoms) < 0.3)
    spread = SPREAD if kind == "badly-scaled" else 0.0
    there = H + (1e-3 * rng.normal(size=H.shape) if kind == "unsymmetric" else 0.0)
    mobility = 10.0 ** (spread * (rng.random(freedoms) - 0.5))
    return FrictionProblem(there.T @ (mobility[:, None] * H), there.T @ v, rng.random(contacts), dim)


def _require(kind: str, kinds: dict[str, str], n: int, name: str) -> None:
    if kind not in kinds:
        raise ValueError(f"there are the kinds {', '.join(kinds)}, got '{kind}'")
    if n < 1:
        raise ValueError(f"{name} must be >= 1, got {n}")


def _feasible(rng: np.random.Generator, M: FloatArray) -> FloatArray:
    """A q for which w = M z + q >= 0 has a solution z >= 0."""
    n = M.shape[0]
    z = rng.exponential(size=n) * (rng.random(n) < 0.6)
    w = rng.exponential(size=n) * (rng.random(n) < 0.6)
    return w - M @ z


def _gram(rng: np.random.Generator, n: int, rank: int) -> FloatArray:
    A: FloatArray = rng.normal(size=(rank, n))
    return np.asarray(A.T @ A)


def _skew(rng: np.random.Generator, n: int) -> FloatArray:
    A: FloatArray = rng.normal(size=(n, n))
    return np.asarray(A - A.T)


def _semidefinite(rng: np.random.Generator, n: int) -> tuple[FloatArray, FloatArray]:
    M = _gram(rng, n, int(rng.integers(1, n + 1)))
    if rng.random() < 0.5:
        M = M + _skew(rng, n)
    return M, _feasible(rng, M)


def _p_matrix(rng: np.random.Generator, n: int) -> tuple[FloatArray, FloatArray]:
    off = rng.normal(size=(n, n))
    np.fill_diagonal(off, 0.0)
    M = off + np.diag(np.abs(off).sum(axis=1) + rng.exponential(size=n))  # dominant in rows
    return M * 10.0 ** rng.uniform(-1, 1, size=n), rng.normal(size=n)


def _copositive(rng: np.random.Generator, n: int) -> tuple[FloatArray, FloatArray]:
    nonnegative = np.abs(rng.normal(size=(n, n))) * (rng.random((n, n)) < 0.5)
    M = nonnegative + _gram(rng, n, int(rng.integers(1, n + 1)))
    return M, rng.normal(size=n)


def _degenerate(rng: np.random.Generator, n: int) -> tuple[FloatArray, FloatArray]:
    A = rng.integers(-2, 3, size=(n // 2 + 1, n)).astype(float)
    M = A.T @ A
    return M, -M @ (rng.integers(0, 3, size=n) * (rng.random(n) < 0.4))


def _rank_deficient(rng: np.random.Generator, n: int) -> tuple[FloatArray, FloatArray]:
    M = _gram(rng, n, max(1, n // 3))
    return M, _feasible(rng, M)


def _badly_scaled(rng: np.random.Generator, n: int) -> tuple[FloatArray, FloatArray]:
    scale = 10.0 ** (0.5 * SPREAD * (rng.random(n) - 0.5))
    M = scale[:, None] * (_gram(rng, n, n) + 0.1 * np.eye(n)) * scale
    return M, scale * rng.normal(size=n)


def _unsymmetric(rng: np.random.Generator, n: int) -> tuple[FloatArray, FloatArray]:
    return rng.normal(size=(n, n)), rng.normal(size=n)


def _unsolvable(rng: np.random.Generator, n: int) -> tuple[FloatArray, FloatArray]:
    M, q = rng.normal(size=(n, n)), rng.normal(size=n)
    row = int(rng.integers(n))
    M[row] = -np.abs(M[row])
    q[row] = -1.0 - abs(q[row])  # w of that row is negative for every z >= 0
    return M, q


#: Kinds of complementarity problems, and what is known of them
LCP_KINDS = {
    "semidefinite": "M positive semidefinite of any rank, with or without a skew part; solvable",
    "p": "M a P-matrix, unsymmetric; one solution",
    "copositive": "M nonnegative plus semidefinite; solvable as a rule",
    "unsymmetric": "M without structure; may have no solution, or many",
    "degenerate": "M semidefinite of small whole numbers, z = w = 0 in many rows; solvable",
    "rank-deficient": "M semidefinite of rank n/3; solvable",
    "badly-scaled": "M positive definite, scaled so that entries differ by 1e6; one solution",
    "unsolvable": "no z >= 0 makes w >= 0",
}
#: Kinds of friction problems
FRICTION_KINDS = {
    "regular": "more freedoms than rows",
    "rank-deficient": "half as many freedoms as rows",
    "unsymmetric": "W taken at two positions",
    "badly-scaled": "masses between 1e-3 and 1e3",
    "degenerate": "small whole numbers, many contacts at rest",
}
_LCPS: dict[str, Maker] = dict(
    zip(
        LCP_KINDS,
        (
            _semidefinite,
            _p_matrix,
            _copositive,
            _unsymmetric,
            _degenerate,
            _rank_deficient,
            _badly_scaled,
            _unsolvable,
        ),
        strict=True,
    )
)
