"""First-order models in Python: overrides, laws, what is recorded, and what is refused."""

import h5py
import matplotlib.pyplot as plt
import numpy as np
import pytest
import saltus.kernel as sk
from saltus.io import read_first_order
from scipy.linalg import expm

A = np.array([[-0.2, 1.0], [-1.0, -0.5]])


def half_wave(circuit, **options):
    """A source behind a diode: 0 <= x1 - 0.1 + 0.3 λ, 0 <= λ, which drives x1."""
    model = sk.FirstOrderSystem([circuit], parameters={"resistance": 0.3})
    relation = sk.FirstOrderLinearTIR([[1.0, 0.0]], [[1.0], [0.0]], [[0.3]], [-0.1])
    model.link(relation, sk.ComplementarityConditionNSL(1), circuit, name="diode")
    return sk.FirstOrderTimeStepping(model, sk.EulerMoreauOSI(0.5), 2e-3, **options)


class Driven(sk.FirstOrderLinearDS):
    def b(self, t, out):
        out[1] = np.sin(4.0 * t)


class DrivenAnyhow(sk.FirstOrderNonLinearDS):
    """The same, as if nothing were known of it."""

    def f(self, t, x, out):
        out[:] = A @ x
        out[1] += np.sin(4.0 * t)


class DrivenWithDerivative(DrivenAnyhow):
    def jacobian(self, t, x, out):
        out[:] = A


class Varying(sk.FirstOrderLinearDS):
    def A(self, t, out):
        out[:] = A

    def b(self, t, out):
        out[1] = np.sin(4.0 * t)


class Diode(sk.FirstOrderNonLinearR):
    """The relation of `half_wave`, as if nothing were known of it."""

    def __init__(self):
        super().__init__(1)

    def output(self, t, x, lam, out):
        out[0] = x[0] - 0.1 + 0.3 * lam[0]

    def input(self, t, x, lam, out):
        out[0] = lam[0]


class VaryingDiode(sk.FirstOrderLinearR):
    def C(self, t, out):
        out[0, 0] = 1.0

    def e(self, t, out):
        out[0] = -0.1


def test_a_model_is_the_same_however_it_is_told():
    expected = half_wave(Driven([0.5, 0.0], A)).run(5.0)
    assert np.count_nonzero(expected.lambda_ > 0) > 100
    assert np.count_nonzero(expected.lambda_ == 0) > 100
    for circuit in (
        Varying([0.5, 0.0]),
        DrivenAnyhow([0.5, 0.0]),
        DrivenWithDerivative([0.5, 0.0]),
        Driven([0.5, 0.0], A, M=np.eye(2)),
    ):
        run = half_wave(circuit).run(5.0)
        np.testing.assert_allclose(run.x, expected.x, atol=1e-11)
        np.testing.assert_allclose(run.lambda_, expected.lambda_, atol=1e-10)
    for relation in (Diode(), VaryingDiode([[0.0, 0.0]], [[1.0], [0.0]], [[0.3]])):
        circuit = Driven([0.5, 0.0], A)
        model = sk.FirstOrderSystem([circuit])
        model.link(relation, sk.ComplementarityConditionNSL(1), circuit)
        run = sk.FirstOrderTimeStepping(model, sk.EulerMoreauOSI(0.5), 2e-3).run(5.0)
        np.testing.assert_allclose(run.x, expected.x, atol=1e-11)


def test_the_law_of_an_equality_is_that_of_mechanics():
    point = sk.FirstOrderLinearTIDS([1.0, 0.0], None, [0.5, 0.0])
    model = sk.FirstOrderSystem([point])
    model.link(
        sk.FirstOrderLinearTIR([[1.0, 1.0]], [[1.0], [1.0]], e=[-1.0]), sk.EqualityConditionNSL(1), point
    )
    run = sk.FirstOrderTimeStepping(model, sk.EulerMoreauOSI(), 0.1).run(1.0)
    np.testing.assert_allclose(run.x.sum(axis=1), 1.0, atol=1e-14)
    np.testing.assert_allclose(run.lambda_[1:], -0.25, atol=1e-13)  # half of the drift, from both


def test_a_hold_turns_a_circle_exactly_and_refuses_what_varies():
    model = sk.FirstOrderSystem([sk.FirstOrderLinearTIDS([1.0, 0.0], [[0.0, 1.0], [-1.0, 0.0]])])
    run = sk.FirstOrderTimeStepping(model, sk.ZeroOrderHoldOSI(), 0.7).run(70.0)
    np.testing.assert_allclose(run.x, np.c_[np.cos(run.t), -np.sin(run.t)], atol=1e-12)
    with pytest.raises(ValueError, match="needs a system 0 that is linear with constant A"):
        sk.FirstOrderTimeStepping(sk.FirstOrderSystem([Varying([0.5, 0.0])]), sk.ZeroOrderHoldOSI(), 0.1)
    sk.FirstOrderTimeStepping(sk.FirstOrderSystem([Driven([0.5, 0.0], A)]), sk.ZeroOrderHoldOSI(), 0.1)


