"""Complementarity and friction problems for their own sake: known solutions, honesty, what is refused."""

import re
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from saltus import numerics
from saltus.numerics import FRICTION_KINDS, LCP, LCP_KINDS, MLCP, FrictionProblem
from scipy import sparse
from scipy.optimize import linprog

# Cottle, Pang, Stone: The Linear Complementarity Problem, 1992, and others
KNOWN = {
    "a segment of solutions": ([[1, 1], [1, 1]], [-1, -1], None),
    "CPS 4": (
        [[11, 0, 10, -1], [0, 11, 10, -1], [10, 10, 21, -1], [1, 1, 1, 0]],
        [50, 50, 10, -6],
        [2, 2, 2, 92],
    ),
    "CPS 5, singular": ([[1, -1], [-1, 1]], [1, -1], None),
    "Pang": ([[0, -1, -1], [1, 0, 0], [-1, 0, 0]], [0, -1, 1], [1, 0, 0]),
    "Murty": (np.eye(6) + 2 * np.triu(np.ones((6, 6)), 1), -np.ones(6), [0, 0, 0, 0, 0, 1]),
    "diagonal": (np.diag(np.arange(1.0, 10)), -np.ones(9), 1 / np.arange(1.0, 10)),
}


def complementarity(M, q, z, equalities=False):
    w = M @ z + q
    entries = np.where(equalities, w, np.minimum(w, z))
    norm = np.abs(q).max() + np.abs(M).sum(axis=1).max() * np.abs(z).max()
    return np.abs(entries).max() / norm if entries.any() else 0.0


def natural_map(W, q, mu, dim, r):
    """The residual of friction, written with one contact after the other."""
    u, d = W @ r + q, np.abs(np.diag(W)).max()
    entries = []
    for k, friction in enumerate(mu):
        rows = slice(dim * k, dim * (k + 1))
        modified = u[rows] + friction * np.linalg.norm(u[rows][1:]) * np.eye(dim)[0]
        normal, *tangent = r[rows] - modified / d
        length = np.linalg.norm(tangent)
        if length <= friction * normal:
            projected = np.array([normal, *tangent])
        elif normal + friction * length <= 0:
            projected = np.zeros(dim)
        else:
            radius = (normal + friction * length) / (1 + friction**2)
            projected = radius * np.array([1.0, *(friction * np.array(tangent) / length)])
        entries.append(d * (r[rows] - projected))
    return np.linalg.norm(entries) / np.linalg.norm(q)


@pytest.mark.parametrize("solver", ["auto", "lemke", "enumeration"])
@pytest.mark.parametrize("name", KNOWN)
def test_known_solutions(name, solver):
    M, q, z = KNOWN[name]
    answer = numerics.lcp(M, q, solver)
    assert answer.status == "solved"
    assert answer.residual <= 1e-15
    if z is not None:
        np.testing.assert_allclose(answer.solution, z, rtol=1e-14, atol=1e-15)
    assert answer.residual == pytest.approx(complementarity(np.array(M), q, answer.solution), abs=1e-16)


def test_an_answer_reads_well():
    answer = numerics.lcp([[2.0, 1.0], [1.0, 2.0]], [-1.0, -1.0], "lemke")
    assert re.fullmatch(r"solved by lemke in \d iterations, residual [-+.\de]+, 2 unknowns", repr(answer))
    assert (answer.status, answer.solver) == ("solved", "lemke")
    assert repr(LCP(np.eye(3), np.ones(3))) == "LCP(3 unknowns)"
    assert repr(MLCP(np.eye(3), np.ones(3), 1)) == "MLCP(3 unknowns, 1 equalities)"
    assert repr(FrictionProblem(np.eye(6), np.ones(6), 0.5, 3)) == "FrictionProblem(2 contacts in 3D)"


def test_whether_the_reactions_are_the_only_ones():
    legs = np.array([[1, 1, 1], [1, 1, -1], [1, -1, -1], [1, -1, 1]])  # a table: heave, roll, pitch
    for rows, unique in ((legs[:3], True), (legs, False)):
        answer = numerics.lcp(rows @ rows.T, rows @ [-1, 0, 0])
        assert (answer.status, answer.unique) == ("solved", unique)
        assert repr(answer).endswith(" unknowns" if unique else " unknowns, not unique")
        sticking = numerics.friction(
            np.kron(rows @ rows.T, np.eye(2)), np.kron(rows @ [-1, 0, 0], [1, 0]), 0.5, 2
        )
        assert sticking.unique is unique
    assert numerics.mlcp(np.ones((2, 2)), [-1, -1], 2).unique is False
    assert numerics.lcp([[0.0]], [-1.0]).unique is None


