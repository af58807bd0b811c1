"""Discs with contacts of discs: three of them against statics, a pile that comes to rest."""

from math import cos, sin, tan

import numpy as np
import pytest
import saltus.kernel as sk
from saltus.examples.disc_pile.disc_pile import (
    GRAVITY,
    RADIUS,
    SCHEME,
    TIME_STEP,
    angle,
    build,
    carried,
    forces_of_three,
    mass_of,
    radii_of,
    three_discs,
)

SCHEMES = [SCHEME, "MoreauJeanOSI"]


def last(trajectory, name):
    """Normal and tangential force of the last step [N]."""
    contact = trajectory[name]
    return contact.force[-1] + contact.impulse[-1] / trajectory.provenance.time_step


def test_forces_of_three_discs_are_in_equilibrium():
    for apart in (0.0, 0.02, 0.06):
        a, forces = angle(apart), forces_of_three(apart)
        (normal, friction), (floor, sideways) = forces["top"], forces["floor"]
        weight = mass_of(RADIUS) * GRAVITY
        assert 2 * (normal * cos(a) + friction * sin(a)) == pytest.approx(weight, rel=1e-14)  # the top one
        assert floor == pytest.approx(weight + normal * cos(a) + friction * sin(a), rel=1e-14)
        assert normal * sin(a) == pytest.approx(friction * cos(a) + sideways, rel=1e-13)
        assert friction == sideways  # moments


@pytest.mark.parametrize("scheme", [*SCHEMES, "HalfExplicitTrapezoidalOSI"])
@pytest.mark.parametrize("apart", [1e-3, 0.02, 0.05])
def test_three_discs_carry_what_statics_says(scheme, apart):
    trajectory = sk.TimeStepping(three_discs(apart, mu=0.6), scheme, TIME_STEP).run(0.2)
    known = forces_of_three(apart)
    for name in ("2 on 0", "2 on 1", "0 on floor", "1 on floor"):
        normal, friction = known["floor" if "floor" in name else "top"]
        found = last(trajectory, name)
        assert found[0] == pytest.approx(normal, rel=2e-5)
        assert abs(found[1]) == pytest.approx(friction, rel=2e-5)
    assert last(trajectory, "0 on floor")[1] > 0 > last(trajectory, "1 on floor")[1]  # the floor holds them
    assert not np.any(last(trajectory, "1 on 0"))
    np.testing.assert_allclose(trajectory.v[-1], 0.0, atol=1e-10)
    np.testing.assert_allclose(trajectory.q[-1], trajectory.q[0], atol=1e-4)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize(("factor", "stands"), [(0.99, False), (1.01, True)])
def test_three_discs_stand_with_enough_friction(scheme, factor, stands):
    mu = factor * tan(angle(1e-3) / 2)
    trajectory = sk.TimeStepping(three_discs(1e-3, mu), scheme, TIME_STEP).run(0.5)
    sunk = trajectory.q[0, 7] - trajectory.q[-1, 7]
    assert (sunk < 1e-4) == stands
    assert (sunk > 2e-3) == (not stands)
    assert trajectory.q[:, 0] == pytest.approx(-trajectory.q[:, 3], abs=1e-6)  # symmetric as they fall


def test_without_friction_they_part_at_once():
    step = 1e-5
    trajectory = sk.TimeStepping(three_discs(1e-3, mu=0.0), SCHEME, step).run(10 * step)
    a = angle(1e-3)
    outwards = GRAVITY / (tan(a) + 2 / tan(a))
    assert trajectory.v[-1, 3] == pytest.approx(outwards * 10 * step, rel=1e-3)
    assert trajectory.v[-1, 7] == pytest.approx(-outwards * tan(a) * 10 * step, rel=1e-3)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_pile_comes_to_rest_and_carries_itself(scheme):
    radii = radii_of(4)
    trajectory = sk.TimeStepping(build(4), scheme, TIME_STEP).run(1.6)
    weight = GRAVITY * sum(mass_of(radius) for radius in radii)
    assert np.abs(trajectory.v[-1]).max() < 1e-10
    assert carried(trajectory) == pytest.approx((0.0, weight), abs=1e-7)
    assert trajectory.penetration.max() < 2e-3
    for k, residual in enumerate(unbalanced(trajectory, radii)):
        np.testing.assert_allclose(residual, 0.0, atol=1e-7, err_msg=f"disc {k}")


def unbalanced(trajectory, radii):
    """Forces and moment on every disc in the last step (n, 3) [N, N m], from the places of the discs."""
    centres = trajectory.q[-1].reshape(-1, 3)[:, :2]
    normals = {"floor": (0.0, 1.0), "left": (1.0, 0.0), "right": (-1.0, 0.0)}
    total = np.array([[0.0, -GRAVITY * mass_of(radius), 0.0] for radius in radii])
    for name in trajectory.contacts:
        first, _, second = name.split()
        i, (normal, tangential) = int(first), last(trajectory, name)
        j = None if second in normals else int(second)
        n = normals[second] if j is None else centres[i] - centres[j]
        n = np.asarray(n) / np.linalg.norm(n)
        t = np.array([n[1], -n[0]])
        force = normal * n + tangential * t
        total[i] += [*force, radii[i] * tangential]  # −R n × t = R
        if j is not None:
            total[j] += [*-force, radii[j] * tangential]
    return total


@pytest.mark.parametrize("system", [three_discs(), build(2)], ids=["three", "pile"])
def test_the_systems(system):
    assert system.check().ok