def test_laws_have_their_bounds():
    laws = sk.MixedComplementarityConditionNSL(1, 2)
    assert laws.size == 3
    assert laws.lower.tolist() == [-np.inf, 0.0, 0.0]
    relay = sk.RelayNSL(2, -0.5, 2.0)
    assert (relay.lower.tolist(), relay.upper.tolist()) == ([-0.5, -0.5], [2.0, 2.0])
    with pytest.raises(ValueError, match=r"bounds of a relay must be finite, got \[-1, inf\]"):
        sk.RelayNSL(1, -1.0, np.inf)
    with pytest.raises(ValueError, match="lower <= upper"):
        sk.BoxLaws([1.0], [0.0])


def test_a_run_is_recorded_and_read_back(tmp_path):
    simulation = half_wave(Driven([0.5, 0.0], A), record_every=5)
    run = simulation.run(1.0)
    assert len(run) == 101
    assert run.step[-1] == 500
    assert run.residual.max() <= 1e-12
    assert run.iterations[1:].tolist() == [1] * 100
    np.testing.assert_array_equal(run["diode"].y, run.y)
    np.testing.assert_allclose(
        run["diode"].y[:, 0], run.x[:, 0] - 0.1 + 0.3 * run["diode"].lambda_[:, 0], atol=1e-15
    )
    np.testing.assert_array_equal(run.r[:, 0], run.lambda_[:, 0])
    again = read_first_order(run.to_hdf5(tmp_path / "run.h5"))
    for name, column in run.columns().items():
        np.testing.assert_array_equal(again.columns()[name], column)
    assert again.provenance == run.provenance
    assert again["diode"].lambda_.shape == (101, 1)
    table = np.genfromtxt(run.to_csv(tmp_path / "run.csv"), delimiter=",", names=True, deletechars="")
    assert "diode.lambda0" in table.dtype.names
    np.testing.assert_array_equal(table["x1"], run.x[:, 1])
    with pytest.raises(KeyError, match="no interaction named 'relay', there are diode"):
        run["relay"]
    h5py.File(tmp_path / "other.h5", "w").close()
    with pytest.raises(ValueError, match="must be a first-order run of format 1"):
        read_first_order(tmp_path / "other.h5")


def test_a_run_is_drawn():
    run = half_wave(Driven([0.5, 0.0], A)).run(0.5)
    states, outputs, multipliers = run.plot()
    np.testing.assert_array_equal(states.lines[1].get_ydata(), run.x[:, 1])
    np.testing.assert_array_equal(outputs.lines[0].get_ydata(), run.y[:, 0])
    np.testing.assert_array_equal(multipliers.lines[0].get_ydata(), run.lambda_[:, 0])
    assert [text.get_text() for text in multipliers.get_legend().get_texts()] == ["diode[0]"]
    assert run.plot([outputs, multipliers, states])[2] is states
    np.testing.assert_array_equal(states.lines[-1].get_ydata(), run.lambda_[:, 0])
    with pytest.raises(ValueError, match="3 axes for the panels state, output, multiplier; got 1 of Axes"):
        run.plot(states)
    plt.close(states.figure)
    free = sk.FirstOrderTimeStepping(
        sk.FirstOrderSystem([sk.FirstOrderLinearTIDS([1.0], [[-1.0]])]), sk.EulerMoreauOSI(), 0.1
    )
    (only,) = free.run(1.0).plot()
    plt.close(only.figure)


def test_a_run_can_be_continued_and_watched():
    times = []
    simulation = half_wave(Driven([0.5, 0.0], A))
    simulation.run(1.0)
    simulation.run(4.0, progress=times.append)
    assert len(simulation.trajectory) == 2001
    assert len(times) == 3
    np.testing.assert_array_equal(simulation.trajectory.x, half_wave(Driven([0.5, 0.0], A)).run(4.0).x)
    assert simulation.report.iterations == 1


def test_a_failure_keeps_what_was_recorded():
    class Runaway(sk.FirstOrderNonLinearDS):
        def f(self, t, x, out):
            out[:] = np.inf if t > 0.5 else 1.0

    simulation = sk.FirstOrderTimeStepping(sk.FirstOrderSystem([Runaway([0.0])]), sk.EulerMoreauOSI(1.0), 0.1)
    with pytest.raises(sk.SimulationError, match="the state is not finite") as caught:
        simulation.run(1.0)
    assert len(caught.value.trajectory) == 6
    assert caught.value.step == 6
    assert simulation.x[0] == pytest.approx(0.5, abs=1e-15)


