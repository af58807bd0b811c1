"""Rigid bodies, velocity maps and geometry that moves, from Python; each against what is exact."""

from __future__ import annotations

import numpy as np
import pytest
import saltus.io
import saltus.kernel as sk

GRAVITY = 9.81
UNIT = [1.0, 0.0, 0.0, 0.0]
SCHEMES = [
    "HalfExplicitTrapezoidalOSI",
    "HalfExplicitRungeKuttaOSI",
    "MoreauJeanOSI",
    "ExplicitMoreauJeanOSI",
]


class Bead(sk.LagrangianDS):
    """A bead on a circle of radius R: q is the angle, v the speed along the circle."""

    RADIUS = 0.5

    def mass(self, q, out):
        out[0, 0] = 1.0

    def forces(self, t, q, v, out):
        out[0] = -GRAVITY * np.sin(q[0])

    def velocity_map(self, q, out):
        out[0, 0] = 1.0 / self.RADIUS

    def potential_energy(self, q):
        return -GRAVITY * self.RADIUS * np.cos(q[0])


class Pendulum(sk.LagrangianDS):
    """The same with the angular velocity as v."""

    def mass(self, q, out):
        out[0, 0] = Bead.RADIUS**2

    def forces(self, t, q, v, out):
        out[0] = -GRAVITY * Bead.RADIUS * np.sin(q[0])


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_velocity_of_ones_own_gives_the_same_motion(scheme):
    runs = [
        sk.TimeStepping(sk.NonSmoothDynamicalSystem([ds]), scheme, 1e-3).run(1.0)
        for ds in (Bead([1.0], [0.5 * Bead.RADIUS]), Pendulum([1.0], [0.5]))
    ]
    assert np.abs(runs[0].q - runs[1].q).max() < 1e-11
    assert np.abs(runs[0].v / Bead.RADIUS - runs[1].v).max() < 1e-11


class OnCircle(sk.LagrangianDS):
    """The bead with q = (x, y) on the unit circle: two coordinates, one freedom."""

    def mass(self, q, out):
        out[0, 0] = 1.0

    def forces(self, t, q, v, out):
        out[0] = -GRAVITY * q[0]  # along the tangent (−y, x), of a weight along −y

    def velocity_map(self, q, out):
        out[:, 0] = -q[1], q[0]

    def normalise(self, q, out):
        out[:] = q / np.hypot(*q)


def test_more_coordinates_than_freedoms():
    start = np.array([np.sin(1.0), -np.cos(1.0)])  # angle 1 from the lowest point
    system = sk.NonSmoothDynamicalSystem([OnCircle(start, [0.0])])
    assert (system.coordinates, system.dimension) == (2, 1)
    assert system.check().ok
    trajectory = sk.TimeStepping(system, sk.HalfExplicitRungeKuttaOSI(tableau="RK4"), 1e-3).run(2.0)
    assert trajectory.q.shape[1] == 2
    assert trajectory.v.shape[1] == 1
    assert np.abs(np.hypot(*trajectory.q.T) - 1.0).max() < 1e-15
    energy = 0.5 * trajectory.v[:, 0] ** 2 + GRAVITY * trajectory.q[:, 1]
    assert np.abs(energy - energy[0]).max() < 1e-9


