"""Terms, states and matrices of saltus.siconos.kernel that scripts ask for outside a simulation."""

import numpy as np
import pytest
import saltus.siconos.kernel as sk
import saltus.siconos.numerics as sn

Q, V = np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0])
M, K, C = np.diag([1.0, 2.0, 3.0]), np.arange(9.0).reshape(3, 3), np.arange(9.0, 18.0).reshape(3, 3)


def test_terms_of_a_linear_system():
    ds = sk.LagrangianLinearTIDS(Q, V, M, K, C)
    ds.setFExtPtr([1.0, 1.0, 1.0])
    forces = 1.0 - K @ Q - C @ V
    ds.computeForces(0.3, Q, V)
    np.testing.assert_allclose(ds.forces(), forces, rtol=1e-14)
    ds.computeRhs(0.0)
    np.testing.assert_allclose(ds.rhs(), [*V, *(forces / [1, 2, 3])], rtol=1e-14)
    ds.computeJacobianRhsx(0.0)
    np.testing.assert_allclose(ds.jacobianqForces(), K, atol=1e-9)
    np.testing.assert_allclose(ds.jacobianvForces(), C, atol=1e-9)
    inverse = np.linalg.inv(M)
    blocks = np.block([[np.zeros((3, 3)), np.eye(3)], [-inverse @ K, -inverse @ C]])
    np.testing.assert_allclose(ds.jacobianRhsx(), blocks, atol=1e-9)
    assert (ds.isLinear(), ds.dimension(), ds.computeKineticEnergy()) == (True, 3, 87.0)


def test_terms_of_overrides():
    class Pendulum(sk.LagrangianDS):
        def computeFInt(self, time, q, v):
            self.fInt()[0] = 9.81 * np.sin(q[0]) + time

        def computeMass(self, q):
            self.mass()[0, 0] = 2.0 + q[0]

    ds = Pendulum([0.5], [1.0])
    ds.update(0.25)
    np.testing.assert_allclose(ds.acceleration(), -(9.81 * np.sin(0.5) + 0.25) / 2.5, rtol=1e-14)
    np.testing.assert_allclose(ds.jacobianqForces(), [[9.81 * np.cos(0.5)]], rtol=1e-9)
    assert not ds.isLinear()
    assert (ds.q()[0], ds.velocity()[0]) == (0.5, 1.0)


def test_the_state_can_be_set_until_the_simulation_is_made():
    ds = sk.LagrangianLinearTIDS([0.0], [0.0], [[1.0]])
    ds.setQ([2.0])
    ds.setVelocity([3.0])
    model = sk.NonSmoothDynamicalSystem(0.0, 1.0)
    model.insertDynamicalSystem(ds)
    simulation = sk.TimeStepping(model, sk.TimeDiscretisation(0.0, 0.5), sk.MoreauJeanOSI(0.5))
    ds.resetToInitialState()
    assert ds.q()[0] == 0.0
    ds.setQ([2.0])
    ds.setVelocity([3.0])
    simulation.run()
    assert (ds.q()[0], ds.velocity()[0], ds.q0()[0]) == (5.0, 3.0, 0.0)
    with pytest.raises(NotImplementedError, match="until the simulation is made"):
        ds.resetToInitialState()
    with pytest.raises(ValueError, match="expected 1 numbers, got 2"):
        sk.LagrangianLinearTIDS([0.0], [0.0], [[1.0]]).setQ([1.0, 2.0])


def test_parts_can_be_set_one_by_one():
    class Own(sk.LagrangianDS):
        pass

    class Plane(sk.LagrangianScleronomousR):
        pass

    ds, relation = Own(), Plane()
    ds.setMassPtr([[1, 2, 3], [4, 5, 6]])
    relation.setJachqPtr(np.array([[1.0, 2.0, 3.0]]))
    np.testing.assert_array_equal(ds.mass(), [[1, 2, 3], [4, 5, 6]])
    np.testing.assert_array_equal(relation.C(), [[1, 2, 3]])


def test_what_is_printed(capsys):
    ds = sk.LagrangianLinearTIDS([1.0], [2.0], [[1.0]])
    ds.display()
    floor = sk.Interaction(sk.NewtonImpactNSL(0.5), sk.LagrangianLinearTIR([[1.0]]))
    floor.display()
    text = capsys.readouterr().out
    assert "LagrangianLinearTIDS" in text
    assert "q = [1.], v = [2.]" in text
    assert "NewtonImpactNSL, LagrangianLinearTIR: y(0) = [0.]" in text
    assert str(sk.SiconosVector([1, 2.5, 3])) == "[3](1,2.5,3)"


