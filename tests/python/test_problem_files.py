"""Problems in files: Siconos's ASCII, FCLib's HDF5, those of a simulation; what is malformed is refused."""

import h5py
import numpy as np
import pytest
import saltus.kernel as sk
from hypothesis import given, settings
from hypothesis import strategies as st
from saltus import numerics
from saltus.numerics import LCP, MLCP, FrictionProblem, read_problem
from scipy import sparse
from test_models import Circle

# M = [[1, 2], [3, 4]], column after column
DENSE = "2\n0\n2\n2\n2\t2\n 1.0 3.0\n 2.0 4.0\n -1e0 -5 \nwhat follows is a remark"
# the same rows and columns in blocks of one and two
BLOCKS = "3 1 3 3  3 2 2  1 3  1 3  3 3  0 2 3  0 1 1  0 1.0  1 2.0 5.0  2 4.0 6.0 7.0 8.0  -1 -2 -3"
BLOCKS_MATRIX = [[1, 2, 5], [0, 4, 7], [0, 6, 8]]
MIXED = "1 1 1 2  0 1 3  0 1  0 3 3 3 3  1 0 0  2 1 0  0 1.5 1  -1 1 -3  1 1 1.5 0 1 2 0 0 0 -1 1 -3  0 3 5"
PARTS = "0 1 1 2  1  1 1.5 0 1  2 0  0 0  -1  1 -3"
MIXED_MATRIX = [[1, 2, 0], [0, 1, 1.5], [0, 0, 1]]
FRICTION = "3 1 0 3 3 3 3  1 0.1 0  0 2 0  0.2 0 3  -1 0.5 0.25  0.7\n1\n"
TEXT = "CSparse Version 3.1.9, May 4, 2016.  Copyright (c) Timothy A. Davis, 2006-2016\n"
BY_COLUMNS = (
    f"2\n1\n2\n2\n2\n2\n{TEXT}2-by-2, nzmax: 3 nnz: 3, 1-norm: 7\n    col 0 : locations 0 to 1\n      0 : 3\n"
    "      1 : -4\n    col 1 : locations 2 to 2\n      1 : 5\n-1 0.5\n0.3\n"
)
TRIPLETS = (
    f"2\n1\n2\n2\n2\n1\n{TEXT}triplet: 2-by-2, nzmax: 4 nnz: 3\n    0 0 : 3\n    1 0 : -4\n"
    "    1 1 : 5\n-1 0.5 0.3"
)


@pytest.fixture
def file(tmp_path):
    def write(text):
        (tmp_path / "problem.dat").write_text(text)
        return tmp_path / "problem.dat"

    return write


def test_dense_lcp(file):
    problem = read_problem(file(DENSE))
    assert isinstance(problem, LCP)
    np.testing.assert_array_equal(problem.M, [[1, 2], [3, 4]])
    np.testing.assert_array_equal(problem.q, [-1, -5])


def test_lcp_of_sparse_blocks(file):
    problem = read_problem(file(BLOCKS))
    assert isinstance(problem, LCP)
    assert isinstance(problem.M, sparse.csr_array)
    np.testing.assert_array_equal(problem.M.toarray(), BLOCKS_MATRIX)
    np.testing.assert_array_equal(problem.q, [-1, -2, -3])
    # two rows in blocks: not friction of one contact with a sparse matrix
    assert isinstance(
        read_problem(file("2 1 2 2  2 2 2  1 2  1 2  3 2  0 1 2  0 1  0 5.0  1 6.0  -1 -2")), LCP
    )


@pytest.mark.parametrize("text", [MIXED, PARTS, MIXED.replace("1 1 1 2", "1 0 1 2", 1)])
def test_mixed_lcp(file, text):
    problem = read_problem(file(text))
    assert isinstance(problem, MLCP)
    np.testing.assert_array_equal(problem.M, MIXED_MATRIX)
    np.testing.assert_array_equal(problem.q, [-1, 1, -3])
    np.testing.assert_array_equal(problem.equalities, [True, False, False])
    assert problem.solve().status == "solved"