def test_a_relation_on_more_coordinates_than_freedoms(tmp_path):
    class Wall(sk.LagrangianScleronomousR):  # x >= 0
        def gap(self, q, out):
            out[0] = q[0]

        def jacobian(self, q, out):
            out[0, 0] = -q[1]

    system = sk.NonSmoothDynamicalSystem([ds := OnCircle([np.sin(1.0), -np.cos(1.0)], [0.0])])
    system.link(sk.Interaction(Wall(1), sk.NewtonImpactNSL(0.5), name="wall"), ds)
    assert system.check().ok
    trajectory = sk.TimeStepping(system, sk.HalfExplicitTrapezoidalOSI(), 1e-4).run(1.0)
    hit = np.flatnonzero(trajectory.impulsive)[0]
    speed = np.sqrt(2 * GRAVITY * (1 - np.cos(1.0)))
    assert trajectory.v[hit - 1, 0] == pytest.approx(-speed, rel=1e-3)
    assert trajectory.v[hit, 0] == pytest.approx(0.5 * speed, rel=1e-3)
    lines = trajectory.to_csv(tmp_path / "run.csv").read_text().splitlines()
    assert lines[0].startswith("t [s],step [1],q0 [m or rad],q1 [m or rad],v0 [m/s or rad/s],")
    assert len(lines) == len(trajectory.t) + 1
    again = saltus.io.read_hdf5(trajectory.to_hdf5(tmp_path / "run.h5"))
    assert np.array_equal(again.q, trajectory.q)
    assert np.array_equal(again.v, trajectory.v)


def test_q_and_v_must_have_the_same_size_without_a_map():
    with pytest.raises(ValueError, match="v0 must have 2 entries as q0 has, unless .* velocity_map, got 1"):
        sk.NonSmoothDynamicalSystem([Pendulum([1.0, 0.0], [0.0])])


class Gyroscope(sk.NewtonEulerDS):
    """A motor turns it about its own z axis."""

    def body_moment(self, t, q, v, out):
        out[2] = 0.3 * t


def test_loads_of_a_python_class():
    ds = Gyroscope([0, 0, 0, *UNIT], [0, 0, 0, 0, 0, 1.0], 2.0, [0.1, 0.1, 0.2], force=[0, 0, -2 * GRAVITY])
    trajectory = sk.TimeStepping(sk.NonSmoothDynamicalSystem([ds]), "MoreauJeanOSI", 1e-2).run(1.0)
    assert trajectory.v[-1, 5] == pytest.approx(1.0 + 0.3 / 0.2 / 2, rel=1e-12)
    assert trajectory.q[-1, 2] == pytest.approx(-GRAVITY / 2, rel=1e-12)
    ds = Gyroscope([0, 0, 0, *UNIT], np.zeros(6), 2.0, [0.1, 0.1, 0.2], body_moment=[0, 0, 1])
    system = sk.NonSmoothDynamicalSystem([ds])
    with pytest.raises(ValueError, match="body_moment"):
        sk.TimeStepping(system, "MoreauJeanOSI", 1e-2)


def test_bad_bodies_are_refused():
    for arguments, message in [
        (([0, 0, 0, 1, 0, 0], np.zeros(6), 1.0, np.ones(3)), "7 entries"),
        (([0, 0, 0, 1, 1, 0, 0], np.zeros(6), 1.0, np.ones(3)), "length 1, got 1.414"),
        (([0, 0, 0, *UNIT], np.zeros(7), 1.0, np.ones(3)), "6 entries"),
        (([0, 0, 0, *UNIT], np.zeros(6), 0.0, np.ones(3)), "mass must be positive"),
        (([0, 0, 0, *UNIT], np.zeros(6), 1.0, [1, 1, -1]), "inertia"),
        (([0, 0, 0, *UNIT], np.zeros(6), 1.0, np.ones((2, 2))), r"inertia must be \(3, 3\)"),
    ]:
        with pytest.raises(ValueError, match=message):
            sk.NewtonEulerDS(*arguments)
    ds = sk.NewtonEulerDS([0, 0, 0, *UNIT], np.zeros(6), 1.0, np.ones(3))
    system = sk.NonSmoothDynamicalSystem([ds])
    line = sk.Interaction(sk.LagrangianLinearTIR([[1, 0, 0, 0, 0, 0]]), sk.NewtonImpactNSL(0.0))
    with pytest.raises(ValueError, match="as many coordinates as freedoms"):
        system.link(line, ds)


# ---- Geometry that moves


def ball(z: float = 0.0, v: float = 0.0) -> sk.LagrangianLinearTIDS:
    return sk.LagrangianLinearTIDS([z], [v], [[2.0]], external_force=[-2.0 * GRAVITY])


OMEGA, AMPLITUDE = 8.0, 0.05


