"""First-order systems under Siconos's names: methods, kinds of relations, and what is refused."""

import subprocess

import numpy as np
import pytest
import saltus.siconos.kernel as sk

A = np.array([[0.0, 2.0], [-1.0, -0.5]])


def simulate(ds, relation, law, theta=1.0, h=0.05, steps=40):
    interaction = sk.Interaction(law, relation)
    model = sk.NonSmoothDynamicalSystem(0, 10)
    model.insertDynamicalSystem(ds)
    model.link(interaction, ds)
    simulation = sk.TimeStepping(model, sk.TimeDiscretisation(0, h), sk.EulerMoreauOSI(theta), sk.Relay())
    rows = []
    for _ in range(steps):
        simulation.computeOneStep()
        rows.append([*ds.x(), *ds.r(), *interaction.y(0), *interaction.lambda_(0)])
        simulation.nextStep()
    return np.array(rows)


def test_right_hand_sides_are_those_of_the_formulas():
    ds = sk.FirstOrderLinearTIDS([1.0, 2.0], A, [0.5, 0.0])
    ds.setMPtr([[2.0, 0.0], [0.0, 4.0]])
    ds.initRhs(0.0)
    np.testing.assert_allclose(ds.rhs(), [2.25, -0.5], atol=1e-15)
    np.testing.assert_allclose(ds.jacobianRhsx(), [[0.0, 1.0], [-0.25, -0.125]], atol=1e-15)
    np.testing.assert_array_equal(ds.jacobianfx(), A)
    ds.computef(0.0, np.array([0.0, 1.0]))
    np.testing.assert_array_equal(ds.f(), [2.5, -0.5])
    assert ds.isLinear()
    assert ds.dimension() == ds.n() == 2
    ds._live[0][:] = 7.0
    ds._live[1][:] = 1.0
    ds.resetToInitialState()
    ds.resetNonSmoothPart(0)
    np.testing.assert_array_equal(ds.x(), [1.0, 2.0])
    np.testing.assert_array_equal(ds.r(), 0.0)


def test_what_is_not_given_is_none():
    ds = sk.FirstOrderNonLinearDS([1.0])
    assert (ds.f(), ds.jacobianfx(), ds.M()) == (None, None, None)
    linear = sk.FirstOrderLinearDS([1.0])
    assert (linear.A(), linear.b()) == (None, None)
    relation = sk.FirstOrderLinearTIR([[1.0]], [[2.0]])
    assert (relation.D(), relation.e(), relation.F(), relation.K()) == (None, None, None, None)
    np.testing.assert_array_equal(relation.B(), [[2.0]])


class Type1(sk.FirstOrderType1R):
    def computeh(self, time, x, z, y):
        y[0] = x[0] + x[1]

    def computeg(self, time, lam, z, r):
        r[1] = 2.0 * lam[0]

    def computeJachx(self, time, x, z, C):
        C[:] = 1.0

    def computeJacglambda(self, time, lam, z, B):
        B[:] = [[0.0], [2.0]]


class Type2(sk.FirstOrderType2R):
    def computeh(self, time, x, lam, y):
        y[0] = x[0] + x[1]

    def computeg(self, time, lam, r):
        r[1] = 2.0 * lam[0]

    def computeJachlambda(self, time, x, lam, D):
        D[:] = 0.0


class NonLinear(sk.FirstOrderNonLinearR):
    def computeh(self, time, x, lam, z, y):
        y[0] = x[0] + x[1]

    def computeg(self, time, x, lam, z, r):
        r[1] = 2.0 * lam[0]


class Varying(sk.FirstOrderLinearR):
    def computeC(self, time, z, C):
        C[:] = 1.0

    def computeD(self, time, z, D):
        D[:] = 0.0

    def computeB(self, time, z, B):
        B[1, 0] = 2.0

    def computee(self, time, z, e):
        e[:] = 0.0


