"""The sphere that slides and rolls: parabola, end of sliding, angular momentum; the oblique impact."""

from math import log2

import numpy as np
import pytest
import saltus.kernel as sk
from saltus.examples.rolling_sphere.rolling_sphere import (
    GRAVITY,
    MASS,
    MU,
    RADIUS,
    SCHEME,
    SPIN,
    VELOCITY,
    after_impact,
    build,
    rolling,
    slip,
)

SCHEMES = [SCHEME, "HalfExplicitRungeKuttaOSI", "MoreauJeanOSI", "ExplicitMoreauJeanOSI"]
SIDEWAYS = {"none": (0.0, 0.0, 0.0), "backspin": (0.0, -90.0, 0.0), "topspin": (0.0, 80.0, 0.0)}


def run(scheme=SCHEME, time_step=1e-3, until=1.0, **what):
    return sk.TimeStepping(build(**what), scheme, time_step).run(until)


def in_space(trajectory):
    """ω (rows, 3)."""
    pairs = zip(trajectory.q, trajectory.v, strict=True)
    return np.array([sk.rotation_matrix(q[3:]) @ v[3:] for q, v in pairs])


def test_a_sphere_without_spin_loses_two_sevenths():
    speed, known = 1.5, rolling((1.5, 0.0, 0.0), (0.0, 0.0, 0.0))
    assert known.t == pytest.approx(2 * speed / (7 * MU * GRAVITY))
    assert known.velocity == pytest.approx([5 * speed / 7, 0.0])
    assert rolling(VELOCITY, (0.0, -130.0, 0.0)).velocity[0] < 0  # it comes back


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("spin", SIDEWAYS.values(), ids=SIDEWAYS)
def test_in_a_plane_velocities_are_exact(scheme, spin):
    known, u = rolling(spin=spin), slip(spin=spin)
    trajectory = run(scheme, spin=spin)
    sliding = trajectory.t < known.t - 1e-3
    exact = np.array(VELOCITY[:2]) - MU * GRAVITY * np.outer(trajectory.t[sliding], u / np.linalg.norm(u))
    np.testing.assert_allclose(trajectory.v[sliding, :2], exact, atol=1e-12)
    rolls = trajectory.t > known.t + 1e-3
    np.testing.assert_allclose(trajectory.v[rolls, :2], np.tile(known.velocity, (rolls.sum(), 1)), atol=1e-12)
    omega = in_space(trajectory)[rolls]
    np.testing.assert_allclose(RADIUS * omega[:, :2], trajectory.v[rolls, 1::-1] * [-1, 1], atol=1e-12)


@pytest.mark.parametrize(
    ("scheme", "order"), [(SCHEME, 2), ("HalfExplicitRungeKuttaOSI", 3), ("MoreauJeanOSI", 1)]
)
def test_with_english_angular_momentum_tells_the_end(scheme, order):
    known, errors = rolling(), []
    for time_step in (1e-3, 5e-4):
        trajectory = run(scheme, time_step)
        errors.append(np.abs(trajectory.v[-1, :2] - known.velocity).max())
        place = known.place + (1.0 - known.t) * known.velocity
        assert trajectory.q[-1, :2] == pytest.approx(place, abs=0.6 * errors[-1] + 1e-5)
    assert log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.1)


def test_friction_has_no_moment_about_the_normal():
    trajectory = run("HalfExplicitRungeKuttaOSI(tableau=HEM5)")
    np.testing.assert_allclose(in_space(trajectory)[:, 2], SPIN[2], atol=2e-5)
    force = trajectory["plane"].force[trajectory.t > rolling().t + 2e-3]
    np.testing.assert_allclose(force, np.tile([MASS * GRAVITY, 0.0, 0.0], (len(force), 1)), atol=1e-9)


@pytest.mark.parametrize("scheme", ["HalfExplicitTrapezoidalOSI", "HalfExplicitRungeKuttaOSI"])
@pytest.mark.parametrize("factor", [0.2, 0.99, 1.01, 3.0], ids=str)
def test_an_oblique_impact_sticks_or_slides(scheme, factor):
    restitution, time_step = 0.5, 1e-6
    speed = 3.5 * MU * (1 + restitution) * 2.0 * factor  # (2/7) |u_T| over μ (1 + ε) |v_N|
    direction = np.array([0.6, 0.8])
    spin = (5.0, -7.0, 30.0)
    velocity = [*(speed * direction - slip((0.0, 0.0, 0.0), spin)), -2.0]
    trajectory = run(
        scheme,
        time_step,
        until=2 * time_step,
        velocity=velocity,
        spin=spin,
        height=1e-6,
        restitution=restitution,
    )
    [hit] = np.flatnonzero(trajectory.impulsive)
    before = [*velocity[:2], -2.0 - GRAVITY * trajectory.t[hit]]
    assert trajectory.v[hit, :3] == pytest.approx(after_impact(before, spin, restitution, MU), abs=1e-8)
    u = slip(trajectory.v[hit, :3], in_space(trajectory)[hit])
    assert (np.linalg.norm(u) < 1e-10) == (factor < 1)
    normal, *tangential = trajectory["plane"].impulse[hit]
    assert normal == pytest.approx(MASS * (1 + restitution) * -before[2], rel=1e-12)
    assert np.hypot(*tangential) == pytest.approx(MU * normal * min(1, factor), rel=1e-4)


def test_the_system():
    assert build().check().ok