def shake(t: float) -> tuple[float, float, float]:
    s, c = np.sin(OMEGA * t), np.cos(OMEGA * t)
    return AMPLITUDE * s, AMPLITUDE * OMEGA * c, -AMPLITUDE * OMEGA**2 * s


class ShakenFloor(sk.LagrangianRheonomousR):
    """g = z − p(t)."""

    def gap(self, t, q, out):
        out[0] = q[0] - shake(t)[0]

    def jacobian(self, t, q, out):
        out[0, 0] = 1.0

    def motion(self, t, q, out):
        out[0] = -shake(t)[1]

    def curvature(self, t, q, v, out):
        out[0] = -shake(t)[2]


@pytest.mark.parametrize("relation", [ShakenFloor(1), sk.Driven(sk.LagrangianLinearTIR([[1.0]]), shake)])
@pytest.mark.parametrize(
    ("law", "scheme"),
    [
        (sk.NewtonImpactNSL(0.0), "HalfExplicitTrapezoidalOSI"),
        (sk.EqualityConditionNSL(1), "HalfExplicitTrapezoidalOSI"),
        (sk.EqualityConditionNSL(1), "DMinusAccelerationOSI"),  # a lasting contact sinks
    ],
)
def test_a_ball_rides_on_a_shaken_floor(relation, law, scheme):
    """Its force is m (g + p̈), of second order, and that of the driver does all the work."""
    errors = []
    for dt in (2e-3, 1e-3):
        system = sk.NonSmoothDynamicalSystem([ds := ball(0.0, AMPLITUDE * OMEGA)])
        if not law.bilateral:  # a little sunken, so that rounding opens nothing
            system = sk.NonSmoothDynamicalSystem([ds := ball(-1e-4, AMPLITUDE * OMEGA)])
        system.link(sk.Interaction(relation, law, name="floor"), ds)
        assert system.check().ok
        run = sk.TimeStepping(system, scheme, dt).run(0.5)
        middle = run.t[1:] - dt / 2
        exact = 2.0 * (GRAVITY - AMPLITUDE * OMEGA**2 * np.sin(OMEGA * middle))
        errors.append(np.abs(run["floor"].force[1:, 0] - exact).max())
        assert np.abs(run.q[:, 0] - run.q[0, 0] - AMPLITUDE * np.sin(OMEGA * run.t)).max() < 10 * dt**2
        work = np.cumsum(run.work_lambda + run.work_impulse)
        energy = run.kinetic_energy + run.potential_energy
        assert np.abs(energy - energy[0] - work).max() < 20 * dt**2
    assert errors[1] < 0.3 * errors[0]


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_wall_that_comes_throws_a_ball_back(scheme):
    """v⁺ − p = −ε (v⁻ − p) for a wall of speed p."""
    speed, restitution = 3.0, 0.6
    ds = sk.LagrangianLinearTIDS([1.0], [-2.0], [[2.0]])
    system = sk.NonSmoothDynamicalSystem([ds])
    wall = sk.Driven(sk.LagrangianLinearTIR([[1.0]]), lambda t: (speed * t, speed, 0.0))
    system.link(sk.Interaction(wall, sk.NewtonImpactNSL(restitution), name="wall"), ds)
    run = sk.TimeStepping(system, scheme, 1e-3).run(0.4)
    assert run.v[-1, 0] == pytest.approx(speed + restitution * (2.0 + speed), rel=1e-13)
    assert run.work_impulse.sum() == pytest.approx(0.5 * 2.0 * (run.v[-1, 0] ** 2 - 4.0), rel=1e-12)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_block_on_a_belt_reaches_its_speed(scheme):
    """It slides for v/(μ g), then rides."""

    class Belt(sk.LagrangianRheonomousR):
        def gap(self, t, q, out):
            out[0] = q[1]

        def jacobian(self, t, q, out):
            out[0, 1] = out[1, 0] = 1.0

        def motion(self, t, q, out):
            out[1] = -0.5

    mu = 0.2
    ds = sk.LagrangianLinearTIDS(
        [0.0, -1e-4], [0.0, 0.0], 3.0 * np.eye(2), external_force=[0, -3.0 * GRAVITY]
    )
    system = sk.NonSmoothDynamicalSystem([ds])
    system.link(sk.Interaction(Belt(2), sk.NewtonImpactFrictionNSL(0, 0, mu, 2), name="belt"), ds)
    run = sk.TimeStepping(system, scheme, 1e-3).run(0.5)
    exact = np.minimum(mu * GRAVITY * run.t, 0.5)
    assert np.abs(run.v[:, 0] - exact).max() < 2.1e-3
    assert run.v[-1, 0] == pytest.approx(0.5, abs=1e-12)