def spread(problem, r):
    """How far solutions with the velocities of r are from each other in a coordinate, within a large box."""
    W, dim = problem.dense(), getattr(problem, "dim", 1)
    mu = getattr(problem, "mu", np.zeros(r.size))
    u = W @ r + problem.q
    zero = 1e-9 * (np.abs(problem.q) + np.abs(W) @ np.abs(r)).max()
    bounds, upper, equal = [(-1e3, 1e3)] * r.size, [], []
    for k, friction in enumerate(mu):
        normal = np.eye(r.size)[dim * k]
        bounds[dim * k] = (0, 0 if u[dim * k] > zero else 1e3)
        if dim == 1:
            continue
        tangent, speed = np.eye(r.size)[dim * k + 1], u[dim * k + 1]
        if abs(speed) > zero:
            equal.append(tangent + np.sign(speed) * friction * normal)
        upper += [tangent - friction * normal, -tangent - friction * normal]
    A = np.array([*W, *equal])
    slack = 1e-9 * max(1.0, np.abs(r).max())
    A_ub = np.array([*upper, *A, *-A])
    b_ub = np.concatenate([np.zeros(len(upper)), A @ r, -A @ r]) + slack
    ends = [
        sign * linprog(sign * e, A_ub, b_ub, bounds=bounds).fun for e in np.eye(r.size) for sign in (1, -1)
    ]
    return max(high - low for low, high in zip(ends[::2], ends[1::2], strict=True))


@pytest.mark.parametrize("solver", ["auto", "lemke"])
@pytest.mark.parametrize("dim", [1, 2])
def test_what_is_unique_has_no_other_solution(dim, solver):
    """Whole numbers: dependent columns, rows at rest without a force, and forces on the edge of the cone."""
    said = []
    for seed in range(60):
        rng = np.random.default_rng(seed)
        n = int(rng.integers(1, 5))
        H = rng.integers(-1, 2, size=(int(rng.integers(1, 4)), n * dim)).astype(float)
        q = -H.T @ (H @ (rng.integers(0, 3, size=n * dim) * (rng.random(n * dim) < 0.6)))
        problem = LCP(H.T @ H, q) if dim == 1 else FrictionProblem(H.T @ H, q, rng.integers(0, 3, n) / 2, 2)
        answer = problem.solve(solver)
        if answer.status != "solved":
            continue
        widest = spread(problem, answer.solution)
        assert answer.unique is (widest < 1e-6), (seed, widest, answer)
        said.append(answer.unique)
    assert 0.2 < np.mean(said) < 0.8


class Barrier(numerics.ContactSolver):
    """Solves nothing before two threads are in it."""

    barrier = threading.Barrier(2, timeout=20)

    def solve(self, G, b, sets, P):
        self.barrier.wait()
        P[:] = np.linalg.solve(G, -b)


def test_threads_solve_beside_each_other():
    numerics.register_solver(Barrier)
    with ThreadPoolExecutor(2) as pool:
        answers = list(pool.map(lambda q: numerics.lcp(2 * np.eye(2), [q, q], "Barrier"), (-2.0, -4.0)))
    assert [answer.solution[0] for answer in answers] == [1.0, 2.0]
    assert [answer.status for answer in answers] == ["solved", "solved"]


def test_other_threads_run_while_a_solver_does():
    # no solution: sweeps use up all of their iterations
    problem = LCP(np.kron(np.eye(60), [[1.0, 2.0], [-1.0, -1.0]]), -np.ones(120))
    times, done = [], threading.Event()

    def tick():
        while not done.wait(0.001):
            times.append(time.perf_counter())

    with ThreadPoolExecutor(1) as pool:
        ticks = pool.submit(tick)
        begin = time.perf_counter()
        status = problem.solve("nsgs").status
        end = time.perf_counter()
        done.set()
        ticks.result()
    assert status != "solved"
    middle = begin + 0.1 * (end - begin), begin + 0.9 * (end - begin)
    assert sum(middle[0] < t < middle[1] for t in times) >= 3


