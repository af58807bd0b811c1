"""Linear systems with a force that varies with time, against a closed solution and what they refuse."""

import numpy as np
import pytest
import saltus.kernel as sk
from scipy import sparse

OMEGA, DRIVE = 3.0, 2.0


class Driven(sk.LagrangianLinearTIDS):
    """A mass of 1 kg on a spring, driven by cos(2 t)."""

    calls = 0

    def external_force(self, t, out):
        type(self).calls += 1
        out[:] = np.cos(DRIVE * t)


def exact(t):
    return (np.cos(DRIVE * t) - np.cos(OMEGA * t)) / (OMEGA**2 - DRIVE**2)


def end_of(matrix, scheme, dt, until=2.0):
    system = sk.NonSmoothDynamicalSystem([Driven([0.0], [0.0], matrix([[1.0]]), matrix([[OMEGA**2]]))])
    return sk.TimeStepping(system, scheme, dt).run(until).q[-1, 0]


@pytest.mark.parametrize("matrix", [np.array, sparse.csr_array])
@pytest.mark.parametrize(
    "scheme", ["MoreauJeanOSI", "HalfExplicitTrapezoidalOSI", "HalfExplicitRungeKuttaOSI"]
)
def test_a_driven_oscillator_has_the_order_of_the_scheme(matrix, scheme):
    errors = [abs(end_of(matrix, scheme, dt) - exact(2.0)) for dt in (0.02, 0.01)]
    order = 3 if "Runge" in scheme else 2
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.2)


def test_an_implicit_step_takes_one_iteration():
    """It asks for the force at both ends of a step, and for the work at the end."""
    Driven.calls = 0
    end_of(np.array, "MoreauJeanOSI", 0.01, until=1.0)
    assert Driven.calls <= 3 * 100 + 2


def test_the_energy_balance_counts_the_work_of_the_force():
    system = sk.NonSmoothDynamicalSystem([Driven([0.0], [0.0], [[1.0]], [[OMEGA**2]])])
    run = sk.TimeStepping(system, "MoreauJeanOSI", 1e-3).run(1.0)
    np.testing.assert_allclose(run.potential_energy, 0.5 * OMEGA**2 * run.q[:, 0] ** 2, atol=1e-15)
    np.testing.assert_allclose(np.diff(run.kinetic_energy), run.work_forces[1:], atol=1e-13)


def test_what_is_refused():
    class Twice(sk.LagrangianLinearTIDS):
        def external_force(self, t, out):
            out[:] = 1.0

    class Other(sk.LagrangianLinearTIDS):
        def forces(self, t, q, v, out):
            out[:] = 1.0

    def run(ds):
        sk.TimeStepping(sk.NonSmoothDynamicalSystem([ds]), "MoreauJeanOSI", 1e-3).step()

    with pytest.raises(ValueError, match="external_force"):
        run(Twice([0.0], [0.0], [[1.0]], external_force=[1.0]))
    with pytest.raises(ValueError, match="Other.forces is not asked for: .* external_force"):
        run(Other([0.0], [0.0], [[1.0]]))
