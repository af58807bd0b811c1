"""Problems for their own sake: complementarity and Coulomb friction, solved and judged."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy import sparse

from saltus import _core, notebook, registry
from saltus._core import Coulomb, Equality, NonNegative, ProblemSolution

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from saltus.typing import FloatArray, Matrix

    Sets = list[Equality | NonNegative | Coulomb]


MOST_DENSE_ROWS = 64  #: sparse matrices with more rows stay sparse


class Problem:
    """w = matrix x + q, and a law between w and x in every row or group of rows. Made by its subclasses."""

    _matrix_name = "M"

    def __init__(self, matrix: ArrayLike | Matrix, q: ArrayLike) -> None:
        name = self._matrix_name
        self.q = _numbers(q, "q", 1)
        self._matrix = _matrix(matrix, name)
        n = self.q.size
        if self._matrix.shape != (n, n):
            raise ValueError(
                f"{name} must be ({n}, {n}) as q has {n} entries, got {tuple(self._matrix.shape)}"
            )

    def solve(
        self, solver: str = "auto", tolerance: float = 1e-12, warm_start: ArrayLike | None = None
    ) -> ProblemSolution:
        """Solve it.

        Parameters
        ----------
        solver : name of a contact solver, see `solvers`, or of a plugin's or a Python class
        tolerance : bound on the residual of what is called solved
        warm_start : (n,) where to start; solvers that need no start ignore it

        Returns
        -------
        ProblemSolution
            ``solution`` (n,); ``status``, "solved" only where the residual, computed from the solution
            outside the solver, is within the tolerance, else "ray", "iteration-limit" or "breakdown";
            ``iterations``; ``residual``; ``solver``, the method that answered; ``unique``, whether it is the
            only solution with its w or u, None where it is none or that is not known. "ray" is the answer of
            Lemke's method where its path has no end, and of "auto" where it is so and no other method finds a
            solution.

        Raises
        ------
        ValueError
            If there is no such solver or it does not accept the problem, the tolerance is not positive and
            finite, or the warm start is not finite or has another size.
        """
        name = registry.solver(solver)
        return _core.solve_problem(self._stored(), self.q, self.sets, name, tolerance, warm_start)

    def residual(self, solution: ArrayLike) -> float:
        """The relative residual of a solution (n,), as the class defines it."""
        return _core.problem_residual(self._stored(), self.q, self.sets, solution)

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write it to a file: FCLib's HDF5 (".hdf5", ".h5", friction only) or Siconos's ASCII (".dat").

        Raises
        ------
        ValueError
            If the file's ending is another, or the format does not know such problems.
        OSError
            If the file cannot be written.
        """
        from saltus.numerics import fclib, siconos_files  # they import this module

        ending = Path(path).suffix
        if ending == ".dat":
            siconos_files.write(self, path)
        elif ending in (".hdf5", ".h5"):
            fclib.write(self, path)
        else:
            raise ValueError(f"a problem is written to .hdf5, .h5 or .dat, got '{path}'")

    @property
    def sets(self) -> Sets:
        """The laws in the order of the rows."""
        raise NotImplementedError

    def _repr_html_(self) -> str:
        return notebook.problem(self)

    def _stored(self) -> Matrix:
        """The matrix as the solvers take it: sparse ones stay so where that pays."""
        return self.dense() if self.q.size <= MOST_DENSE_ROWS else self._matrix

    def dense(self) -> FloatArray:
        """The matrix as an array."""
        return self._matrix.toarray() if isinstance(self._matrix, sparse.csr_array) else self._matrix


class LCP(Problem):
    """Linear complementarity problem: w = M z + q, 0 <= w, 0 <= z, wᵀz = 0.

    The residual is ‖min(z, w)‖∞ / (‖q‖∞ + ‖M‖∞ ‖z‖∞).

    Parameters
    ----------
    M : (n, n) array or sparse matrix
    q : (n,)

    Raises
    ------
    ValueError
        If the shapes disagree or a value is not finite.
    """

    @property
    def M(self) -> Matrix:
        """(n, n)."""
        return self._matrix

    @property
    def sets(self) -> Sets:
        """NonNegative in every row."""
        return [NonNegative() for _ in self.q]

    def __repr__(self) -> str:
        return f"LCP({self.q.size} unknowns)"