def test_where_lemke_ends_in_a_ray():
    game = np.array([[0, 0, 10, 20], [0, 0, 30, 15], [10, 20, 0, 0], [30, 15, 0, 0]])
    assert numerics.lcp(game, -np.ones(4), "lemke").status == "ray"
    assert numerics.lcp(game, -np.ones(4)).status == "solved"  # by another method
    for solver in ("auto", "lemke"):
        assert numerics.lcp([[0.0]], [-1.0], solver).status in ("ray", "breakdown")
        assert numerics.lcp([[1, 2], [-1, -1]], [-1, -1], solver).status == "ray"  # no solution


@pytest.mark.parametrize("solver", list(numerics.solvers()))
def test_nothing_to_do(solver):
    answers = [
        numerics.lcp(np.eye(3), np.zeros(3), solver),
        numerics.mlcp(np.eye(3), np.zeros(3), 1, solver),
        numerics.lcp(np.zeros((0, 0)), [], solver),
    ]
    if solver != "fischer-burmeister":  # knows no friction
        answers.append(numerics.friction(np.eye(4), np.zeros(4), 0.5, 2, solver))
    for answer in answers:
        assert answer.unique is True
        assert (answer.status, answer.residual) == ("solved", 0.0)
        assert not answer.solution.any()


def test_mixed_problems():
    M, q = np.array([[1.0, 2, 0], [0, 1, 1.3333], [0, 0, 1]]), np.array([-1.0, 1, -3])
    for solver in ("auto", "lemke"):
        answer = numerics.mlcp(M, q, 1, solver)
        assert answer.status == "solved"
        np.testing.assert_allclose(answer.solution, [1.0, 0.0, 3.0], atol=1e-14)
    turned = [2, 0, 1]  # the equality last
    answer = numerics.mlcp(M[np.ix_(turned, turned)], q[turned], np.array([False, True, False]))
    np.testing.assert_allclose(answer.solution, [3.0, 1.0, 0.0], atol=1e-14)
    assert complementarity(M, q, [1.0, 0.0, 2.0], [True, False, False]) == pytest.approx(
        MLCP(M, q, 1).residual([1.0, 0.0, 2.0])
    )


@pytest.mark.parametrize("kind", LCP_KINDS)
def test_random_complementarity_problems_are_answered_honestly(kind):
    solvable = "solvable" in LCP_KINDS[kind] or "one solution" in LCP_KINDS[kind]
    for seed in range(400):
        problem = numerics.random_lcp(kind, 1 + seed % 12, seed)
        for solver in ("auto", "lemke"):
            answer = problem.solve(solver)
            error = complementarity(problem.M, problem.q, answer.solution)
            assert (answer.status == "solved") == (error <= 1e-12), (kind, seed, solver)
            assert np.isfinite(answer.solution).all()
            if solvable and kind != "copositive":
                assert answer.status == "solved", (kind, seed, solver)
            if kind == "unsolvable":
                assert answer.status == "ray", (kind, seed, solver)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("kind", FRICTION_KINDS)
def test_random_friction_problems_are_answered_honestly(kind, dim):
    solved = 0
    for seed in range(60):
        problem = numerics.random_friction(kind, 1 + seed % 6, dim, seed)
        answer = problem.solve()
        error = (
            natural_map(problem.W, problem.q, problem.mu, dim, answer.solution) if problem.q.any() else 0.0
        )
        assert answer.residual == pytest.approx(error, rel=1e-6, abs=1e-12)
        assert (answer.status == "solved") == (answer.residual <= 1e-12)
        solved += answer.status == "solved"
    assert solved >= 57


