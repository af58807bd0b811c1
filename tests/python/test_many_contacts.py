"""Simulations and problems with many contacts: sparse matrices, tolerances, the broad phase."""

from __future__ import annotations

import numpy as np
import pytest
import saltus.kernel as sk
from saltus import numerics
from saltus.examples.many_contacts import many_contacts
from saltus.examples.many_contacts.many_contacts import GRAVITY, MASS, TIME_STEP
from scipy import sparse


@pytest.mark.parametrize("integrator", ["MoreauJeanOSI(theta=0.5)", "HalfExplicitTrapezoidalOSI"])
def test_a_column_carries_its_weight(integrator):
    n = 150
    run = sk.TimeStepping(many_contacts.column(n), integrator, TIME_STEP).run(until=5 * TIME_STEP)
    for k in range(n):
        contact = run[f"ball {k}"]
        carried = contact.impulse[1:, 0] + TIME_STEP * contact.force[1:, 0]
        np.testing.assert_allclose(carried, (n - k) * GRAVITY * TIME_STEP, rtol=1e-9)


def test_a_pyramid_slides_to_rest_on_its_floor():
    system = many_contacts.pyramid(5)
    problems = []
    simulation = sk.TimeStepping(system, "MoreauJeanOSI(theta=0.5)", TIME_STEP, tolerance=1e-8)
    simulation.watch_problems(lambda *problem: problems.append(problem))
    run = simulation.run(until=0.05)
    G, b, sets, P, status = problems[0]
    assert isinstance(G, sparse.csr_array)
    assert status == "solved"
    xi = G @ P + b
    normal, tangential = P[0::2], P[1::2]
    assert normal.min() >= 0
    assert (np.abs(tangential) <= 0.3 * normal * (1 + 1e-12)).all()
    assert xi[0::2].min() >= -1e-7
    assert np.abs(normal * xi[0::2]).max() <= 1e-7
    assert len(sets) == len(b) // 2
    # What the discs do to each other changes no momentum: only the floor and the weight do.
    velocities = run.v.reshape(len(run.t), -1, 3)
    change = np.diff(MASS * velocities.sum(axis=1), axis=0)
    from_floor = sum(run[f"floor {k}"].impulse[1:] for k in range(5))
    weight = velocities.shape[1] * MASS * GRAVITY * TIME_STEP
    np.testing.assert_allclose(change[:, 0], from_floor[:, 1], atol=1e-12)
    np.testing.assert_allclose(change[:, 1], from_floor[:, 0] - weight, atol=1e-12)
    np.testing.assert_allclose(from_floor[:10, 1], -0.3 * from_floor[:10, 0])  # it slides
    assert run.penetration.max() < 1e-4


def test_a_dumped_problem_stays_sparse(tmp_path):
    simulation = sk.TimeStepping(many_contacts.pyramid(7), "MoreauJeanOSI", TIME_STEP, tolerance=1e-8)
    dump = numerics.dump_problems(simulation, tmp_path)
    simulation.run(until=TIME_STEP)
    problem = numerics.read_problem(dump.paths[0])
    assert isinstance(problem.W, sparse.csr_array)
    answer = problem.solve(tolerance=1e-8)
    assert answer.status == "solved"
    assert answer.solver == "interior-point"
    assert problem.residual(answer.solution) <= 1e-8


def test_components_are_solved_apart():
    parts = [numerics.random_friction("regular", 3, 3, seed) for seed in range(20)]
    W = sparse.block_diag([part.W for part in parts], format="coo")
    q, mu = np.concatenate([part.q for part in parts]), np.concatenate([part.mu for part in parts])
    answer = numerics.friction(W, q, mu, 3)
    assert answer.status == "solved"
    expected = np.concatenate([part.solve().solution for part in parts])
    np.testing.assert_allclose(answer.solution, expected, atol=1e-9)
    assert numerics.friction(W, q, mu, 3, solver="nsgs", tolerance=1e-8).status == "solved"


def test_solvers_of_dense_problems_get_a_dense_copy():
    n = 80
    M = sparse.diags_array([-np.ones(n - 1), 2.5 * np.ones(n), -np.ones(n - 1)], offsets=[-1, 0, 1])
    q = np.where(np.arange(n) % 3 == 0, -1.0, 0.5)
    expected = numerics.lcp(M.toarray(), q, solver="lemke").solution
    for solver in ("lemke", "auto", "proximal-newton", "interior-point", "nsgs"):
        answer = numerics.lcp(M, q, solver=solver)
        assert answer.status == "solved", solver
        np.testing.assert_allclose(answer.solution, expected, atol=1e-10)


@pytest.mark.parametrize("tolerance", [0.0, 1.0, -1e-8, float("nan")])
def test_tolerances_that_are_none(tolerance):
    with pytest.raises(ValueError, match=r"tolerance of contact problems must be in \(0, 1\), got"):
        sk.TimeStepping(many_contacts.column(2), "MoreauJeanOSI", TIME_STEP, tolerance=tolerance)


def test_neighbours():
    centres = [[0.0, 0.0], [0.2, 0.0], [0.7, 0.0], [0.2, 0.2]]
    pairs = sk.neighbours(centres, [0.1] * 4, within=1e-9)
    np.testing.assert_array_equal(pairs, [[0, 1], [1, 3]])
    assert pairs.dtype == np.int64
    assert sk.neighbours(np.zeros((0, 2)), []).shape == (0, 2)
    with pytest.raises(ValueError, match=r"centres must have 1 to 3 columns, got 4"):
        sk.neighbours(np.zeros((2, 4)), [1, 1])
    with pytest.raises(ValueError, match=r"radii must be >= 0, got -1"):
        sk.neighbours(np.zeros((1, 2)), [-1])


def test_rain_and_step_times():
    seconds = many_contacts.step_times(many_contacts.rain(70, 35), "HalfExplicitTrapezoidalOSI", 5)
    assert seconds.shape == (5,)
    run = sk.TimeStepping(many_contacts.rain(70, 35), "HalfExplicitTrapezoidalOSI", TIME_STEP).run(until=0.01)
    assert run.closed[-1] == 35