def test_an_error_of_the_model_leaves_the_state_alone():
    class Moody(sk.FirstOrderNonLinearDS):
        def f(self, t, x, out):
            if t > 0.25:
                raise RuntimeError("no more")
            out[:] = 1.0

    simulation = sk.FirstOrderTimeStepping(sk.FirstOrderSystem([Moody([0.0])]), sk.EulerMoreauOSI(1.0), 0.1)
    for _ in range(2):
        with pytest.raises(RuntimeError, match="no more"):
            simulation.run(1.0)
        assert simulation.x[0] == pytest.approx(0.2, abs=1e-15)
        assert simulation.steps == 2


def test_misuse_says_what_was_expected():
    one = sk.FirstOrderLinearTIDS([1.0])
    model = sk.FirstOrderSystem([one])
    with pytest.raises(ValueError, match=r"A must be \(1, 1\), got \(2, 2\)"):
        sk.FirstOrderLinearTIDS([1.0], np.eye(2))
    with pytest.raises(ValueError, match=r"B must be \(2, 1\), got \(1, 2\)"):
        sk.FirstOrderLinearTIR([[1.0, 0.0]], [[1.0, 0.0]])
    with pytest.raises(ValueError, match="C must have 1 columns as the systems have states, got 2"):
        model.link(
            sk.FirstOrderLinearTIR(np.zeros((1, 2)), np.zeros((2, 1))), sk.ComplementarityConditionNSL(1), one
        )
    with pytest.raises(ValueError, match=r"theta must be in \[0, 1\], got 2"):
        sk.FirstOrderTimeStepping(model, sk.EulerMoreauOSI(2.0), 0.1)
    with pytest.raises(TypeError, match="integrator must be an EulerMoreauOSI or ZeroOrderHoldOSI, got"):
        sk.FirstOrderTimeStepping(model, sk.MoreauJeanOSI(), 0.1)
    with pytest.raises(TypeError, match="system must be a FirstOrderSystem"):
        sk.FirstOrderTimeStepping(one, sk.EulerMoreauOSI(), 0.1)


@pytest.mark.parametrize(
    ("methods", "error", "message"),
    [
        ({}, NotImplementedError, r"Made must define f\(self, t, x, out\)"),
        ({"f": lambda self, t, x, out: x}, TypeError, "must write into out and return None"),
    ],
)
def test_methods_that_are_wrong_say_so(methods, error, message):
    made = type("Made", (sk.FirstOrderNonLinearDS,), methods)
    system = sk.FirstOrderSystem([made([0.0])])
    with pytest.raises(error, match=message):
        sk.FirstOrderTimeStepping(system, sk.EulerMoreauOSI(), 0.1)


def bridge_error(steps, integrator):
    """At 1 ms of the diode bridge: the resistor loads the circuit whatever the sign of the voltage."""
    L, C, R, T = 1e-2, 1e-6, 1e3, 1e-3
    circuit = sk.FirstOrderLinearTIDS([10.0, 0.0], [[0, -1 / C], [1 / L, 0]])
    bridge = sk.FirstOrderLinearTIR(
        C=[[0, 0], [0, 0], [-1, 0], [1, 0]],
        B=[[0, 0, -1 / C, 1 / C], [0, 0, 0, 0]],
        D=[[1 / R, 1 / R, -1, 0], [1 / R, 1 / R, 0, -1], [1, 0, 0, 0], [0, 1, 0, 0]],
    )
    model = sk.FirstOrderSystem([circuit])
    model.link(bridge, sk.ComplementarityConditionNSL(4), circuit)
    simulation = sk.FirstOrderTimeStepping(model, integrator, T / steps)
    for _ in range(steps):
        simulation.step()
    exact = expm(np.array([[-1 / (R * C), -1 / C], [1 / L, 0]]) * T) @ [10.0, 0.0]
    return np.abs((simulation.x - exact) / [10.0, 0.1]).max()


@pytest.mark.parametrize(
    ("integrator", "order", "error"),
    [
        (sk.EulerMoreauOSI(1.0), 1.0, 1.1e-2),
        (sk.EulerMoreauOSI(0.5), 1.0, 5.7e-4),
        (sk.EulerMoreauOSI(0.5, 0.5), 1.0, 1.3e-4),
        (sk.EulerMoreauOSI(0.5, 0.5, gamma_for_relation=True), 2.0, 9.6e-6),
    ],
)
def test_the_bridge_has_the_orders_and_errors_that_the_page_says(integrator, order, error):
    coarse, fine = bridge_error(2000, integrator), bridge_error(4000, integrator)
    assert np.log2(coarse / fine) == pytest.approx(order, abs=0.06)
    assert coarse == pytest.approx(error, rel=0.05)
