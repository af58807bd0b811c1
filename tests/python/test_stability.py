"""The warning of a time step beyond the stability limit."""

import time
import warnings

import numpy as np
import pytest
import saltus.kernel as sk
from saltus.examples.extending.trapezoidal_moreau import TrapezoidalMoreauOSI

OMEGA = 300.0


def oscillator(omega=OMEGA, zeta=0.0):
    body = sk.LagrangianLinearTIDS([1.0], [0.0], [[1.0]], [[omega**2]], [[2 * zeta * omega]])
    return sk.NonSmoothDynamicalSystem([body])


def warnings_of(system, scheme, dt):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        sk.TimeStepping(system, scheme, dt)
    assert all(w.category is sk.StabilityWarning for w in caught)
    return caught


@pytest.mark.parametrize("scheme", ["HalfExplicitTrapezoidalOSI", "DMinusAccelerationOSI"])
def test_the_limit_of_the_velocity_level_is_two(scheme):
    assert not warnings_of(oscillator(), scheme, 1.9999 / OMEGA)
    (warning,) = warnings_of(oscillator(), scheme, 3.0 / OMEGA)
    assert warning.filename == __file__
    for words in (scheme, "system 0", "omega = 300 rad/s", "largest stable time_step is 0.00666667 s"):
        assert words in str(warning.message)


def test_theta_of_a_half_and_more_has_no_limit():
    assert not warnings_of(oscillator(), sk.MoreauJeanOSI(theta=0.5), 1e3)
    assert not warnings_of(oscillator(zeta=0.1), sk.MoreauJeanOSI(theta=1.0), 1e3)
    (warning,) = warnings_of(oscillator(), sk.MoreauJeanOSI(theta=0.4), 1.0 / OMEGA)
    assert "it grows at every small time_step" in str(warning.message)


@pytest.mark.filterwarnings("ignore::saltus.kernel.StabilityWarning")
@pytest.mark.parametrize(("omega_dt", "stable"), [(1.99, True), (2.01, False)])
def test_schemes_in_python_are_judged_as_they_behave(omega_dt, stable):
    dt = omega_dt / OMEGA
    run = sk.TimeStepping(oscillator(), TrapezoidalMoreauOSI(), dt).run(2000 * dt)
    assert bool(abs(run.q[-1, 0]) < 100.0) is stable
    assert bool(warnings_of(oscillator(), TrapezoidalMoreauOSI(), dt)) is not stable


def test_a_scheme_that_takes_no_such_model_gives_no_warning():
    class OnlyMine(sk.OneStepIntegrator):
        def prepare(self, system, solver):
            if system.dimension != 2:
                raise RuntimeError("two freedoms only")

        def step(self, dt, state, reactions):
            return sk.StepReport()

    body = sk.LagrangianLinearTIDS([0, 0], [0, 0], np.eye(2), 100.0 * np.eye(2))
    assert not warnings_of(sk.NonSmoothDynamicalSystem([body]), OnlyMine(), 1.0)


def test_force_elements_count_and_nonlinear_systems_do_not():
    left, right = (sk.LagrangianLinearTIDS([x], [0.0], [[2.0]]) for x in (0.0, 1.0))
    system = sk.NonSmoothDynamicalSystem([left, right])
    assert not warnings_of(system, "HalfExplicitTrapezoidalOSI", 10.0)
    between = sk.LagrangianLinearTIR([[-1.0, 1.0]])
    system.add_force(sk.ForceElement(between, sk.SpringDamper(1e4)), left, right)  # ω = 100/s
    assert not warnings_of(system, "HalfExplicitTrapezoidalOSI", 0.0199)
    assert "0.02 s" in str(warnings_of(system, "HalfExplicitTrapezoidalOSI", 0.0201)[0].message)

    class Hard(sk.LagrangianDS):
        def forces(self, t, q, v, out):
            out[0] = -1e6 * q[0]

    assert not warnings_of(
        sk.NonSmoothDynamicalSystem([Hard([1.0], [0.0], [[1.0]])]), "HalfExplicitTrapezoidalOSI", 1.0
    )


def test_the_judgement_of_a_thousand_systems_takes_milliseconds():
    bodies = [
        sk.LagrangianLinearTIDS([0.0] * 3, [0.0] * 3, np.eye(3), np.diag([1.0, 2.0, k])) for k in range(1000)
    ]
    system = sk.NonSmoothDynamicalSystem(bodies)
    scheme = sk.HalfExplicitTrapezoidalOSI()
    (warning,) = warnings_of(system, scheme, 0.1)
    assert "system 999" in str(warning.message)
    start = time.perf_counter()
    assert sk._core.stability_warning(system, scheme, 1e-3) is None
    assert time.perf_counter() - start < 0.1  # measured: 1 ms