def test_a_sphere_on_a_rising_floor_of_its_own_geometry():
    floor = sk.Driven(
        sk.SpherePlane(3, radius=0.1, point=[0, 0, 0], normal=[0, 0, 1]), lambda t: (t * t / 2, t, 1.0)
    )
    ds = sk.NewtonEulerDS([0, 0, 0.0999, *UNIT], np.zeros(6), 2.0, [1, 1, 1], force=[0, 0, -2 * GRAVITY])
    system = sk.NonSmoothDynamicalSystem([ds])
    system.link(sk.Interaction(floor, sk.NewtonImpactFrictionNSL(0, 0, 0.3, 3), name="floor"), ds)
    run = sk.TimeStepping(system, "HalfExplicitTrapezoidalOSI", 1e-3).run(0.5)
    assert run["floor"].force[1:, 0] == pytest.approx(2.0 * (GRAVITY + 1.0), rel=1e-10)


def turn(axis: int, angle: float) -> np.ndarray:
    p = np.zeros(4)
    p[0], p[1 + axis] = np.cos(angle / 2), np.sin(angle / 2)
    return p


def slide_over_a_face(axis: int, angle: float, box: bool) -> sk.NonSmoothDynamicalSystem:
    """A ball that is pressed on a face of a body which turns, with its normal along an axis of the body."""
    p, normal, radius, spin = turn(1, angle), np.eye(3)[axis], 0.05, np.array([0.1, 0.9, 0.2])
    R = sk.rotation_matrix(p)
    x = (radius + 0.5) * R @ normal
    slip = np.cross(R @ normal, [0.3, 0.5, 0.7])
    v = np.cross(R @ spin, x) + slip
    body = sk.NewtonEulerDS([0, 0, 0, *p], [0, 0, 0, *spin], 20.0, [0.5, 0.6, 0.7])
    ball = sk.NewtonEulerDS([*x, *UNIT], [*v, 5, 1, -4], 0.5, [5e-4] * 3, force=-10 * R @ normal)
    relation = (
        sk.SphereBox(3, radius=radius, half_lengths=[0.5, 0.5, 0.5])
        if box
        else sk.SpherePlane(3, radius=radius, point=0.5 * normal, normal=normal)
    )
    system = sk.NonSmoothDynamicalSystem([ball, body])
    system.link(sk.Interaction(relation, sk.NewtonImpactFrictionNSL(0, 0, 0.02, 3)), ball, body)
    return system


def slide_over_a_sphere(view: np.ndarray) -> sk.NonSmoothDynamicalSystem:
    class Attracted(sk.NewtonEulerDS):
        def force(self, t, q, v, out):
            out[:] = -10 * q[:3]

    x, v, spin = view @ [1.2, 0, 0], view @ [0, 0.3, 1.0], view @ [0, -20.0, 8.0]
    ball = Attracted([*x, *UNIT], [*v, *spin], 1.0, [0.016] * 3)
    system = sk.NonSmoothDynamicalSystem([ball])
    contact = sk.SphereSphere(3, radius1=0.2, radius2=1.0)
    system.link(sk.Interaction(contact, sk.NewtonImpactFrictionNSL(0, 0, 0.1, 3)), ball)
    return system