@pytest.mark.parametrize(
    "relation",
    [Type1(), Type2(), NonLinear(), Varying([[0.0, 0.0]], [[0.0], [0.0]])],
    ids=lambda relation: type(relation).__name__,
)
def test_relations_of_all_kinds_give_the_same_motion(relation):
    expected = simulate(
        sk.FirstOrderLinearTIDS([1.0, 1.0], A),
        sk.FirstOrderLinearTIR([[1.0, 1.0]], [[0.0], [2.0]]),
        sk.RelayNSL(1),
    )
    assert 5 < np.count_nonzero(np.abs(expected[:, 5]) < 1.0) < 35  # it slides, and not always
    found = simulate(sk.FirstOrderLinearDS([1.0, 1.0], A), relation, sk.RelayNSL(1))
    np.testing.assert_allclose(found, expected, atol=1e-11)


def test_parameters_act_through_F():
    ds = sk.FirstOrderLinearTIDS([0.0], [[0.0]])
    ds.setzPtr([2.0, -1.0])
    relation = sk.FirstOrderLinearTIR([[1.0]], [[0.0]], [[0.5]], [0.25], [[1.0]])
    with pytest.raises(ValueError, match=r"F must be \(1, 2\) as z has 2 entries, got \(1, 1\)"):
        simulate(ds, relation, sk.ComplementarityConditionNSL(1), steps=1)
    relation.setFPtr([[1.0, 3.0]])
    row = simulate(ds, relation, sk.ComplementarityConditionNSL(1), h=0.5, steps=1)[0]
    np.testing.assert_allclose(row, [0.75, 1.5, 0.0, 1.5], atol=1e-15)  # y = x + F z + e = 0


def test_constants_cannot_change_behind_the_simulation():
    A_now, M, e = -np.eye(2), np.eye(2), np.zeros(1)
    ds = sk.FirstOrderLinearDS([1.0, 1.0], A_now)
    ds.setMPtr(M)
    relation = sk.FirstOrderLinearTIR([[1.0, 1.0]], [[0.0], [2.0]])
    relation.setePtr(e)
    simulate(ds, relation, sk.RelayNSL(1), steps=1)
    for array in (A_now, M, e):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 3.0


def test_a_constant_f_needs_no_override():
    ds = sk.FirstOrderNonLinearDS([1.0])
    ds.setFPtr([-2.0])
    free = sk.FirstOrderLinearTIR([[1.0]], [[0.0]])
    free.setDPtr([[1.0]])
    rows = simulate(ds, free, sk.RelayNSL(1), h=0.25, steps=2)
    np.testing.assert_allclose(rows[:, 0], [0.5, 0.0], atol=1e-15)


def test_gamma_is_used_as_it_is_said():
    osi = sk.EulerMoreauOSI(0.5)
    assert (osi.theta(), osi.gamma(), osi.useGamma()) == (0.5, 1.0, False)
    assert osi.native().gamma == 1.0
    with pytest.raises(NotImplementedError, match="gamma is constant once the simulation is made"):
        osi.setGamma(0.7)
    osi = sk.EulerMoreauOSI(0.5)
    osi.setGamma(0.7)
    made = osi.native()
    assert (made.gamma, made.gamma_for_relation) == (0.7, False)
    osi = sk.EulerMoreauOSI(0.5, 0.7)
    osi.setUseGammaForRelation(True)
    made = osi.native()
    assert (made.gamma, made.gamma_for_relation, osi.useGamma()) == (0.7, True, False)
    osi = sk.EulerMoreauOSI(0.5, 0.7)
    osi.setUseGammaForRelation(True)
    osi.setUseGammaForRelation(False)
    assert osi.native().gamma == 1.0


def test_a_hold_is_that_of_the_kernel():
    interaction = sk.Interaction(sk.RelayNSL(1), sk.FirstOrderLinearTIR([[1.0, 0.0]], [[0.0], [1.0]]))
    ds = sk.FirstOrderLinearDS([1.0, 0.0], np.zeros((2, 2)))
    model = sk.NonSmoothDynamicalSystem(0, 1)
    model.insertDynamicalSystem(ds)
    model.link(interaction, ds)
    ds.setAPtr([[0.0, 1.0], [0.0, 0.0]])
    simulation = sk.TimeStepping(model, sk.TimeDiscretisation(0, 0.5), sk.ZeroOrderHoldOSI(), sk.Relay())
    simulation.computeOneStep()
    np.testing.assert_allclose(ds.x(), [0.875, -0.5], atol=1e-15)  # ẍ = −1 over half a second
    assert simulation.trajectory.provenance.integrator == "ZeroOrderHoldOSI"