def test_dense_friction(file):
    problem = read_problem(file(FRICTION))
    assert isinstance(problem, FrictionProblem)
    assert (problem.dim, problem.contacts) == (3, 1)
    np.testing.assert_array_equal(problem.W, [[1, 0, 0.2], [0.1, 2, 0], [0, 0, 3]])
    np.testing.assert_array_equal(problem.mu, [0.7])


@pytest.mark.parametrize("text", [BY_COLUMNS, TRIPLETS])
def test_sparse_friction(file, text):
    problem = read_problem(file(text))
    assert isinstance(problem, FrictionProblem)
    np.testing.assert_array_equal(problem.W.toarray(), [[3, 0], [-4, 5]])
    np.testing.assert_array_equal(problem.q, [-1, 0.5])
    np.testing.assert_array_equal(problem.mu, [0.3])


def same(a, b):
    assert type(a) is type(b)
    np.testing.assert_array_equal(a.dense(), b.dense())
    np.testing.assert_array_equal(a.q, b.q)
    for name in ("mu", "dim", "equalities", "n_equalities"):
        np.testing.assert_array_equal(getattr(a, name, None), getattr(b, name, None))


@pytest.mark.parametrize(
    "problem",
    [
        numerics.random_lcp("p", 5, 1),
        MLCP(*(lambda p: (p.M, p.q))(numerics.random_lcp("p", 5, 2)), np.array([0, 1, 1, 0, 1], dtype=bool)),
        numerics.random_friction("unsymmetric", 3, 2, 1),
        numerics.random_friction("badly-scaled", 2, 3, 1),
    ],
    ids=repr,
)
def test_what_is_written_comes_back(tmp_path, problem):
    problem.write(tmp_path / "problem.dat")
    same(read_problem(tmp_path / "problem.dat"), problem)
    if isinstance(problem, FrictionProblem):
        problem.write(tmp_path / "problem.hdf5")
        same(read_problem(tmp_path / "problem.hdf5"), problem)
    else:
        with pytest.raises(ValueError, match="FCLib holds friction problems"):
            problem.write(tmp_path / "problem.hdf5")


def fclib(path, kind, W, q, mu, spacedim, **others):
    """A file as FCLib writes it."""
    matrix = {-2: sparse.csr_array, -1: sparse.csc_array}.get(kind, sparse.coo_array)(W)
    with h5py.File(path, "w") as file:
        group = file.create_group("fclib_local")
        group["spacedim"] = np.array([spacedim], dtype=np.int32)
        values = {"m": [len(W)], "n": [len(W)], "nz": [min(kind, matrix.nnz)], "nzmax": [matrix.nnz]}
        if kind < 0:
            values |= {"p": matrix.indptr, "i": matrix.indices}
        else:
            values |= {"nz": [matrix.nnz], "p": matrix.coords[1], "i": matrix.coords[0]}
        for name, value in values.items():
            group[f"W/{name}"] = np.array(others.get(name, value), dtype=np.int32)
        group["W/x"] = others.get("x", matrix.data)
        group["vectors/q"] = np.array(q, dtype=float)
        group["vectors/mu"] = np.array(mu, dtype=float)
        group["info/title"] = np.bytes_(b"a test")
    return path


W = [[2.0, 0.5, 0.0, 0.0], [0.25, 3.0, 0.0, 1.0], [0.0, 0.0, 4.0, 0.0], [0.0, 1.0, 0.0, 5.0]]
Q, MU = [-1.0, 0.5, -2.0, 0.25], [0.3, 0.4]


@pytest.mark.parametrize("kind", [-2, -1, 0])
def test_fclib(tmp_path, kind):
    problem = read_problem(fclib(tmp_path / "a.hdf5", kind, W, Q, MU, 2))
    assert isinstance(problem, FrictionProblem)
    np.testing.assert_array_equal(problem.W.toarray(), W)
    np.testing.assert_array_equal(problem.q, Q)
    np.testing.assert_array_equal(problem.mu, MU)
    assert problem.dim == 2


