"""Contact problems from Python: what is called solved satisfies the laws as they are written down."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from saltus import numerics
from saltus.numerics import Coulomb, Equality, NonNegative


def violation(sets, P, xi):
    """Largest violation of the laws, relative: signs, products, friction cone, direction of friction."""
    worst, row = 0.0, 0
    size = 1.0 + np.abs(P).max() + np.abs(xi).max()
    for law in sets:
        if isinstance(law, Equality):
            worst = max(worst, abs(xi[row]))
            row += 1
            continue
        worst = max(worst, -xi[row], -P[row], min(abs(xi[row]), abs(P[row])))
        if isinstance(law, Coulomb):
            force, slip = P[row + 1 : row + law.dim], xi[row + 1 : row + law.dim]
            radius, speed = law.mu * max(P[row], 0.0), np.linalg.norm(slip)
            across = force + slip / speed * radius if speed > 0 else 0.0 * force
            # slow sliding has a direction only as far as its velocity is known
            worst = max(worst, np.linalg.norm(force) - radius, speed * np.linalg.norm(across) / size)
            row += law.dim - 1
        row += 1
    return worst / size


@st.composite
def problems(draw, dims=(2,)):
    sets = draw(
        st.lists(
            st.one_of(
                st.just(Equality()),
                st.just(NonNegative()),
                st.builds(Coulomb, st.floats(0.0, 1.5), st.sampled_from(dims)),
            ),
            min_size=1,
            max_size=4,
        )
    )
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    rows = sum(law.dim if isinstance(law, Coulomb) else 1 for law in sets)
    freedoms = rows + draw(st.integers(0, 2))
    W = rng.normal(size=(freedoms, rows))
    return sets, W.T @ W, rng.normal(size=rows)


@settings(max_examples=300, deadline=None)
@given(problems())
def test_solved_means_solved(problem):
    sets, G, b = problem
    auto = numerics.solve(G, b, sets)
    every = numerics.solve(G, b, sets, solver="enumeration")
    assert every.status != "solved" or auto.status == "solved"
    for solution in (auto, every):
        if solution.status == "solved":
            np.testing.assert_allclose(solution.xi, G @ solution.P + b, atol=1e-12 * solution.scale)
            assert violation(sets, solution.P, solution.xi) < 1e-9


@settings(max_examples=200, deadline=None)
@given(problems(dims=(2, 3)))
def test_solved_means_solved_in_space(problem):
    sets, G, b = problem
    solution = numerics.solve(G, b, sets)
    assert solution.status == "solved"
    assert violation(sets, solution.P, solution.xi) < 1e-9


def test_friction_in_space_opposes_the_sliding():
    # isotropic, sliding along (3, 4)/5
    problem = (np.eye(3), [-1.0, 3.0, 4.0], [Coulomb(0.5, dim=3)])
    for solver in ("auto", "semismooth-newton", "nsgs", "prox-fixed-point", "subset-newton"):
        solution = numerics.solve(*problem, solver=solver)
        assert solution.status == "solved"
        np.testing.assert_allclose(solution.P, [1.0, -0.3, -0.4], atol=1e-12)
    for solver in ("enumeration", "lemke"):
        with pytest.raises(ValueError, match=f"'{solver}' does not accept"):
            numerics.solve(*problem, solver=solver)


@pytest.mark.parametrize(
    ("b", "P"),
    [
        ([1.0, 3.0], [0.0, 0.0]),  # open
        ([-2.0, 0.5], [1.0, -0.25]),  # stick
        ([-2.0, 4.0], [1.0, -0.5]),  # slip
        ([-2.0, -4.0], [1.0, 0.5]),  # slip the other way
    ],
)
@pytest.mark.parametrize("solver", [name for name in numerics.solvers() if name != "fischer-burmeister"])
def test_one_frictional_contact(solver, b, P):
    solution = numerics.solve(2.0 * np.eye(2), b, [Coulomb(0.5)], solver=solver)
    assert solution.status == "solved"
    # over-relaxation ends at the tolerance even where the exact answer is one sweep away
    np.testing.assert_allclose(solution.P, P, atol=1e-11 if solver == "psor" else 1e-14)


def test_the_function_of_fischer_and_burmeister_knows_no_friction():
    with pytest.raises(ValueError, match="'fischer-burmeister' does not accept"):
        numerics.solve(2.0 * np.eye(2), [-2.0, 0.5], [Coulomb(0.5)], solver="fischer-burmeister")


def test_warm_start_is_the_start_not_the_answer():
    G = np.array([[2.0, 1.0], [1.0, 2.0]])
    cold = numerics.solve(G, [-1.0, -3.0], [NonNegative(), NonNegative()])
    warm = numerics.solve(G, [-1.0, -3.0], [NonNegative(), NonNegative()], warm_start=[5.0, 5.0])
    np.testing.assert_allclose(cold.P, [0.0, 1.5])
    np.testing.assert_allclose(warm.P, cold.P)


def test_what_has_no_solution_is_not_called_solved():
    for solver in numerics.solvers():
        solution = numerics.solve([[0.0]], [-1.0], [NonNegative()], solver=solver)
        assert solution.status in ("breakdown", "iteration-limit", "ray")
        assert solution.residual == pytest.approx(1.0)