@pytest.mark.parametrize("box", [False, True])
def test_sliding_keeps_its_order_where_a_face_stands_upright(box):
    """The normal passes through horizontal after 0.11 s: tangents that jump there make it order one."""

    def end(dt):
        run = sk.TimeStepping(
            slide_over_a_face(0, -0.1, box), "HalfExplicitRungeKuttaOSI(activity=sticky)", time_step=dt
        ).run(until=0.2)
        return np.hstack([run.q[-1], run.v[-1]])

    coarse, middle, fine = end(4e-3), end(2e-3), end(1e-3)
    ratio = np.abs(coarse - middle).max() / np.abs(middle - fine).max()
    assert np.log2(ratio) > 2.7
    assert np.abs(coarse - middle).max() < 1e-4  # a jump where a step happens to notice: 0.1


@pytest.mark.parametrize("scheme", ["HalfExplicitTrapezoidalOSI(activity=sticky)", "MoreauJeanOSI"])
def test_sliding_over_a_sphere_is_the_same_from_every_side(scheme):
    """In one of the frames the normal passes through horizontal."""
    ends = []
    for p in turn(1, 0.3), turn(0, 1.0):
        view = sk.rotation_matrix(p)
        run = sk.TimeStepping(slide_over_a_sphere(view), scheme, time_step=1e-3).run(until=0.6)
        ends.append(view.T @ run.q[-1][:3])
    assert ends[0] == pytest.approx(ends[1], abs=1e-12)


def test_a_line_in_the_plane_has_a_normal_in_the_plane():
    disc = sk.LagrangianLinearTIDS(np.zeros(3), np.zeros(3), np.eye(3))
    system = sk.NonSmoothDynamicalSystem([disc])
    floor = sk.SpherePlane(2, radius=0.1, point=[0, 0, 0], normal=[0, 0, 2])
    with pytest.raises(ValueError, match="normal of a line in the plane must have z = 0, got 1 at length 1"):
        system.link(sk.Interaction(floor, sk.NewtonImpactFrictionNSL(0.0, 0.0, 0.3, 2)), disc)


def test_bad_motions_are_refused():
    line = sk.LagrangianLinearTIR([[1.0]])
    with pytest.raises(ValueError, match="does not depend on the time"):
        sk.Driven(ShakenFloor(1), shake)
    system = sk.NonSmoothDynamicalSystem([ds := ball()])
    system.link(sk.Interaction(sk.Driven(line, lambda t: t), sk.EqualityConditionNSL(1)), ds)
    with pytest.raises(TypeError, match=r"three numbers .*, got 0.0"):
        sk.TimeStepping(system, "MoreauJeanOSI", 1e-3)

    class NoMotion(sk.LagrangianRheonomousR):
        def gap(self, t, q, out):
            out[0] = q[0]

        def jacobian(self, t, q, out):
            out[0, 0] = 1.0

    system = sk.NonSmoothDynamicalSystem([ds := ball()])
    system.link(sk.Interaction(NoMotion(1), sk.EqualityConditionNSL(1), name="rod"), ds)
    with pytest.raises(NotImplementedError, match=r"NoMotion must define motion\(self, t, q, out\)"):
        sk.TimeStepping(system, "MoreauJeanOSI", 1e-3).step()
    with pytest.raises(ValueError, match="needs the curvature of every relation, 'rod'"):
        sk.TimeStepping(system, "DMinusAccelerationOSI", 1e-3)


def test_parts_of_an_integrator_ask_for_the_time():
    system = sk.NonSmoothDynamicalSystem([ds := ball(1.0)])
    system.link(
        sk.Interaction(sk.Driven(sk.LagrangianLinearTIR([[1.0]]), shake), sk.NewtonImpactNSL(0.0)), ds
    )
    place = sk.Configuration(system)
    with pytest.raises(ValueError, match="move_to needs the time"):
        place.move_to([1.0])
    place.move_to([1.0], 0.1)
    assert place.gaps[0] == pytest.approx(1.0 - shake(0.1)[0], rel=1e-15)
    assert place.velocities([0.0])[0] == pytest.approx(-shake(0.1)[1], rel=1e-15)
    spinning = sk.NewtonEulerDS([0, 0, 0, *UNIT], [1, 2, 3, 2, 4, 6], 1.0, np.ones(3))
    place = sk.Configuration(sk.NonSmoothDynamicalSystem([spinning]))
    assert place.rates([1, 2, 3, 2, 4, 6]) == pytest.approx([1, 2, 3, 0, 1, 2, 3])


