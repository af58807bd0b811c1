"""The chain of rods: forces at rest, frequencies, joints and energy while it falls."""

from math import cos, log2, pi, sin

import numpy as np
import pytest
import saltus.kernel as sk
from saltus.examples.chain_of_bodies.chain_of_bodies import (
    GRAVITY,
    LENGTH,
    MASS,
    SCHEME,
    TIME_STEP,
    build,
    modes,
    step_cost,
)
from scipy.special import jn_zeros

SCHEMES = [
    SCHEME,
    "HalfExplicitTrapezoidalOSI",
    "HalfExplicitRungeKuttaOSI(tableau=HEM5,activity=sticky,stabilization=position)",
    "MoreauJeanOSI",
]


def run(scheme, time_step, until, *what):
    return sk.TimeStepping(build(*what), scheme, time_step).run(until)


@pytest.mark.parametrize("n", [1, 10, 60])
@pytest.mark.parametrize("scheme", SCHEMES)
def test_at_rest_a_joint_carries_what_hangs_on_it(scheme, n):
    trajectory = run(scheme, TIME_STEP, 10 * TIME_STEP, n)
    for k in range(n):
        joint = trajectory[str(k)]
        carried = joint.force[1:] + joint.impulse[1:] / TIME_STEP  # on the rod below
        np.testing.assert_allclose(carried[:, 2], (n - k) * MASS * GRAVITY, rtol=1e-10)
        np.testing.assert_allclose(carried[:, :2], 0.0, atol=1e-12)


def test_frequencies_of_one_rod_and_of_a_rope():
    frequencies, _ = modes(1)
    assert frequencies[0] ** 2 == pytest.approx(1.5 * GRAVITY / LENGTH, rel=1e-13)
    frequencies, _ = modes(100)
    rope = jn_zeros(0, 3) / 2 * np.sqrt(GRAVITY / (100 * LENGTH))
    np.testing.assert_allclose(frequencies[:3], rope, rtol=1e-3)


@pytest.mark.parametrize("scheme", [SCHEME, "HalfExplicitTrapezoidalOSI"])
@pytest.mark.parametrize("mode", [0, 1, 4])
def test_small_oscillations_have_the_frequencies_of_the_eigenproblem(scheme, mode):
    frequencies, shapes = modes(5)
    angles = 1e-4 * shapes[:, mode] / np.abs(shapes[:, mode]).max()
    period, errors = 2 * pi / frequencies[mode], []
    for steps in (250, 500):
        trajectory = run(scheme, period / steps, period, 5, angles)
        x = trajectory.q[:, ::7]
        exact = np.outer(np.cos(frequencies[mode] * trajectory.t), x[0])
        errors.append(np.abs(x - exact).max() / np.abs(x[0]).max())
    assert errors[1] < 4e-5
    assert log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.05)


def test_joints_stay_closed_in_a_long_fall():
    trajectory = run(SCHEME, TIME_STEP, 5.0, 10, pi / 2)
    assert max(np.abs(trajectory[str(k)].gap).max() for k in range(10)) < 1e-12
    assert not trajectory.impulsive.any()
    assert trajectory.kinetic_energy.max() > 4.0


def test_energy_is_kept_to_second_order():
    lost = []
    for time_step in (1e-3, 5e-4):
        trajectory = run(SCHEME, time_step, 0.6, 10, pi / 2)
        lost.append(np.ptp(trajectory.energy))
    assert lost[0] < 1e-3
    assert log2(lost[0] / lost[1]) == pytest.approx(2, abs=0.2)


def test_one_rod_falls_like_a_pendulum():
    """½ (m l²/3) θ̇² = m γ l/2 (cos θ − cos θ0), and the ceiling's force turns and grows with it."""
    trajectory = run(SCHEMES[2], TIME_STEP, 0.5, 1, pi / 3)
    angle = 2 * np.arctan2(-trajectory.q[:, 5], trajectory.q[:, 3])
    rate = -trajectory.v[:, 4]
    np.testing.assert_allclose(rate**2, 3 * GRAVITY / LENGTH * (np.cos(angle) - cos(pi / 3)), atol=1e-8)
    np.testing.assert_allclose(trajectory.q[:, 0], LENGTH / 2 * np.sin(angle), atol=1e-13)
    mean = (trajectory["0"].force[1:, 2]).mean() - MASS * GRAVITY  # the momentum that it gives
    assert mean * 0.5 == pytest.approx(MASS * (trajectory.v[-1, 2] - trajectory.v[0, 2]), rel=1e-9)
    assert abs(sin(angle[-1])) <= sin(pi / 3)


def test_checks_and_refusals():
    assert build(3, 0.2).check().ok
    assert step_cost(2, steps=3) > 0
    with pytest.raises(ValueError, match="expected at least one rod, got 0"):
        build(0)