def test_fclib_keeps_symmetric_equalities_and_eliminates_others(tmp_path):
    rng = np.random.default_rng(3)
    H = rng.normal(size=(7, 6))
    symmetric = FrictionProblem(H.T @ H, H.T @ rng.normal(size=7), [0.3, 0.2], 2, n_equalities=2)
    symmetric.write(tmp_path / "a.h5")
    same(read_problem(tmp_path / "a.h5"), symmetric)
    there = H + 0.1 * rng.normal(size=H.shape)
    problem = FrictionProblem(there.T @ H, symmetric.q, [0.3, 0.2], 2, n_equalities=2)
    problem.write(tmp_path / "b.h5")
    reduced = read_problem(tmp_path / "b.h5")
    assert (reduced.contacts, reduced.n_equalities) == (2, 0)
    np.testing.assert_allclose(problem.solve().solution[:4], reduced.solve().solution, rtol=1e-11, atol=1e-12)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "line 1: expected the size and the storage"),
        ("hello\nworld", "line 1: expected the size"),
        ("2\n0\n2\n2\n2 2\n1 3 2", "line 6: M: expected 4 numbers, the file ends after 3"),
        ("2\n0\n2\n2\n2 2\n1 3\n2 x\n-1 -1", "line 7: M must be finite numbers, got 'x'"),
        ("2\n0\n2\n2\n2 2\n1 3\n2 4\n-1 nan", "line 8: q must be finite numbers, got 'nan'"),
        ("2\n0\n2\n2\n2 2\n1 3\n2 4\n-1 1e999", "line 8: q must be finite numbers, got '1e999'"),
        (
            "2\n0\n2\n2\n2 3\n1 3\n2 4\n-1 -1",
            "line 5: rows and columns of M must be .*>= 2 and <= 2, got '3'",
        ),
        ("999999999\n0\n999999999\n999999999\n999999999 999999999\n1", "the file ends after 1"),
        ("999999999 1 999999999 999999999  0 0 0  1 0  0", "M: expected 999999999 numbers, the file ends"),
        ("900000000\n2\n900000000\n900000000\n0\nCSparse\n", "the file ends after"),
        ("1 0 1 999999998  0 999999999  0", "M and q: expected 999999999 numbers, the file ends after 3"),
        (FRICTION.replace("0.7", "-0.7"), "line 1: mu must be >= 0, got -0.7"),
        ("3 1 0 3 3 3 3  1 0 0 0 1 0 0 0 1  -1 0 0", "mu: expected 1 numbers, the file ends after 0"),
        (BLOCKS.replace("0 2 3  0 1 1", "0 2 2  0 1 1"), "the row pointers must rise from 0 to 3"),
        (BLOCKS.replace("0 2 3  0 1 1", "0 2 3  0 1 2"), "a block column must be .*<= 1, got '2'"),
        (BLOCKS.replace("1 3  1 3", "1 2  1 3"), r"must rise to 3, got \[1, 2\]"),
        (BLOCKS.replace("1 2.0 5.0", "4 2.0 5.0"), "the number of a block must be"),
        (BY_COLUMNS.replace("nnz: 3", "nnz: 300000000"), "W: expected 900000000 numbers"),
        (BY_COLUMNS.replace("      1 : 5", "      2 : 5"), "line 13: a row must be .*<= 1, got '2'"),
        (BY_COLUMNS.replace("2-by-2", "2-by-3"), "expected '2-by-2,', got '2-by-3,'"),
        (MIXED.replace("0 1 3  0 1", "0 1 4  0 1", 1), "the first row of a block must be"),
        (MIXED.replace("0 1 3  0 1", "0 0 3  0 1", 1), "the first row of a block must be"),
    ],
)
def test_a_malformed_text_is_refused_with_its_line(file, text, message):
    with pytest.raises(ValueError, match=message) as caught:
        read_problem(file(text))
    assert "problem.dat, line " in str(caught.value)


