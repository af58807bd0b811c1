"""The rotor's model: the axle against beam theory and against itself, welds, bearing and contact."""

from dataclasses import replace

import numpy as np
import pytest
import saltus.kernel as sk
from saltus._core import CompiledAxle, CompiledJournalContact, CompiledMountedBody
from saltus.examples.rotor import generate_element
from saltus.examples.rotor.rotor import CONTACT, Parameters, build

P = Parameters()
FREE = replace(P, drive_torque=0.0, fault_torque=0.0)
BARE = replace(FREE, mount_stiffness=0.0, mount_damping=0.0, gravity=0.0)
AREA = np.pi * P.radius**2
BENDING = P.E * AREA * P.radius**2 / 4  # EI_b [N m²]


def some_state():
    """Turning and bent, with slopes of some hundredths: no term vanishes."""
    random = np.random.default_rng(1)
    q = random.normal(size=30) * np.tile([1e-2, 1e-3, 1e-2, 1e-3, 1e-2], 6)
    q[::5] += 2.0
    return q, random.normal(size=30) * np.tile([100.0, 1.0, 5.0, 1.0, 5.0], 6)


def axle_alone(parameters, q=None, v=None):
    zero = np.zeros(30)
    return CompiledAxle(zero if q is None else q, zero if v is None else v, parameters.axle)


def matrices(parameters):
    """M and K of the axle at rest."""
    axle = axle_alone(parameters)
    at = sk.Configuration(sk.NonSmoothDynamicalSystem([axle]))
    M = np.linalg.inv(np.column_stack([at.solve_mass(unit) for unit in np.eye(30)]))
    return M, -axle.force_jacobians(0.0, np.zeros(30), np.zeros(30))[0]


def forces(parameters, q, v):
    system = sk.NonSmoothDynamicalSystem([axle_alone(parameters, q, v)])
    return sk.Configuration(system).forces(0.0, v)


def test_the_element_is_what_the_derivation_gives():
    assert generate_element.TARGET.read_text() == generate_element.source()


def test_mass_forces_potential_and_jacobians_belong_together():
    report = build(FREE, *some_state()).check()
    assert all(item.deviation <= item.tolerance for item in report.items), report


def test_check_finds_nothing_at_the_start():
    assert build().check().ok


def test_force_jacobians_are_those_of_the_forces():
    q, v = some_state()
    by_q, by_v = axle_alone(P).force_jacobians(0.0, q, v)
    for k, unit in enumerate(np.eye(30)):
        along_q = (forces(P, q + 1e-6 * unit, v) - forces(P, q - 1e-6 * unit, v)) / 2e-6
        along_v = (forces(P, q, v + 1e-3 * unit) - forces(P, q, v - 1e-3 * unit)) / 2e-3
        np.testing.assert_allclose(by_q[:, k], along_q, rtol=0, atol=1e-11 * np.abs(by_q).max())
        np.testing.assert_allclose(by_v[:, k], along_v, rtol=0, atol=1e-8 * np.abs(by_v).max())


def test_cantilever_bends_as_beam_theory_says():
    _, K = matrices(BARE)
    held = slice(5, None)  # the first node is clamped
    load = np.zeros(25)
    load[[21, 23]] = 100.0, -50.0  # N, on w and u of the free end
    q = np.linalg.solve(K[held, held], load)
    deflection = P.length**3 / (3 * BENDING)
    np.testing.assert_allclose(q[[21, 23]], load[[21, 23]] * deflection, rtol=1e-9)
    np.testing.assert_allclose(q[[22, 24]], load[[21, 23]] * P.length**2 / (2 * BENDING), rtol=1e-9)


def test_frequencies_are_those_of_beam_theory():
    M, K = matrices(BARE)
    squares = np.linalg.eigvals(np.linalg.solve(M[5:, 5:], K[5:, 5:]))
    omega = np.sqrt(np.sort(squares.real))
    wave = np.sqrt(BENDING / (P.density * AREA)) / P.length**2
    twice = np.repeat([1.8751041, 4.6940911], 2) ** 2 * wave  # in both planes
    finite = 1 + (np.repeat([1.8751041, 4.6940911], 2) / P.elements) ** 4 / 1440  # of cubic elements
    np.testing.assert_allclose(omega[:4], twice, rtol=5e-3)
    np.testing.assert_allclose(omega[:4], twice * finite, rtol=1e-4)
    torsion = np.pi / (2 * P.length) * np.sqrt(P.G / P.density)
    assert np.abs(omega / torsion - 1).min() < 5e-3