def test_random_problems_are_what_they_are_called():
    for kind in ("semidefinite", "degenerate", "rank-deficient", "badly-scaled"):
        M = numerics.random_lcp(kind, 9, 4).M
        values = np.linalg.eigvalsh(M + M.T)
        assert values[0] >= -1e-13 * values[-1]
    assert np.linalg.matrix_rank(numerics.random_lcp("rank-deficient", 9, 4).M) == 3
    M = numerics.random_lcp("p", 5, 4).M
    for bits in range(1, 32):
        rows = [k for k in range(5) if bits >> k & 1]
        assert np.linalg.det(M[np.ix_(rows, rows)]) > 0
    same = [numerics.random_friction("regular", 3, 3, 7).W for _ in range(2)]
    np.testing.assert_array_equal(*same)
    assert numerics.random_friction("rank-deficient", 4, 3, 1).W.shape == (12, 12)
    assert np.linalg.matrix_rank(numerics.random_friction("rank-deficient", 4, 3, 1).W) == 6
    with pytest.raises(ValueError, match="there are the kinds semidefinite, .*, got 'easy'"):
        numerics.random_lcp("easy", 3, 0)
    with pytest.raises(ValueError, match="contacts must be >= 1, got 0"):
        numerics.random_friction("regular", 0, 3, 0)


def test_sparse_matrices_are_taken():
    problem = numerics.random_friction("regular", 4, 3, 2)
    W, q, mu = problem.W, problem.q, problem.mu
    expected = numerics.friction(W, q, mu, 3).solution
    for kind in (sparse.csr_array, sparse.csc_matrix, sparse.coo_array, sparse.lil_matrix):
        np.testing.assert_array_equal(numerics.friction(kind(W), q, mu, 3).solution, expected)
    doubled = sparse.coo_array(([1.0, 1.0, 2.0], ([0, 0, 1], [0, 0, 1])), shape=(2, 2))
    np.testing.assert_array_equal(numerics.lcp(doubled, [-2.0, -2.0]).solution, [1.0, 1.0])


def test_one_friction_coefficient_or_one_a_contact():
    W, q = np.eye(4), [-1.0, 3.0, -1.0, 3.0]
    np.testing.assert_array_equal(numerics.friction(W, q, 0.5, 2).solution, [1, -0.5, 1, -0.5])
    np.testing.assert_array_equal(numerics.friction(W, q, [0.5, 0], 2).solution, [1, -0.5, 1, 0])


def test_the_residual_of_friction_does_not_depend_on_units():
    problem = numerics.random_friction("regular", 3, 3, 5)
    light = FrictionProblem(1e6 * problem.W, 1e3 * problem.q, problem.mu, 3)
    r = np.linspace(-1, 1, 9)
    assert light.residual(1e-3 * r) == pytest.approx(problem.residual(r), rel=1e-12)
    for mass in (1e-9, 1e9):
        assert numerics.friction(problem.W / mass, problem.q, problem.mu, 3).status == "solved"


def test_a_tolerance_is_kept():
    problem = numerics.random_friction("rank-deficient", 6, 3, 3)
    iterations = []
    for tolerance in (1e-2, 1e-6, 1e-12):
        answer = problem.solve("nsgs", tolerance)
        assert answer.status == "solved"
        assert answer.residual <= tolerance
        iterations.append(answer.iterations)
    assert iterations == sorted(set(iterations))
    warm = problem.solve("semismooth-newton", warm_start=problem.solve().solution)
    assert (warm.status, warm.iterations) == ("solved", 0)


def test_equalities_beside_contacts():
    # a bead on a rod, pressed on a stop, with friction: one contact and one equality
    H = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 1.0]])
    problem = FrictionProblem(H.T @ H, [-1.0, 0.3, -0.2], 0.5, 2, n_equalities=1)
    answer = problem.solve()
    assert answer.status == "solved"
    u = problem.W @ answer.solution + problem.q
    assert abs(u[2]) <= 1e-12
    assert problem.contacts == 1
    assert "1 equalities" in repr(problem)