def test_laws_say_what_they_are(capsys):
    relay = sk.RelayNSL(2, -0.5, 2.0)
    assert (relay.lb(), relay.ub(), relay.size()) == (-0.5, 2.0, 2)
    relay.display()
    assert "lb = -0.5, ub = 2.0" in capsys.readouterr().out
    mixed = sk.MixedComplementarityConditionNSL(2, 1)
    assert (mixed.size(), mixed.equalitySize()) == (3, 1)


def test_kinds_are_not_mixed():
    circuit, ball = sk.FirstOrderLinearDS([1.0], [[0.0]]), sk.LagrangianLinearTIDS([1.0], [0.0], [[1.0]])
    model = sk.NonSmoothDynamicalSystem(0, 1)
    model.insertDynamicalSystem(circuit)
    model.insertDynamicalSystem(ball)
    relation = sk.FirstOrderLinearTIR([[1.0]], [[1.0]])
    with pytest.raises(
        TypeError, match="a relation and systems of one kind, got FirstOrderLinearTIR and Lagr"
    ):
        model.link(sk.Interaction(sk.RelayNSL(1), relation), ball)
    with pytest.raises(
        TypeError, match="takes a law and a relation, got NewtonImpactNSL, FirstOrderLinearTIR"
    ):
        sk.Interaction(sk.NewtonImpactNSL(0.5), relation)
    with pytest.raises(TypeError, match="takes a law and a relation, got RelayNSL, LagrangianLinearTIR"):
        sk.Interaction(sk.RelayNSL(1), sk.LagrangianLinearTIR([[1.0]]))
    simulation = sk.TimeStepping(model, sk.TimeDiscretisation(0, 0.1), sk.EulerMoreauOSI(0.5))
    with pytest.raises(ValueError, match="Lagrangian or first-order systems in a simulation, got both"):
        simulation.computeOneStep()
    alone = sk.NonSmoothDynamicalSystem(0, 1)
    alone.insertDynamicalSystem(ball)
    with pytest.raises(ValueError, match="got EulerMoreauOSI, which is for first-order systems"):
        sk.TimeStepping(alone, sk.TimeDiscretisation(0, 0.1), sk.EulerMoreauOSI(0.5)).computeOneStep()
    alone = sk.NonSmoothDynamicalSystem(0, 1)
    alone.insertDynamicalSystem(circuit)
    with pytest.raises(ValueError, match=r"expected EulerMoreauOSI\(theta\) for first-order systems"):
        sk.TimeStepping(alone, sk.TimeDiscretisation(0, 0.1), sk.MoreauJeanOSI(0.5)).computeOneStep()


def test_levels_and_plugins_that_are_not_there_say_so():
    interaction = sk.Interaction(sk.RelayNSL(1), sk.FirstOrderLinearTIR([[1.0]], [[1.0]]))
    with pytest.raises(NotImplementedError, match=r"y\(0\) is there, got y\(1\)"):
        interaction.y(1)
    with pytest.raises(NotImplementedError, match=r"lambda_\(0\) is there, got lambda_\(1\)"):
        interaction.lambda_(1)
    with pytest.raises(ValueError, match="plugin 'Plugin': expected Plugin.so or libPlugin.so"):
        sk.FirstOrderNonLinearDS([1.0], "Plugin:f")
    with pytest.raises(TypeError, match="takes 2 plugins, got 3"):
        sk.FirstOrderNonLinearDS([1.0], "a:b", "a:b", "a:b")
    with pytest.raises(NotImplementedError, match=r"must define computeh\(self, ..., y\)"):
        simulate(sk.FirstOrderLinearDS([1.0], [[0.0]]), sk.FirstOrderNonLinearR(), sk.RelayNSL(1))
    with pytest.raises(TypeError, match="takes C, B or C, D, F, e, B, got 3 arguments"):
        sk.FirstOrderLinearTIR([[1.0]], [[1.0]], [[1.0]])


