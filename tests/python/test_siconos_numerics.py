"""Drivers of saltus.siconos.numerics on problems whose solutions are known."""

import numpy as np
import pytest
import saltus.siconos.numerics as sn

M, Q = np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([-5.0, 1.0])  # z = (2.5, 0), w = (0, 3.5)


def solved(driver, problem, n, solver):
    z, w = np.zeros(n), np.zeros(n)
    options = sn.SolverOptions(solver)
    assert getattr(sn, driver)(problem, z, w, options) == 0
    assert options.dparam[sn.SICONOS_DPARAM_RESIDU] <= options.dparam[sn.SICONOS_DPARAM_TOL]
    return z, w


@pytest.mark.parametrize(
    "driver", [name for name in sn.DRIVERS if name.startswith("l")], ids=lambda name: name
)
def test_drivers_of_linear_complementarity(driver):
    z, w = solved(driver, sn.LCP(M, Q), 2, sn.SICONOS_LCP_PSOR)
    np.testing.assert_allclose(z, [2.5, 0.0], atol=1e-10)
    np.testing.assert_allclose(w, [0.0, 3.5], atol=1e-10)


@pytest.mark.parametrize("driver", [name for name in sn.DRIVERS if name.startswith("m")])
def test_drivers_of_mixed_problems(driver):
    """The first row is an equality: z0 = -(q0 + z1)/2 is free."""
    z, w = solved(driver, sn.MLCP(1, M, [4.0, -1.0]), 2, sn.SICONOS_MLCP_ENUM)
    np.testing.assert_allclose(z, [-3.0, 2.0], atol=1e-10)
    np.testing.assert_allclose(w, 0.0, atol=1e-10)


@pytest.mark.parametrize("driver", [name for name in sn.DRIVERS if name.startswith("fc")])
def test_drivers_of_friction(driver):
    """A mass of 2 kg that arrives with 3 m/s, slides at 4 m/s and is slowed by mu = 0.5."""
    dim = int(driver[2])
    solver = sn.SICONOS_FRICTION_2D_NSGS if dim == 2 else sn.SICONOS_FRICTION_3D_NSGS
    problem = sn.FrictionContactProblem(dim, 0.5 * np.eye(dim), [-3.0, 4.0, 0.0][:dim], [0.5])
    z, w = solved(driver, problem, dim, solver)
    np.testing.assert_allclose(z, [6.0, -3.0, 0.0][:dim], atol=1e-9)
    np.testing.assert_allclose(w, [0.0, 2.5, 0.0][:dim], atol=1e-9)


def test_a_problem_without_solution_is_not_solved():
    z, w = np.zeros(1), np.zeros(1)
    options = sn.SolverOptions(sn.SICONOS_LCP_LEMKE)
    assert sn.linearComplementarity_driver(sn.LCP([[-1.0]], [-1.0]), z, w, options) == 1


def test_other_names_say_what_is_there():
    with pytest.raises(AttributeError, match="has no 'lcp_path', it has .*lcp_lexicolemke"):
        sn.lcp_path  # noqa: B018


def test_what_changes_nothing_is_taken():
    assert [getattr(sn, name)(0) for name in sn.HINTS] == [0] * len(sn.HINTS)


@pytest.mark.parametrize("place", [0, 1])
def test_arrays_of_integers_cannot_take_a_solution(place):
    arrays = [np.zeros(2), np.zeros(2)]
    arrays[place] = np.zeros(2, dtype=int)
    with pytest.raises(TypeError, match="expected an array of float64, got int64"):
        sn.lcp_lexicolemke(sn.LCP(M, Q), *arrays, sn.SolverOptions(sn.SICONOS_LCP_LEMKE))