@pytest.mark.parametrize(
    ("others", "message"),
    [
        ({"m": [3]}, r"'W' must be \(4, 4\) as the vectors are, got \(3, 4\)"),
        ({"nz": [-3]}, "nz >= -2, got -3"),
        ({"m": [1 << 30]}, r"'W' must be \(4, 4\) as the vectors are, got \(1073741824, 4\)"),
        ({"p": [0, (1 << 31) - 1, -(1 << 31), 6, 8]}, "'W/p' must rise from 0"),
        ({"p": [0, 2, 1, 6, 7]}, "'W/p' must rise from 0"),
        ({"p": [0, 2, 5, 6, 70]}, "'W/i' must have 70 entries, got 8"),
        ({"i": [0, 1, 0, 1, 3, 2, 1, 9]}, "indices of 'W' must be from 0 to 3"),
        ({"x": np.full(8, np.nan)}, "W must be finite"),
        ({"x": np.bytes_(b"text")}, "'W/x' must hold numbers"),
    ],
)
def test_a_malformed_fclib_file_is_refused(tmp_path, others, message):
    with pytest.raises(ValueError, match=message) as caught:
        read_problem(fclib(tmp_path / "a.hdf5", -2, W, Q, MU, 2, **others))
    assert "a.hdf5" in str(caught.value)


def test_pointers_without_a_sign_must_rise_too(tmp_path):
    path = fclib(tmp_path / "a.hdf5", -2, W, Q, MU, 2)
    with h5py.File(path, "r+") as file:
        del file["fclib_local/W/p"]
        file["fclib_local/W/p"] = np.array([0, 2, 1, 6, 8], dtype=np.uint64)
    with pytest.raises(ValueError, match="'W/p' must rise from 0"):
        read_problem(path)


def test_entries_that_overflow_together_are_refused():
    twice = sparse.coo_array(([1e308, 1e308], ([0, 0], [0, 0])), shape=(1, 1))
    rows = sparse.csr_array(([1e308, 1e308], [0, 0], [0, 2]), shape=(1, 1))
    for matrix in (twice, rows):
        with pytest.raises(ValueError, match="M must be finite"):
            LCP(matrix, [1.0])


def test_other_hdf5_files_are_refused(tmp_path):
    with h5py.File(tmp_path / "empty.h5", "w"):
        pass
    with pytest.raises(ValueError, match=r"empty.h5: expected a group 'fclib_local'"):
        read_problem(tmp_path / "empty.h5")
    with h5py.File(fclib(tmp_path / "huge.h5", -2, W, Q, MU, 2), "r+") as file:
        del file["fclib_local/vectors/q"]
        file["fclib_local/vectors"].create_dataset("q", shape=(1 << 40,), dtype="f8", chunks=True)
    with pytest.raises(
        ValueError, match="'vectors/q' claims 8796093022208 bytes"
    ):  # and nothing is allocated
        read_problem(tmp_path / "huge.h5")
    (tmp_path / "cut.h5").write_bytes((tmp_path / "huge.h5").read_bytes()[:100])
    with pytest.raises(OSError, match="cut.h5"):
        read_problem(tmp_path / "cut.h5")
    with pytest.raises(FileNotFoundError):
        read_problem(tmp_path / "none.dat")


@settings(max_examples=300, deadline=None)
@given(st.data())
def test_damaged_texts_are_read_or_refused(tmp_path_factory, data):
    text = data.draw(st.sampled_from([DENSE, BLOCKS, MIXED, PARTS, FRICTION, BY_COLUMNS, TRIPLETS]))
    words = text.split(" ")
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(words) - 1))
        words[at] = data.draw(
            st.sampled_from(["", "0", "1", "-1", "2", "7", "99999999", "nan", "x", "1e9", "\n"])
        )
    path = tmp_path_factory.mktemp("damaged") / "problem.dat"
    path.write_text(" ".join(words))
    try:
        read_problem(path)
    except ValueError as error:
        assert "problem.dat, line " in str(error)  # noqa: PT017