class MLCP(Problem):
    """Mixed problem: w = M z + q; w = 0 and z free in some rows, 0 <= w, 0 <= z, wᵀz = 0 in the others.

    The residual is that of an `LCP`, with ``|w|`` in the rows of equalities.

    Parameters
    ----------
    M : (n, n) array or sparse matrix
    q : (n,)
    equalities : number of equalities, which come first, or (n,) of bool, true in their rows

    Raises
    ------
    ValueError
        If the shapes disagree, a value is not finite, or there are more equalities than rows.
    """

    def __init__(self, M: ArrayLike | Matrix, q: ArrayLike, equalities: int | ArrayLike) -> None:
        super().__init__(M, q)
        n = self.q.size
        rows = np.asarray(equalities)
        if rows.ndim == 0:
            rows = np.arange(n) < _count(equalities, "the number of equalities", n)
        if rows.shape != (n,) or rows.dtype != np.bool_:
            raise ValueError(
                f"equalities must be a number or ({n},) of bool, got {rows.shape} of {rows.dtype}"
            )
        self.equalities = rows

    @property
    def M(self) -> Matrix:
        """(n, n)."""
        return self._matrix

    @property
    def sets(self) -> Sets:
        """Equality or NonNegative."""
        return [Equality() if equality else NonNegative() for equality in self.equalities]

    def __repr__(self) -> str:
        return f"MLCP({self.q.size} unknowns, {self.equalities.sum()} equalities)"


class FrictionProblem(Problem):
    """Contacts with Coulomb friction: u = W r + q, and at every contact one of open, sticking, sliding.

    That is, with û = u + mu |u_T| n, De Saxcé's term in it,

        |r_T| <= mu r_N,  û in the dual cone,  r·û = 0.

    The rows of a contact are its normal, then its tangents. The residual is the norm of the natural map
    r - proj(r - û/d) as velocity, divided by that of q: d |…| / |q| with d = max |W_kk|; not divided where
    q = 0. So it does not depend on the units of mass and velocity.

    Parameters
    ----------
    W : (n, n) array or sparse matrix [1/kg], may be unsymmetric and rank-deficient
    q : (n,) [m/s]
    mu : friction coefficient, one for all or (contacts,)
    dim : 2 or 3, number of rows of a contact
    n_equalities : number of rows behind those of the contacts in which u = 0 and r is free

    Raises
    ------
    ValueError
        If the shapes disagree, a value is not finite, mu < 0, dim is not 2 or 3, or n is no multiple of it.
    """

    _matrix_name = "W"

    def __init__(
        self, W: ArrayLike | Matrix, q: ArrayLike, mu: ArrayLike, dim: int, *, n_equalities: int = 0
    ) -> None:
        super().__init__(W, q)
        if isinstance(dim, bool) or dim not in (2, 3):
            raise ValueError(f"dim must be 2 or 3, got {dim!r}")
        n = self.q.size
        self.dim = int(dim)
        self.n_equalities = _count(n_equalities, "n_equalities", n)
        contacts, rest = divmod(n - self.n_equalities, self.dim)
        if rest:
            rows = n - self.n_equalities
            raise ValueError(f"the rows of the contacts must be a multiple of dim {dim}, got {rows}")
        one = np.ndim(mu) == 0  # a sparse or ragged one is refused below
        self.mu = np.full(contacts, _numbers([mu], "mu", 1)[0]) if one else _numbers(mu, "mu", 1)
        if self.mu.size != contacts:
            raise ValueError(f"mu must be a number or have {contacts} entries, got {self.mu.size}")
        if (self.mu < 0).any():
            raise ValueError(f"mu must be >= 0, got {self.mu.min():g}")

    @property
    def W(self) -> Matrix:
        """(n, n) [1/kg]."""
        return self._matrix

    @property
    def contacts(self) -> int:
        """Number of contacts."""
        return self.mu.size

    @property
    def sets(self) -> Sets:
        """One Coulomb a contact, then the equalities."""
        return [*(Coulomb(mu, self.dim) for mu in self.mu), *(Equality() for _ in range(self.n_equalities))]

    def __repr__(self) -> str:
        equalities = f", {self.n_equalities} equalities" if self.n_equalities else ""
        return f"FrictionProblem({self.contacts} contacts in {self.dim}D{equalities})"


def lcp(
    M: ArrayLike | Matrix,
    q: ArrayLike,
    solver: str = "auto",
    tolerance: float = 1e-12,
    warm_start: ArrayLike | None = None,
) -> ProblemSolution:
    """Solve a linear complementarity problem: see `LCP` and `Problem.solve`."""
    return LCP(M, q).solve(solver, tolerance, warm_start)


