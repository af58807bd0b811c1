"""Siconos's ASCII problems: LCP, mixed LCP, friction in the plane and in space.

LCP: n, matrix, q. Friction: dimension, contacts, matrix, q, mu. Mixed LCP: is there M, q? is there A, B, C,
D, a, b? then numbers of equalities and of complementary rows; then, as the switches say, where blocks of rows
begin and end and for each whether it is complementary, M, q; and A, B, C, D row by row, a, b.

A matrix is its storage, rows, columns, and

- 0, dense: rows, columns, column after column;
- 1, sparse blocks: numbers of blocks, of block rows, of block columns; where these end; the lengths of the
  two lists that follow, row pointers and block columns; then each block, its number and it by columns;
- 2, sparse: a switch, and what CSparse prints.
"""

from __future__ import annotations

import os
import re
from bisect import bisect_right
from itertools import accumulate, pairwise
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import numpy as np
from scipy import sparse

from saltus.numerics.problems import LCP, MLCP, FrictionProblem, Problem

if TYPE_CHECKING:
    from saltus.typing import FloatArray, IntArray, Matrix

DENSE, SPARSE_BLOCK, SPARSE = 0, 1, 2
_INTEGER = re.compile(r"[+-]?[0-9]{1,9}")


class _Words:
    """The words of a file one after the other; what is wrong with one is said with its line."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self._path = os.fspath(path)
        lines = [line.split() for line in Path(path).read_bytes().decode("latin-1").split("\n")]
        self._words = [word for line in lines for word in line]
        self._ends = list(accumulate(len(line) for line in lines))
        self._at = 0

    @property
    def at(self) -> int:
        return self._at

    def fail(self, message: str, at: int | None = None) -> NoReturn:
        position = min(self._at if at is None else at, len(self._words) - 1)
        line = bisect_right(self._ends, position) + 1 if self._words else 1
        raise ValueError(f"{self._path}, line {line}: {message}")

    def peek(self, offset: int = 0) -> str:
        at = self._at + offset
        return self._words[at] if at < len(self._words) else ""

    def word(self, what: str) -> str:
        if self._at >= len(self._words):
            self.fail(f"expected {what}, the file ends here")
        self._at += 1
        return self._words[self._at - 1]

    def integer(self, what: str, least: int = 0, most: int | None = None) -> int:
        at, word = self._at, self.word(what)
        word = word.removesuffix(",")  # in CSparse's text
        upper = "" if most is None else f" and <= {most}"
        if not _INTEGER.fullmatch(word) or int(word) < least or (most is not None and int(word) > most):
            self.fail(f"{what} must be a whole number >= {least}{upper}, got '{word}'", at)
        return int(word)

    def integers(self, count: int, what: str, least: int = 0, most: int | None = None) -> list[int]:
        self.require(count, what)
        return [self.integer(what, least, most) for _ in range(count)]

    def numbers(self, count: int, what: str) -> FloatArray:
        self.require(count, what)
        words = self._words[self._at : self._at + count]
        result = np.empty(count)
        for k, word in enumerate(words):
            try:
                result[k] = float(word)
            except ValueError:
                result[k] = np.nan
            if not np.isfinite(result[k]):
                self.fail(f"{what} must be finite numbers, got '{word}'", self._at + k)
        self._at += count
        return result

    def expect(self, *words: str) -> None:
        for expected in words:
            at, word = self._at, self.word(f"'{expected}'")
            if word != expected:
                self.fail(f"expected '{expected}', got '{word}'", at)

    def skip_line(self) -> None:
        """Go on behind the line of the last word."""
        self._at = self._ends[bisect_right(self._ends, self._at - 1)]

    def require(self, count: int, what: str) -> None:
        """Before anything of that size is made."""
        left = len(self._words) - self._at
        if count > left:
            self._at = len(self._words)
            self.fail(f"{what}: expected {count} numbers, the file ends after {left}")


def read(path: str | os.PathLike[str]) -> Problem:
    """Read a problem. Raises ValueError with the line if it is malformed, OSError if it cannot be read."""
    words = _Words(path)
    head = [words.peek(k) for k in range(7)]
    first = [int(word) if _INTEGER.fullmatch(word) else -1 for word in head]
    # A sparse matrix is followed by a switch and CSparse's text: without it, an LCP of two rows in blocks.
    dim, contacts, storage, rows, columns = first[:5]
    known = storage in (DENSE, SPARSE_BLOCK) or (storage == SPARSE and head[6] == "CSparse")
    if known and dim in (2, 3) and 0 < dim * contacts == rows == columns:
        return _read_friction(words)
    n, storage, rows, columns, after = first[:5]
    mixed = n in (0, 1) and storage in (0, 1) and n + storage > 0
    plain = 0 < n == rows == columns and storage in (DENSE, SPARSE_BLOCK, SPARSE)
    if plain and not (mixed and after == 0):  # where the first block of a mixed one begins
        return _read_lcp(words)
    if mixed:
        return _read_mlcp(words)
    return words.fail(
        "expected the size and the storage of the matrix (LCP), two switches 0 or 1 (mixed LCP), or "
        f"dimension, contacts and storage (friction), got '{' '.join(head[:5])}'"
    )


def _read_lcp(words: _Words) -> LCP:
    n = words.integer("the size")
    M = _read_matrix(words, n, "M")
    return LCP(M, words.numbers(n, "q"))


def _read_friction(words: _Words) -> FrictionProblem:
    dim, contacts = words.integers(2, "dimension and contacts")
    W = _read_matrix(words, dim * contacts, "W")
    q = words.numbers(dim * contacts, "q")
    at = words.at
    mu = words.numbers(contacts, "mu")
    if (mu < 0).any():
        words.fail(f"mu must be >= 0, got {mu.min():g}", at)
    return FrictionProblem(W, q, mu, dim)


def _read_mlcp(words: _Words) -> MLCP:
    whole, parts = words.integers(2, "the switches of M and of A, B, C, D", 0, 1)
    n, m = words.integers(2, "the numbers of equalities and of complementary rows")
    size = n + m
    if whole:
        words.require(size, "M and q")
        ends = [words.integer("the first row of a block", 0, 0)]
        while ends[-1] < size:
            ends.append(words.integer("the first row of a block", ends[-1] + 1, size))
        kinds = words.integers(len(ends) - 1, "the kind of a block", 0, 1)
        equalities = np.repeat(np.array(kinds, dtype=int) == 0, np.diff(ends))
        M = _read_matrix(words, size, "M")
        return MLCP(M, words.numbers(size, "q"), equalities)
    A = words.numbers(n * n, "A").reshape(n, n)
    B = words.numbers(m * m, "B").reshape(m, m)
    C = words.numbers(n * m, "C").reshape(n, m)
    D = words.numbers(m * n, "D").reshape(m, n)
    return MLCP(np.block([[A, C], [D, B]]), words.numbers(size, "a and b"), n)


def _read_matrix(words: _Words, size: int, name: str) -> Matrix:
    storage = words.integer(f"the storage of {name}", DENSE, SPARSE)
    words.integers(2, f"rows and columns of {name}", size, size)
    if storage == DENSE:
        words.integers(2, f"rows and columns of {name}", size, size)
        columns: FloatArray = words.numbers(size * size, name).reshape(size, size)
        return np.ascontiguousarray(columns.T)
    words.require(size, name)  # it may have no entries, but q follows
    return _read_blocks(words, size, name) if storage == SPARSE_BLOCK else _read_sparse(words, size, name)


def _read_blocks(words: _Words, size: int, name: str) -> Matrix:
    blocks = words.integer(f"the number of blocks of {name}")
    counts = words.integers(2, "the numbers of block rows and columns", 0 if blocks == 0 else 1)
    row_ends, column_ends = (_ends(words, count, size) for count in counts)
    filled, blocks_again = words.integers(2, "the lengths of row pointers and block columns")
    if filled < 1 or blocks_again != blocks:
        words.fail(f"expected row pointers and {blocks} block columns, got {filled} and {blocks_again}")
    pointers = words.integers(filled, "a row pointer", 0, blocks)
    columns = words.integers(blocks, "a block column", 0, counts[1] - 1)
    if pointers != sorted(pointers) or [pointers[0], pointers[-1]] != [0, blocks] or filled > counts[0] + 1:
        words.fail(f"the row pointers must rise from 0 to {blocks}, at most {counts[0] + 1} of them")
    rows = np.repeat(np.arange(filled - 1), np.diff(pointers))
    i, j, x = [], [], []
    for k in range(blocks):
        words.integers(1, "the number of a block", k, k)
        r = np.arange(*row_ends[rows[k] : rows[k] + 2])
        c = np.arange(*column_ends[columns[k] : columns[k] + 2])
        x.append(words.numbers(r.size * c.size, f"block {k} of {name}"))  # column after column
        i.append(np.tile(r, c.size))
        j.append(np.repeat(c, r.size))
    return _sparse_of(i, j, x, size)


def _ends(words: _Words, count: int, size: int) -> list[int]:
    ends = [0, *words.integers(count, "the end of a block row or column", 1, size)]
    if any(b <= a for a, b in pairwise(ends)) or ends[-1] != size:
        words.fail(f"the ends of block rows and columns must rise to {size}, got {ends[1:]}")
    return ends


def _read_sparse(words: _Words, size: int, name: str) -> Matrix:
    words.integer("the origin of the sparse matrix")
    words.expect("CSparse")
    words.skip_line()
    triplets = words.peek() == "triplet:"
    words.expect(*["triplet:"] * triplets, f"{size}-by-{size},", "nzmax:")
    words.word("nzmax")
    words.expect("nnz:")
    entries = words.integer(f"the number of entries of {name}")
    words.skip_line()
    words.require((4 if triplets else 3) * entries, name)
    i, j, x = np.empty(entries, dtype=int), np.empty(entries, dtype=int), np.empty(entries)
    column = 0
    for k in range(entries):
        while not triplets and words.peek() == "col":
            words.expect("col")
            column = words.integer("a column", 0, size - 1)
            words.skip_line()
        i[k] = words.integer("a row", 0, size - 1)
        j[k] = words.integer("a column", 0, size - 1) if triplets else column
        words.expect(":")
        x[k] = words.numbers(1, name)[0]
    while not triplets and words.peek() == "col":  # those without entries
        words.expect("col")
        words.skip_line()
    return sparse.csr_array(sparse.coo_array((x, (i, j)), shape=(size, size)))


def _sparse_of(i: list[IntArray], j: list[IntArray], x: list[FloatArray], size: int) -> Matrix:
    if not x:
        return sparse.csr_array((size, size))
    entries = (np.concatenate(x), (np.concatenate(i), np.concatenate(j)))
    return sparse.csr_array(sparse.coo_array(entries, shape=(size, size)))


def write(problem: Problem, path: str | os.PathLike[str]) -> None:
    """Write a problem with a dense matrix; 17 digits, so that the very numbers come back."""
    lines: list[str] = []
    n = problem.q.size
    matrix = problem.dense()
    if isinstance(problem, FrictionProblem):
        if problem.n_equalities:
            raise ValueError(
                f"Siconos's format has no equalities beside friction, got {problem.n_equalities}; write .hdf5"
            )
        lines += [str(problem.dim), str(problem.contacts)]
    elif isinstance(problem, MLCP):
        kinds = problem.equalities
        starts = [k for k in range(n) if k == 0 or kinds[k] != kinds[k - 1]]
        lines += ["1", "0", str(kinds.sum()), str(n - kinds.sum()), " ".join(map(str, [*starts, n]))]
        lines += [" ".join("0" if kinds[k] else "1" for k in starts)]
    else:
        lines += [str(n)]
    lines += ["0", str(n), str(n), f"{n} {n}", *map(_row, matrix.T), _row(problem.q)]
    if isinstance(problem, FrictionProblem):
        lines += [_row(problem.mu)]
    Path(path).write_text("\n".join(lines) + "\n", encoding="ascii")


def _row(values: FloatArray) -> str:
    return " ".join(f"{value:.17g}" for value in values)