def test_vectors_are_sequences_and_matrices_are_copied():
    vector = sk.SiconosVector([1, 4, 3])
    assert list(vector) == [1.0, 4.0, 3.0]
    assert 3.0 in vector
    assert 5.0 not in vector
    with pytest.raises(IndexError):
        vector[5] = 1.0
    sparse = sk.SimpleMatrix(2, 2, sk.SPARSE, 2)
    sparse.setValue(1, 0, 7.0)
    copy = sk.SimpleMatrix(sparse)
    sparse.setValue(1, 0, 8.0)
    np.testing.assert_array_equal(sk.getMatrix(copy), [[0, 0], [7, 0]])


def test_comparison_with_a_file(tmp_path, capsys):
    (tmp_path / "with.ref").write_text("2 3\n1 2 3\n4 5 6\n")
    (tmp_path / "without.ref").write_text("1 2 3\n4 5 6\n")
    data = np.array([[1.0, 2.0, 3.0], [4.0, 5.5, 6.0]])
    for name in ("with.ref", "without.ref"):
        assert sk.compareRefFile(data, tmp_path / name, 1e-12) == 0.5
        assert sk.compareRefFile(data, tmp_path / name, 1e-12, index=[0, 2], verbose=False) == 0.0
    assert "differs by 0.5, more than 1e-12" in capsys.readouterr().out
    with pytest.raises(ValueError, match=r"expected \(1, 3\) numbers, got \(2, 3\)"):
        sk.compareRefFile(data[:1], tmp_path / "with.ref", 1e-12)


def test_gamma_moves_the_forecast():
    """A ball is caught at the first step from which it would be below the floor at γ h."""
    for gamma in (0.1, 0.5, 1.0):
        ds = sk.LagrangianLinearTIDS([1.0], [-1.0], [[1.0]])
        floor = sk.Interaction(sk.NewtonImpactNSL(1.0), sk.LagrangianLinearTIR([[1.0]]))
        model = sk.NonSmoothDynamicalSystem(0.0, 2.0)
        model.insertDynamicalSystem(ds)
        model.link(floor, ds)
        steps = sk.TimeDiscretisation(0.0, 0.3)
        simulation = sk.TimeStepping(model, steps, sk.MoreauJeanOSI(0.5, gamma), sk.LCP())
        while ds.velocity()[0] < 0.0:
            before = ds.q()[0]
            simulation.computeOneStep()
            simulation.nextStep()
        assert before - gamma * 0.3 <= 0.0 < before + 0.3 - gamma * 0.3
    with pytest.raises(ValueError, match="gamma must be in"):
        sk.MoreauJeanOSI(0.5, 1.5)


def test_problems_from_files(tmp_path):
    lcp = sn.LCP([[2.0, 1.0], [1.0, 2.0]], [[-5.0], [-6.0]])
    lcp.write(tmp_path / "lcp.dat")
    read = sn.LCP()
    assert sn.linearComplementarity_newFromFilename(read, str(tmp_path / "lcp.dat")) == 0
    assert (read.size, read.q.tolist(), read.M.tolist()) == (2, [-5.0, -6.0], [[2.0, 1.0], [1.0, 2.0]])
    mlcp = sn.MLCP(1, lcp.M, lcp.q)
    mlcp.write(tmp_path / "mlcp.dat")
    mixed = sn.MLCP()
    sn.mixedLinearComplementarity_newFromFilename(mixed, str(tmp_path / "mlcp.dat"))
    assert (mixed.n, mixed.m, mixed.q.tolist()) == (1, 1, [-5.0, -6.0])
    z, w = np.zeros(2), np.zeros(2)
    assert sn.mlcp_driver(mixed, z, w, sn.SolverOptions(mixed, sn.SICONOS_MLCP_ENUM)) == 0
    np.testing.assert_allclose(z, [4 / 3, 7 / 3], rtol=1e-12)
    friction = sn.FrictionContactProblem(2, np.eye(2), [-1.0, 0.5], [0.3])
    friction.write(tmp_path / "friction.dat")
    again = sn.frictionContact_new_from_filename(str(tmp_path / "friction.dat"))
    assert (again.dimension, again.numberOfContacts, again.mu.tolist()) == (2, 1, [0.3])
    with pytest.raises(ValueError, match=r"expected the problem to be a MLCP, got LCP\(2"):
        sn.mixedLinearComplementarity_newFromFilename(sn.MLCP(), str(tmp_path / "lcp.dat"))


def test_everything_can_be_imported_by_a_star():
    names: dict[str, object] = {}
    exec("from saltus.siconos.kernel import *\nfrom saltus.siconos.numerics import *", names)  # noqa: S102
    assert {"LCP", "MoreauJeanOSI", "SICONOS_LCP_LEMKE", "fc3d_nsgs", "EventDriven"} <= set(names)
