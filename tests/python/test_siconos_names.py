"""Names of saltus.siconos.kernel: vectors and matrices, integrators, solvers, and what is refused."""

import numpy as np
import pytest
import saltus.kernel as native
import saltus.siconos.kernel as sk
import saltus.siconos.numerics as sn
from saltus.numerics import solvers

# Now: while tests run, schemes of their own join the table.
INTEGRATORS = [entry["name"] for entry in native.integrators()]


def ball(h=1e-2, T=1.0):
    """A simulation that waits for its first step, and what it is made of."""
    ds = sk.LagrangianLinearTIDS([1.0], [0.0], [[2.0]])
    ds.setFExtPtr([-2.0 * 9.81])
    floor = sk.Interaction(sk.NewtonImpactNSL(0.5), sk.LagrangianLinearTIR([[1.0]]))
    model = sk.NonSmoothDynamicalSystem(0.0, T)
    model.insertDynamicalSystem(ds)
    model.link(floor, ds)
    return sk.TimeStepping(model, sk.TimeDiscretisation(0.0, h), sk.MoreauJeanOSI(0.5), sk.LCP()), ds, floor


def test_vectors_and_matrices(tmp_path):
    vector = sk.SiconosVector(3)
    vector.setValue(1, 2.5)
    vector[2] = -4.0
    assert (vector.getValue(1), vector.size(), len(vector), vector.normInf()) == (2.5, 3, 3, 4.0)
    np.testing.assert_array_equal(sk.getVector(vector), [0.0, 2.5, -4.0])
    vector.fill(3.0)
    assert vector.norm2() == pytest.approx(27**0.5)
    (tmp_path / "m.dat").write_text("2 3\n1 2 3\n4 5 6.5\n")
    matrix = sk.SimpleMatrix(str(tmp_path / "m.dat"))
    assert (matrix.size(0), matrix.size(1), matrix.getValue(1, 2)) == (2, 3, 6.5)
    np.testing.assert_array_equal(sk.getMatrix(matrix), [[1, 2, 3], [4, 5, 6.5]])
    for storage in (sk.DENSE, sk.SPARSE):
        square = sk.SimpleMatrix(2, 2, storage)
        square.eye()
        square[0, 1] = 7.0
        np.testing.assert_array_equal(np.asarray(square), [[1, 7], [0, 1]])
    (tmp_path / "m.dat").write_text("2 2\n1 2 3\n")
    with pytest.raises(ValueError, match="got 3 numbers for 2 x 2"):
        sk.SimpleMatrix(tmp_path / "m.dat")


def test_a_system_takes_vectors_and_matrices():
    weight = sk.SiconosVector([-2.0])
    ds = sk.LagrangianLinearTIDS(sk.SiconosVector(1), sk.SiconosVector([3.0]), sk.SimpleMatrix([[2.0]]))
    ds.setFExtPtr(weight)
    ds.setKPtr(sk.SimpleMatrix(1, 1))
    model = sk.NonSmoothDynamicalSystem(0.0, 1.0)
    model.insertDynamicalSystem(ds)
    sk.TimeStepping(model, sk.TimeDiscretisation(0.0, 0.1), sk.MoreauJeanOSI(0.5)).run()
    assert ds.velocity()[0] == pytest.approx(2.0)
    assert ds.q()[0] == pytest.approx(2.5)
    assert ds.fExt()[0] == weight[0]
    with pytest.raises(ValueError, match="read-only"):
        weight[0] = 1.0


def test_every_integrator_of_the_registry_is_there():
    for name in INTEGRATORS:
        assert getattr(sk, name)().name == name
    assert sk.D1MinusLinearOSI().name == "DMinusAccelerationOSI"


def test_every_solver_of_the_table_is_one_of_saltus():
    for name, (number, method) in sn.SOLVERS.items():
        assert getattr(sn, name) == getattr(sk, name) == number
        assert method in solvers()
    contact = sk.FrictionContact(2, sn.SICONOS_FRICTION_2D_LEMKE)
    assert contact.method == "lemke"
    contact.setSolverId(sn.SICONOS_FRICTION_2D_NSGS)
    assert contact.method == "nsgs"
    assert sk.LCP().method == "auto"


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: sk.Hem5OSI(), "not there; LsodarOSI and HalfExplicit"),
        (
            lambda: sk.LagrangianLinearTIDS([1.0], [0.0], [[1.0]], "Plug:K"),
            "expected numbers here, plugins are",
        ),
        (lambda: sk.LCP(9999), "solver 9999 is not there, there are SICONOS_MLCP_PGS = 100"),
        (lambda: ball()[1].setComputeRhsFunction("Plug", "f"), "setComputeRhsFunction is not there"),
        (lambda: ball()[1].p(3), r"p\(2\), the force, are there, got p\(3\)"),
        (lambda: ball()[2].lambda_(0), r"lambda_\(1\) and lambda_\(2\) are there, got lambda_\(0\)"),
        (lambda: ball()[2].y(2), "are there, got y"),
        (lambda: ball()[0].setNewtonTolerance(1e-15), "ends at 1e-12"),
    ],
)
def test_what_is_not_there_says_so(call, message):
    with pytest.raises(NotImplementedError, match=message):
        call()


def test_what_changes_nothing_is_taken():
    simulation, _, _ = ball()
    contact = sk.FrictionContact(2)
    contact.setMaxSize(1000)
    contact.setNumericsVerboseMode(False)
    simulation.setNewtonMaxIteration(20)
    simulation.insertNonSmoothProblem(contact)
    simulation.run()
    assert simulation.trajectory.provenance.solver == "auto"


def test_misuse_says_what_was_expected():
    with pytest.raises(
        TypeError, match="takes a law and a relation, got LagrangianLinearTIR, NewtonImpactNSL"
    ):
        sk.Interaction(sk.LagrangianLinearTIR([[1.0]]), sk.NewtonImpactNSL(0.5))
    model = sk.NonSmoothDynamicalSystem(0, 1)
    ds = sk.LagrangianLinearTIDS([1.0], [0.0], [[1.0]])
    floor = sk.Interaction(sk.NewtonImpactNSL(0.5), sk.LagrangianLinearTIR([[1.0]]))
    with pytest.raises(ValueError, match="expected a system that is inserted"):
        model.link(floor, ds)
    model.insertDynamicalSystem(ds)
    with pytest.raises(ValueError, match="expected an integrator"):
        sk.TimeStepping(model, sk.TimeDiscretisation(0, 0.1)).computeOneStep()
    with pytest.raises(AttributeError, match="has no 'Nonsense', it has"):
        sk.Nonsense  # noqa: B018