def test_a_joint_of_other_bodies_is_refused():
    a, b = (sk.NewtonEulerDS([x, 0, 1, *UNIT], np.zeros(6), 1.0, np.ones(3)) for x in (0.0, 1.0))
    system = sk.NonSmoothDynamicalSystem([a, b])
    between = sk.Joint.ball(a, b, at=[0, 0, 1])
    held = sk.Interaction(between, sk.EqualityConditionNSL(3))
    for bodies in ((b, a), (a,)):
        with pytest.raises(ValueError, match="linked to the bodies that it was made for, in the same order"):
            system.link(held, *bodies)
    system.link(held, a, b)


def test_methods_that_nothing_asks_for_are_refused():
    class Weight(sk.NewtonEulerDS):
        def forces(self, t, q, v, out):  # of LagrangianDS; here it is force
            out[2] = -GRAVITY

    body = Weight([0, 0, 0, *UNIT], np.zeros(6), 1.0, np.ones(3))
    system = sk.NonSmoothDynamicalSystem([body])
    with pytest.raises(ValueError, match="Weight.forces is not asked for: loads of a rigid body are force, "):
        sk.TimeStepping(system, "HalfExplicitTrapezoidalOSI", 1e-3)

    class Round(Pendulum):
        def normalise(self, q, out):
            out[0] = q[0] % 1.0

    with pytest.raises(ValueError, match=r"Round.normalise is asked for only beside velocity_map"):
        sk.NonSmoothDynamicalSystem([Round([1.0], [0.0])])


def test_normalise_may_leave_entries_alone():
    class Partly(OnCircle):
        def normalise(self, q, out):
            out[1] = np.copysign(np.sqrt(max(1.0 - q[0] ** 2, 0.0)), q[1])

    start = [np.sin(0.3), -np.cos(0.3)]
    run = sk.TimeStepping(
        sk.NonSmoothDynamicalSystem([Partly(start, [0.0])]), "HalfExplicitTrapezoidalOSI", 1e-3
    )
    q = run.run(0.5).q
    assert np.abs(np.hypot(*q.T) - 1.0).max() < 1e-15
    assert np.ptp(q[:, 0]) > 0.25


def test_odd_directions_and_places():
    zero = [0, 0, 0]
    for size in (1e200, 1e-200):
        line = sk.SpherePlane(1, radius=0.0, point=zero, normal=[0, 0, size])
        ds = sk.NewtonEulerDS([0, 0, 0.5, *UNIT], np.zeros(6), 1.0, np.ones(3))
        system = sk.NonSmoothDynamicalSystem([ds])
        system.link(sk.Interaction(line, sk.NewtonImpactNSL(0.0)), ds)
        assert sk.Configuration(system).gaps[0] == 0.5
    disc = sk.LagrangianLinearTIDS(zero, zero, np.eye(3))
    with pytest.raises(
        ValueError, match=r"axis of a pivot of plane bodies must be \(0, 0, 1\), got \(1, 0, 0\)"
    ):
        sk.Joint.pivot(disc, at=[0, 0], axis=[1, 0, 0])
    system = sk.NonSmoothDynamicalSystem([disc])
    pair = sk.Interaction(sk.SphereSphere(1, radius1=0.1, centre1=[0, 0, 0.5]), sk.NewtonImpactNSL(0.0))
    with pytest.raises(ValueError, match="centres of discs in the plane must have z = 0, got 0.5"):
        system.link(pair, disc)
    with pytest.raises(ValueError, match="quaternion must be finite"):
        sk.rotation_matrix([np.nan, 0, 0, 0])