def mlcp(
    M: ArrayLike | Matrix,
    q: ArrayLike,
    n_equalities: int | ArrayLike,
    solver: str = "auto",
    tolerance: float = 1e-12,
    warm_start: ArrayLike | None = None,
) -> ProblemSolution:
    """Solve a mixed linear complementarity problem: see `MLCP` and `Problem.solve`."""
    return MLCP(M, q, n_equalities).solve(solver, tolerance, warm_start)


def friction(
    W: ArrayLike | Matrix,
    q: ArrayLike,
    mu: ArrayLike,
    dim: int,
    solver: str = "auto",
    tolerance: float = 1e-12,
    warm_start: ArrayLike | None = None,
) -> ProblemSolution:
    """Solve contacts with Coulomb friction: see `FrictionProblem` and `Problem.solve`."""
    return FrictionProblem(W, q, mu, dim).solve(solver, tolerance, warm_start)


def stage_problem(
    G: Matrix, b: FloatArray, sets: Sequence[Equality | NonNegative | Coulomb]
) -> FrictionProblem:
    """A contact problem of a simulation as contacts of one dimension and equalities behind them.

    A contact without friction, or with friction in the plane where others are in space, gets tangential rows
    of zeros: nothing moves along them.
    """
    dim = max((law.dim for law in sets if isinstance(law, Coulomb)), default=2)
    source: list[int] = []  # row of G of each new row, -1 for a row of zeros
    equalities: list[int] = []
    mu: list[float] = []
    row = 0
    for law in sets:
        count = law.dim if isinstance(law, Coulomb) else 1
        if isinstance(law, Equality):
            equalities.append(row)
        else:
            mu.append(law.mu if isinstance(law, Coulomb) else 0.0)
            source += [*range(row, row + count), *[-1] * (dim - count)]
        row += count
    order = np.array(source + equalities, dtype=int)
    at = np.flatnonzero(order >= 0)
    spread = sparse.csr_array((np.ones(at.size), (at, order[at])), shape=(order.size, b.size))
    W: sparse.csr_array = spread @ sparse.csr_array(G) @ spread.T
    q: FloatArray = np.asarray(spread @ b)
    if isinstance(G, sparse.csr_array):
        return FrictionProblem(W, q, mu, dim, n_equalities=len(equalities))
    return FrictionProblem(W.toarray(), q, mu, dim, n_equalities=len(equalities))


def _count(value: object, what: str, most: int) -> int:
    if isinstance(value, (int, np.integer)) and not isinstance(value, bool) and 0 <= value <= most:
        return int(value)
    raise ValueError(f"{what} must be a whole number from 0 to {most}, got {value!r}")


def _matrix(values: Any, name: str) -> Matrix:
    if not sparse.issparse(values):
        return _numbers(values, name, 2)
    given: Any = values
    if given.dtype.kind not in "biuf":
        raise ValueError(f"{name} must be a matrix of real numbers, got {given.dtype}")
    if given.ndim != 2:
        raise ValueError(f"{name} must have two axes, got shape {given.shape}")
    matrix: sparse.csr_array = sparse.csr_array(given.astype(np.float64))
    try:
        matrix.check_format(full_check=True)
    except ValueError as error:
        raise ValueError(f"{name} must be a valid sparse matrix: {error}") from error
    matrix.sum_duplicates()  # sorts the columns; the sums must be finite too
    if not np.isfinite(matrix.data).all():
        raise ValueError(f"{name} must be finite, got NaN or infinity")
    return matrix


def _numbers(values: Any, name: str, axes: int) -> FloatArray:
    if np.ma.is_masked(values):
        raise ValueError(f"{name} must not be masked, got masked entries")
    try:
        array = np.asarray(values)
    except ValueError as error:  # ragged
        raise ValueError(f"{name} must be an array of numbers: {error}") from error
    if array.dtype.kind not in "biuf":
        raise ValueError(f"{name} must be an array of real numbers, got {array.dtype}")
    if array.ndim != axes:
        expected = "one axis" if axes == 1 else "two axes"
        raise ValueError(f"{name} must have {expected}, got shape {array.shape}")
    result = np.array(array, dtype=np.float64, order="C")
    if not np.isfinite(result).all():
        raise ValueError(f"{name} must be finite, got NaN or infinity")
    return result