def pressed_ball(scheme="HalfExplicitTrapezoidalOSI", solver="auto"):
    """A ball on the ground that slides, in the plane."""
    body = sk.LagrangianLinearTIDS([0.0, 0.0], [0.0, 1.0], np.eye(2), external_force=[-9.81, 0.0])
    system = sk.NonSmoothDynamicalSystem([body])
    floor = sk.LagrangianLinearTIR(np.eye(2))
    system.link(sk.Interaction(floor, sk.NewtonImpactFrictionNSL(0.0, 0.0, 0.3, 2), "floor"), body)
    return sk.TimeStepping(system, scheme, time_step=1e-2, solver=solver)


def test_the_problems_of_a_simulation(tmp_path):
    simulation = pressed_ball()
    undisturbed = pressed_ball().run(0.1)
    simulation.run(0.03)
    dump = numerics.dump_problems(simulation, tmp_path / "problems")
    simulation.run(0.06)
    dump.stop()
    np.testing.assert_array_equal(simulation.run(0.1).q, undisturbed.q)
    steps = sorted({int(path.name[4:10]) for path in dump.paths})
    assert steps == [3, 4, 5]
    assert sorted((tmp_path / "problems").iterdir()) == sorted(dump.paths)
    for path in dump.paths:
        problem = read_problem(path)
        assert (problem.dim, problem.contacts) == (2, 1)
        np.testing.assert_array_equal(problem.mu, [0.3])
        np.testing.assert_allclose(problem.W.toarray(), np.eye(2), atol=1e-15)
    normal, tangential = read_problem(dump.paths[-1]).solve().solution  # the ball slides
    assert normal > 0.04
    assert tangential == pytest.approx(-0.3 * normal, rel=1e-12)


def test_only_problems_that_are_wanted(tmp_path):
    simulation = pressed_ball()
    dump = numerics.dump_problems(simulation, tmp_path, when="failed")
    simulation.run(0.05)
    assert not dump.paths
    dump = numerics.dump_problems(simulation, tmp_path, lambda problem, status: simulation.steps == 7)
    simulation.run(0.1)
    assert {path.name[:10] for path in dump.paths} == {"step000007"}
    with pytest.raises(ValueError, match="when must be 'all', 'failed' or a function, got 'never'"):
        numerics.dump_problems(simulation, tmp_path, "never")


def test_a_failed_problem_is_kept(tmp_path):
    class Idle(numerics.ContactSolver):
        """Finds nothing."""

        def solve(self, G, b, sets, P):
            pass

    if "Idle" not in numerics.solvers():
        numerics.register_solver(Idle)
    simulation = pressed_ball(solver="Idle")
    dump = numerics.dump_problems(simulation, tmp_path, when="failed")
    with pytest.raises(sk.SimulationError):
        simulation.run(0.1)
    assert len(dump.paths) == 1
    assert read_problem(dump.paths[0]).solve().status == "solved"


def test_contacts_without_friction_and_equalities(tmp_path):
    rod = sk.LagrangianLinearTIDS([1.0, 0.0], [0.0, -1.0], np.eye(2), external_force=[0.0, -9.81])
    system = sk.NonSmoothDynamicalSystem([rod])
    system.link(sk.Interaction(Circle(), sk.EqualityConditionNSL(1), "rod"), rod)
    floor = sk.LagrangianLinearTIR([[0.0, 1.0]])
    system.link(sk.Interaction(floor, sk.NewtonImpactNSL(0.0), "floor"), rod)
    simulation = sk.TimeStepping(system, "MoreauJeanOSI", time_step=1e-3)
    dump = numerics.dump_problems(simulation, tmp_path)
    simulation.run(0.01)
    assert dump.paths
    problem = read_problem(dump.paths[-1])
    np.testing.assert_array_equal(problem.mu, [0.0])
    assert problem.solve().status == "solved"
