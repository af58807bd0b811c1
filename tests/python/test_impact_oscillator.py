"""The driven oscillator with a stop: its formula, and runs that stay on it."""

import numpy as np
import pytest
import saltus.kernel as sk
from saltus.examples.impact_oscillator.impact_oscillator import MASS, OMEGA, Drive, build

SCHEMES = ["HalfExplicitTrapezoidalOSI", "HalfExplicitRungeKuttaOSI", "MoreauJeanOSI"]
PERIODS = 50


@pytest.mark.parametrize("frequency", [15.0, 18.0, 22.0, 25.0, 30.0])
@pytest.mark.parametrize("restitution", [0.3, 0.6, 0.9])
def test_the_formula_is_a_motion_of_the_model(frequency, restitution):
    drive = Drive(frequency, restitution=restitution)
    t = np.linspace(0, drive.period, 2001)
    q = np.array([drive.position(x) for x in t])
    step = t[1]
    acceleration = (q[2:] - 2 * q[1:-1] + q[:-2]) / step**2
    force = np.array([drive.at(x) for x in t])
    residual = MASS * (acceleration + OMEGA**2 * q[1:-1]) - force[1:-1]
    assert np.abs(residual).max() < 1e-4 * drive.force
    assert q[[0, -1]] == pytest.approx([0, 0], abs=1e-13)
    assert q[1:-1].min() > 0  # it stays away from the stop
    start, end = ((-1.5 * q[0] + 2 * q[1] - 0.5 * q[2]), (1.5 * q[-1] - 2 * q[-2] + 0.5 * q[-3]))
    assert start / step == pytest.approx(drive.speed, rel=1e-4)
    assert start == pytest.approx(-restitution * end, rel=1e-4)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_runs_stay_on_it(scheme):
    drive, errors = Drive(), []
    for time_step in (1e-3, 1e-4):
        run = sk.TimeStepping(build(drive), scheme, time_step).run((PERIODS + 0.5) * drive.period)
        times, speeds = run.t[run.impulsive], run.v[run.impulsive, 0]
        assert len(times) == PERIODS
        np.testing.assert_allclose(times, drive.period * np.arange(1, PERIODS + 1), atol=2 * time_step)
        np.testing.assert_allclose(speeds, drive.speed, rtol=40 * time_step)
        errors.append(np.abs(speeds - drive.speed).mean())
        taken = -run.work_impulse[run.impulsive]
        before = drive.speed / drive.restitution
        exact = 0.5 * MASS * (1 - drive.restitution**2) * before**2
        np.testing.assert_allclose(taken, exact, rtol=80 * time_step)
    assert 4 < errors[0] / errors[1] < 25  # first order


def test_where_it_repels_runs_leave_it():
    drive = Drive(frequency=30.0)
    run = sk.TimeStepping(build(drive), SCHEMES[0], 1e-4).run(PERIODS * drive.period)
    speeds = run.v[run.impulsive, 0]
    assert abs(speeds[0] / drive.speed - 1) < 0.05
    assert np.abs(speeds[-5:] / drive.speed - 1).max() > 0.2


def test_check_finds_nothing():
    assert build().check().ok