def test_the_same_motion_in_a_frame_that_is_turned_has_the_same_energies():
    (q, v), turn = some_state(), 0.7
    c, s = np.cos(turn), np.sin(turn)
    turned_q, turned_v = q.copy(), v.copy()
    turned_q[::5] += turn
    for x, turned in ((q, turned_q), (v, turned_v)):
        for first, second in ((1, 3), (2, 4)):  # deflections, slopes
            turned[first::5] = c * x[first::5] + s * x[second::5]
            turned[second::5] = -s * x[first::5] + c * x[second::5]

    def energies(at, velocity):
        trajectory = sk.TimeStepping(
            sk.NonSmoothDynamicalSystem([axle_alone(FREE, at, velocity)]),
            "HalfExplicitTrapezoidalOSI",
            1e-6,
        ).trajectory
        return trajectory.kinetic_energy[0], trajectory.potential_energy[0]

    np.testing.assert_allclose(energies(turned_q, turned_v), energies(q, v), rtol=1e-12)


def test_damping_takes_what_it_is_meant_to():
    q, v = some_state()
    p = replace(FREE, mount_damping=10.0)
    power = 0.5 * (forces(p, q, v) - forces(p, q, -v)) @ v
    at = sk.Configuration(sk.NonSmoothDynamicalSystem([axle_alone(p, q, v)]))
    twist = np.diff(v[::5])
    end, rate = q[25:], v[25:]
    speed = np.array([rate[1] - rate[0] * end[3], rate[3] + rate[0] * end[1]])
    expected = 2 * p.mass_damping * at.kinetic_energy(v) + p.torsional_damping * twist @ twist
    assert power == pytest.approx(-expected - p.mount_damping * speed @ speed, rel=1e-9)


def test_torques_do_work_on_the_angles_of_the_end():
    q, v = some_state()
    end, rate = q[25:], v[25:]
    power = (forces(P, q, v) - forces(FREE, q, v)) @ v
    about_z = np.cos(end[0]) * rate[2] - np.sin(end[0]) * rate[4]
    assert power == pytest.approx(P.drive_torque * rate[0] - P.fault_torque * about_z, rel=1e-9)
    late = axle_alone(P, q, v), axle_alone(FREE, q, v)
    left = [sk.Configuration(sk.NonSmoothDynamicalSystem([a])).forces(P.drive_until, v) for a in late]
    assert (left[0] - left[1]) @ v == pytest.approx(-P.fault_torque * about_z, rel=1e-9)


def test_the_journal_measures_the_way_to_the_ring():
    q0, v0 = np.zeros(30), np.zeros(30)
    q0[[1, 6]] = 5e-5  # the first element moves sideways as a whole, and turns
    v0[[0, 5]] = 200.0
    start = sk.TimeStepping(build(FREE, q0, v0), "HalfExplicitTrapezoidalOSI", 1e-6).trajectory[CONTACT]
    assert start.gap[0, 0] == pytest.approx(P.clearance - 5e-5, rel=1e-12)
    surface = P.frustum_radius + 5e-5  # the centre moves as well
    np.testing.assert_allclose(np.linalg.norm(start.velocity[0, 1:]), 200.0 * surface, rtol=1e-12)
    assert abs(start.velocity[0, 0]) < 1e-12


def test_the_bearing_swings_on_its_mount():
    p = replace(P, bearing_damping=0.0, gravity=0.0)
    turned = [np.cos(0.2), 0.0, np.sin(0.2), 0.0]
    bearing = CompiledMountedBody(
        [1e-3, 0, 0, *turned],
        np.zeros(6),
        mass=p.bearing_mass,
        inertia=p.bearing_inertia,
        stiffness=p.bearing_stiffness,
        damping=0.0,
        gravity=0.0,
    )
    system = sk.NonSmoothDynamicalSystem([bearing])
    run = sk.TimeStepping(system, "HalfExplicitTrapezoidalOSI", 1e-7).run(1e-4)
    slow = np.sqrt(p.bearing_stiffness / p.bearing_mass)
    fast = np.sqrt(p.bearing_stiffness / p.bearing_inertia[1])
    np.testing.assert_allclose(run.q[:, 0], 1e-3 * np.cos(slow * run.t), rtol=0, atol=1e-9)
    angle = 2 * np.arctan2(run.q[:, 5], run.q[:, 3])
    np.testing.assert_allclose(angle, 0.4 * np.cos(fast * run.t), rtol=0, atol=1e-4)
    np.testing.assert_allclose(run.energy, run.energy[0], rtol=1e-4)


def test_what_is_wrong_is_refused():
    with pytest.raises(ValueError, match="elements must be at least 1, got 0"):
        build(replace(P, elements=0))
    with pytest.raises(ValueError, match="has 30 freedoms, got 25"):
        build(P, np.zeros(25), np.zeros(25))
    with pytest.raises(ValueError, match="from 0 to its length, got 0.6"):
        build(replace(P, flywheel_at=0.6))
    with pytest.raises(ValueError, match="a disc of positive radius must fit into the circle"):
        CompiledJournalContact(3, disc=1.1e-2, circle=1e-2, along=0.0)
    with pytest.raises(ValueError, match="stiffness must be finite and not negative, got -1"):
        build(replace(P, bearing_stiffness=-1.0))