SOURCE = """
#include <math.h>
typedef unsigned int size;
void source(double t, size n, double* b, size nz, double* z) { b[0] = z[0] * cos(3 * t); b[1] = t; }
void rotation(double t, size rows, size columns, double* A, size nz, double* z) {
  A[0] = -0.1; A[1] = -2 - t; A[2] = 1; A[3] = -0.2;  /* column by column */
}
void pendulum(double t, size n, double* x, double* f, size nz, double* z) { f[0] = x[1]; f[1] = -sin(x[0]); }
void pendulum_dx(double t, size n, double* x, double* J, size nz, double* z) {
  J[1] = -cos(x[0]); J[2] = 1;
}
"""


class Rotation(sk.FirstOrderLinearDS):
    def computeA(self, time):
        self.A()[:] = [[-0.1, 1.0], [-2.0 - time, -0.2]]

    def computeb(self, time):
        self.b()[:] = [4.0 * np.cos(3 * time), time]


class Pendulum(sk.FirstOrderNonLinearDS):
    def computef(self, time, state):
        self.f()[:] = [state[1], -np.sin(state[0])]

    def computeJacobianfx(self, time, state):
        self.jacobianfx()[:] = [[0.0, 1.0], [-np.cos(state[0]), 0.0]]


def test_plugins_stand_for_overrides(tmp_path):
    (tmp_path / "terms.c").write_text(SOURCE)
    command = ["gcc", "-shared", "-fPIC", "terms.c", "-o", "libterms.so", "-lm"]
    subprocess.run(command, cwd=tmp_path, check=True)
    library = str(tmp_path / "terms")
    linear = sk.FirstOrderLinearDS([1.0, 0.5])
    linear.setzPtr([4.0])
    linear.setComputeAFunction(library, "rotation")
    linear.setComputebFunction(library, "source")
    nonlinear = sk.FirstOrderNonLinearDS([1.0, 0.5], f"{library}:pendulum", f"{library}:pendulum_dx")
    for plugged, own in ((linear, Rotation([1.0, 0.5])), (nonlinear, Pendulum([1.0, 0.5]))):
        for ds in (plugged, own):
            model = sk.NonSmoothDynamicalSystem(0, 1)
            model.insertDynamicalSystem(ds)
            sk.TimeStepping(model, sk.TimeDiscretisation(0, 0.01), sk.EulerMoreauOSI(0.5), sk.Relay()).run()
        np.testing.assert_allclose(plugged.x(), own.x(), rtol=1e-13)
        assert np.abs(plugged.x() - [1.0, 0.5]).max() > 0.1
        plugged.computeJacobianRhsx(0.7)
        own.computeJacobianRhsx(0.7)
        np.testing.assert_allclose(plugged.jacobianRhsx(), own.jacobianRhsx(), rtol=1e-13)
    with pytest.raises(ValueError, match="the library exports no 'nothing'"):
        linear.setComputebFunction(library, "nothing")


def test_linear_relations_can_be_filled_one_by_one():
    rows = []
    empty = sk.FirstOrderLinearTIR()
    for relation in (empty, sk.FirstOrderLinearTIR([[1.0]], [[2.0]])):
        if relation is empty:
            with pytest.raises(ValueError, match=r"expected setCPtr\(\) and setBPtr\(\)"):
                simulate(sk.FirstOrderLinearTIDS([1.0], [[-1.0]]), relation, sk.RelayNSL(1), steps=1)
            relation.setCPtr([[1.0]])
            relation.setBPtr([[2.0]])
        rows.append(simulate(sk.FirstOrderLinearTIDS([1.0], [[-1.0]]), relation, sk.RelayNSL(1), steps=3))
    np.testing.assert_array_equal(*rows)
