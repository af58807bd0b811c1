"""The heavy top: orders against Euler's equations, what is kept, the joint and its force."""

from functools import cache
from math import cos, log2, pi

import numpy as np
import pytest
import saltus.kernel as sk
from saltus.examples.heavy_top.heavy_top import (
    ABOUT_ORIGIN,
    ACROSS,
    ALONG,
    GRAVITY,
    LENGTH,
    MASS,
    SCHEME,
    SPIN,
    TILT,
    build,
    reference,
    slow_precession,
    turning_inclinations,
    vertical_momentum,
)

ORDERS = {
    "ExplicitMoreauJeanOSI": 1,
    "MoreauJeanOSI": 1,
    "DMinusAccelerationOSI": 2,
    "HalfExplicitTrapezoidalOSI": 2,
    SCHEME: 2,
    "HalfExplicitRungeKuttaOSI(tableau=Heun)": 2,
    "HalfExplicitRungeKuttaOSI(tableau=third-order)": 3,
    "HalfExplicitRungeKuttaOSI(tableau=third-order,activity=sticky,stabilization=position)": 3,
    "HalfExplicitRungeKuttaOSI(tableau=RK4)": 3,
    "HalfExplicitRungeKuttaOSI(tableau=HEM5)": 5,
}


def run(scheme, time_step, until=0.1, precession=0.0):
    return sk.TimeStepping(build(precession), scheme, time_step).run(until)


@cache
def exact(time_step, until=0.1):
    return reference(np.linspace(0, until, round(until / time_step) + 1))


@pytest.mark.parametrize(("scheme", "order"), ORDERS.items())
def test_orders_against_eulers_equations(scheme, order):
    errors = []
    for time_step in (1e-3, 5e-4):
        trajectory, known = run(scheme, time_step), exact(time_step)
        errors.append(np.abs(np.hstack([trajectory.q - known.q, trajectory.v - known.v])).max())
    assert log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.3)


def test_a_scheme_of_fifth_order_starts_with_it():
    """Its first step is no single step of second order, as it is for what still approaches."""
    trajectory, known = run("HalfExplicitRungeKuttaOSI(tableau=HEM5)", 1e-3), exact(1e-3)
    assert np.abs(trajectory.q - known.q).max() < 1e-9


@pytest.mark.parametrize("scheme", [SCHEME, "HalfExplicitRungeKuttaOSI(tableau=HEM5,stabilization=position)"])
def test_the_joint_stays_closed_and_the_quaternion_of_length_one(scheme):
    trajectory = run(scheme, 1e-3, until=2.0)
    assert np.abs(trajectory["pivot"].gap).max() < 1e-12
    np.testing.assert_allclose(np.linalg.norm(trajectory.q[:, 3:], axis=1), 1.0, rtol=0, atol=1e-15)
    assert not trajectory.impulsive.any()


@pytest.mark.parametrize(("scheme", "order"), [("HalfExplicitTrapezoidalOSI", 2), (SCHEME, 2)])
def test_what_is_kept(scheme, order):
    lost = []
    for time_step in (1e-3, 5e-4):
        trajectory = run(scheme, time_step, until=0.5)
        momentum = vertical_momentum(trajectory)
        lost.append([np.ptp(trajectory.energy), np.ptp(momentum) / momentum[0]])
        np.testing.assert_allclose(trajectory.v[:, 5], SPIN, rtol=1e-13)  # no moment about the axis
    assert (np.log2(np.divide(*lost)) > order - 0.1).all()


def test_it_nods_between_two_inclinations():
    trajectory = run("HalfExplicitRungeKuttaOSI(tableau=HEM5)", 1e-3, until=0.5)
    up = np.array([sk.rotation_matrix(p)[2, 2] for p in trajectory.q[:, 3:]])
    low, high = turning_inclinations()
    assert high == pytest.approx(cos(TILT))
    assert up.max() == pytest.approx(high, abs=1e-9)
    assert up.min() >= low - 1e-10
    assert up.min() == pytest.approx(low, abs=1e-4)  # a step falls near the turn, not on it
    assert high - low > 0.01


def test_it_precesses_steadily():
    """At one inclination; the force of the joint turns with it."""
    rate = slow_precession()
    assert ABOUT_ORIGIN * rate**2 * cos(TILT) + MASS * GRAVITY * LENGTH == pytest.approx(ALONG * SPIN * rate)
    trajectory = run("HalfExplicitRungeKuttaOSI(tableau=HEM5)", 1e-3, until=0.4, precession=rate)
    np.testing.assert_allclose(trajectory.q[:, 2], LENGTH * cos(TILT), atol=1e-9)
    angle = np.unwrap(np.arctan2(trajectory.q[:, 1], trajectory.q[:, 0]))
    assert angle[-1] - angle[0] == pytest.approx(rate * 0.4, abs=1e-7)
    force = trajectory["pivot"].force[1:]
    inward = MASS * rate**2 * np.hypot(trajectory.q[0, 0], trajectory.q[0, 1])
    np.testing.assert_allclose(force[:, 2], MASS * GRAVITY, rtol=1e-5)
    np.testing.assert_allclose(np.hypot(force[:, 0], force[:, 1]), inward, rtol=1e-4)


def test_the_system():
    system = build()
    assert system.check().ok
    assert (system.coordinates, system.dimension) == (7, 6)
    assert pytest.approx(ACROSS + MASS * LENGTH**2) == ABOUT_ORIGIN
    assert 0 < TILT < pi / 2