NAN, INF = float("nan"), float("inf")
EYE = np.eye(2)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: numerics.lcp(np.eye(3), [1, 2]), r"M must be \(2, 2\) as q has 2 entries, got \(3, 3\)"),
        (lambda: numerics.lcp(np.ones((2, 3)), [1, 2]), r"M must be \(2, 2\).*got \(2, 3\)"),
        (lambda: numerics.lcp([1, 2], [1, 2]), r"M must have two axes, got shape \(2,\)"),
        (lambda: numerics.lcp(EYE, [[1, 2]]), r"q must have one axis, got shape \(1, 2\)"),
        (lambda: numerics.lcp([[1, NAN], [0, 1]], [1, 2]), "M must be finite, got NaN"),
        (lambda: numerics.lcp(sparse.csr_array([[1, INF], [0, 1]]), [1, 2]), "M must be finite"),
        (lambda: numerics.lcp(sparse.csr_array(np.eye(3)), [1, 2]), r"M must be \(2, 2\)"),
        (lambda: numerics.lcp(sparse.csr_array(1j * EYE), [1, 2]), "real numbers, got complex128"),
        (lambda: numerics.lcp(1j * EYE, [1, 2]), "M must be an array of real numbers, got complex128"),
        (lambda: numerics.lcp(EYE, [1, INF]), "q must be finite"),
        (lambda: numerics.lcp(EYE, ["a", "b"]), "q must be an array of real numbers"),
        (lambda: numerics.lcp([[1, 2], [3]], [1, 2]), "M must be an array of"),
        (lambda: numerics.lcp(EYE, [1, 2], "newton"), "no contact solver named 'newton', there are auto"),
        (lambda: numerics.lcp(EYE, [1, 2], tolerance=0), "tolerance must be positive and finite, got 0"),
        (lambda: numerics.lcp(EYE, [1, 2], tolerance=NAN), "tolerance must be positive and finite, got nan"),
        (lambda: numerics.lcp(EYE, [1, 2], warm_start=[1]), "have 2 entries, got 1"),
        (lambda: numerics.lcp(EYE, [1, 2], warm_start=[1, NAN]), "NaN"),
        (lambda: numerics.mlcp(EYE, [1, 2], 3), "number of equalities .* from 0 to 2, got 3"),
        (lambda: numerics.mlcp(EYE, [1, 2], -1), "from 0 to 2, got -1"),
        (lambda: numerics.mlcp(EYE, [1, 2], 1.5), "whole number from 0 to 2, got 1.5"),
        (lambda: numerics.mlcp(EYE, [1, 2], [True]), r"a number or \(2,\) of bool, got \(1,\)"),
        (lambda: numerics.friction(EYE, [1, 2], -0.1, 2), "mu must be >= 0, got -0.1"),
        (lambda: numerics.friction(EYE, [1, 2], NAN, 2), "mu must be finite"),
        (lambda: numerics.friction(EYE, [1, 2], [0.1, 0.2], 2), "have 1 entries, got 2"),
        (lambda: numerics.friction(EYE, [1, 2], None, 2), "mu must be an array of real numbers"),
        (lambda: numerics.friction(EYE, [1, 2], 0.1, 3), "a multiple of dim 3, got 2"),
        (lambda: numerics.friction(EYE, [1, 2], 0.1, 4), "dim must be 2 or 3, got 4"),
        (lambda: numerics.friction(EYE, [1, 2], 0.1, True), "dim must be 2 or 3, got True"),
        (lambda: numerics.friction(np.eye(3), [1, 2, 3], 0.1, 3, "lemke"), "'lemke' does not accept"),
        (lambda: LCP(EYE, [1, 2]).residual([1]), "solution must have 2 entries, got 1"),
        (lambda: LCP(EYE, [1, 2]).write("x.txt"), r"written to .hdf5, .h5 or .dat, got 'x.txt'"),
    ],
)
def test_what_is_no_problem_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_a_problem_keeps_its_own_copy():
    M, q = np.eye(2), np.array([-1.0, -1.0])
    problem = LCP(M, q)
    M[0, 0] = q[0] = NAN
    np.testing.assert_array_equal(problem.solve().solution, [1.0, 1.0])


def test_unsolvable_problems_end_soon():
    for n in (30, 100):
        assert numerics.random_lcp("unsolvable", n, 3).solve().status == "ray"


def test_a_broken_sparse_matrix_is_refused():
    broken = sparse.identity(100, format="csr")
    broken.indptr[3] = 10**8
    with pytest.raises(ValueError, match=r"M must be a valid sparse matrix: "):
        numerics.lcp(broken, -np.ones(100))
    outside = sparse.identity(10, format="csr")
    outside.indices[0] = 15
    with pytest.raises(ValueError, match=r"M must be a valid sparse matrix: "):
        numerics.lcp(outside, -np.ones(10))


def test_uniqueness_does_not_depend_on_the_tolerance():
    for tolerance in (1e-2, 1e-4, 1e-12):
        assert numerics.lcp([[1, -1], [-1, 1]], [1.01, -1], tolerance=tolerance).unique is True
