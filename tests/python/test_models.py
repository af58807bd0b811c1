"""Models composed and written in Python."""

import gc
import math
import sys

import numpy as np
import pytest
import saltus.kernel as sk


def ball(height=1.0, restitution=0.9):
    mass = sk.LagrangianLinearTIDS(q0=[height], v0=[0.0], mass=[[2.0]], external_force=[-2.0 * 9.81])
    system = sk.NonSmoothDynamicalSystem([mass])
    system.link(
        sk.Interaction(sk.LagrangianLinearTIR([[1.0]]), sk.NewtonImpactNSL(restitution), name="floor"), mass
    )
    return system


class Pendulum(sk.LagrangianDS):
    """Unit mass on a rod of length 1."""

    def mass(self, q, out):
        out[0, 0] = 1.0

    def forces(self, t, q, v, out):
        out[0] = -9.81 * math.sin(q[0])

    def potential_energy(self, q):
        return -9.81 * math.cos(q[0])


class Circle(sk.LagrangianScleronomousR):
    """A point (x, y) on the unit circle: an equality."""

    def __init__(self):
        super().__init__(size=1)

    def gap(self, q, out):
        out[0] = 0.5 * (q[0] ** 2 + q[1] ** 2 - 1.0)

    def jacobian(self, q, out):
        out[0] = q

    def curvature(self, q, v, out):
        out[0] = v @ v


def test_friction_in_space_stops_a_point_along_its_direction():
    v0, mu = np.array([1.2, -0.9]), 0.4
    point = sk.LagrangianLinearTIDS(
        q0=[0.0, 0.0, -1e-4], v0=[*v0, 0.0], mass=2.0 * np.eye(3), external_force=[0.0, 0.0, -2.0 * 9.81]
    )
    system = sk.NonSmoothDynamicalSystem([point])
    floor = sk.LagrangianLinearTIR([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    system.link(sk.Interaction(floor, sk.NewtonImpactFrictionNSL(0.0, 0.0, mu, 3), name="floor"), point)
    trajectory = sk.TimeStepping(system, sk.HalfExplicitTrapezoidalOSI(), time_step=1e-3).run(until=0.5)
    speed = np.linalg.norm(v0)
    expected = v0 * speed / (2.0 * mu * 9.81)  # v0²/(2 mu g) along v0
    np.testing.assert_allclose(trajectory.q[-1, :2], expected, atol=2e-3 * speed)
    np.testing.assert_allclose(trajectory.v[-1], 0.0, atol=1e-13)
    force = trajectory["floor"].lambda_plus[1]
    np.testing.assert_allclose(force, [2.0 * 9.81, *(-mu * 2.0 * 9.81 * v0 / speed)], rtol=1e-9)


def test_ball_at_rest_carries_its_weight():
    system = ball(height=0.0)
    trajectory = sk.TimeStepping(system, sk.HalfExplicitTrapezoidalOSI(), time_step=1e-3).run(until=1.0)
    floor = trajectory["floor"]
    assert len(trajectory) == 1001
    np.testing.assert_allclose(floor.lambda_plus[1:, 0], 2.0 * 9.81, rtol=0, atol=1e-9)
    np.testing.assert_allclose(floor.lambda_minus[1:, 0], 2.0 * 9.81, rtol=0, atol=1e-9)
    np.testing.assert_array_equal(floor.impulse, 0.0)
    np.testing.assert_allclose(trajectory.v, 0.0, atol=1e-15)
    assert not trajectory.impulsive.any()


def test_row_0_is_the_initial_state_with_zero_reactions():
    trajectory = sk.TimeStepping(ball(), "HalfExplicitTrapezoidalOSI", 5e-3).run(0.1)
    assert trajectory.t[0] == 0.0
    assert trajectory.q[0] == 1.0
    floor = trajectory["floor"]
    assert floor.gap[0] == 1.0
    assert floor.lambda_plus.shape == floor.velocity.shape == (21, 1)
    assert not floor.impulse[0].any()
    np.testing.assert_allclose(trajectory.t, 5e-3 * np.arange(21), rtol=1e-15)


@pytest.mark.parametrize(
    ("step", "until", "rows"), [(0.1, 1.0, 10), (5e-3, 10.0, 2000), (0.3, 1.0, 3), (1, 0, 0)]
)
def test_number_of_steps(step, until, rows):
    assert len(sk.TimeStepping(ball(), "ExplicitMoreauJeanOSI", step).run(until)) == rows + 1


def test_a_further_run_continues_the_same_trajectory():
    whole = sk.TimeStepping(ball(), "HalfExplicitTrapezoidalOSI", 5e-3).run(2.0)
    simulation = sk.TimeStepping(ball(), "HalfExplicitTrapezoidalOSI", 5e-3)
    first = simulation.run(0.7)
    assert len(first) == 141
    assert simulation.run(2.0) is first
    np.testing.assert_array_equal(first.q, whole.q)
    np.testing.assert_array_equal(first.t, whole.t)


def test_first_impact_is_within_a_step_of_the_exact_one():
    trajectory = sk.TimeStepping(ball(), "HalfExplicitTrapezoidalOSI", 1e-4).run(1.0)
    first = trajectory.t[trajectory.impulsive][0]
    assert 0.0 <= first - math.sqrt(2.0 / 9.81) <= 1e-4
    row = int(np.flatnonzero(trajectory.impulsive)[0])
    before, after = 9.81 * trajectory.t[row], trajectory.v[row, 0]
    assert after == pytest.approx(0.9 * before, rel=1e-12)
    assert trajectory["floor"].impulse[row, 0] == pytest.approx(2.0 * 1.9 * before, rel=1e-12)


def test_record_every_keeps_impulsive_steps():
    every = sk.TimeStepping(ball(), "HalfExplicitTrapezoidalOSI", 1e-3).run(2.0)
    some = sk.TimeStepping(ball(), "HalfExplicitTrapezoidalOSI", 1e-3, record_every=100).run(2.0)
    kept = (every.step % 100 == 0) | every.impulsive
    assert every.impulsive.sum() > 1
    np.testing.assert_array_equal(some.step, every.step[kept])
    np.testing.assert_array_equal(some.q, every.q[kept])


def test_pendulum_in_python_conserves_energy_to_second_order():
    drift = []
    for dt in (4e-3, 2e-3, 1e-3):
        system = sk.NonSmoothDynamicalSystem([Pendulum(q0=[1.0], v0=[0.0])])
        energy = sk.TimeStepping(system, "HalfExplicitTrapezoidalOSI", dt).run(2.0).energy
        drift.append(np.abs(energy - energy[0]).max())
    slopes = np.log2(np.array(drift[:-1]) / drift[1:])
    assert (slopes > 1.9).all(), slopes


def test_cartesian_pendulum_is_second_order():
    """The point on a circle, against the angle of the same pendulum."""
    angle = sk.TimeStepping(
        sk.NonSmoothDynamicalSystem([Pendulum([math.pi / 2], [0.0])]), "HalfExplicitTrapezoidalOSI", 1e-5
    )
    exact = angle.run(1.0).q[-1, 0]
    errors = []
    for dt in (1e-2, 5e-3, 2.5e-3):
        point = sk.LagrangianLinearTIDS([1.0, 0.0], [0.0, 0.0], np.eye(2), external_force=[0.0, -9.81])
        system = sk.NonSmoothDynamicalSystem([point])
        system.link(sk.Interaction(Circle(), sk.EqualityConditionNSL(1), "rod"), point)
        q = sk.TimeStepping(system, sk.HalfExplicitTrapezoidalOSI(), dt).run(1.0).q[-1]
        errors.append(np.abs(q - [math.sin(exact), -math.cos(exact)]).max())
    slopes = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (np.abs(slopes - 2.0) < 0.2).all(), slopes


def test_two_systems_exchange_momentum():
    left = sk.LagrangianLinearTIDS([0.0], [1.0], [[1.0]])
    right = sk.LagrangianLinearTIDS([2.0], [0.0], [[1.0]])
    system = sk.NonSmoothDynamicalSystem([left, right])
    touch = sk.Interaction(sk.LagrangianLinearTIR([[-1.0, 1.0]], [-1.0]), sk.NewtonImpactNSL(1.0), "touch")
    system.link(touch, left, right)
    trajectory = sk.TimeStepping(system, "HalfExplicitTrapezoidalOSI", 1e-2).run(2.0)
    np.testing.assert_allclose(trajectory.v[-1], [0.0, 1.0], atol=1e-15)
    assert trajectory.impulsive.sum() == 1


def test_siconos_argument_orders():
    relation = sk.LagrangianLinearTIR([[1.0, 0.0], [0.0, 1.0]])
    law = sk.NewtonImpactFrictionNSL(0.5, 0.0, 0.3, 2)
    assert sk.Interaction(law, relation).name == ""
    assert sk.Interaction(relation, law, name="a").name == "a"


def test_python_objects_survive_their_names():
    def build():
        system = sk.NonSmoothDynamicalSystem([Pendulum([math.pi / 2], [0.0])])
        floor = Circle()
        point = sk.LagrangianLinearTIDS([1.0, 0.0], [0.0, 0.0], np.eye(2), external_force=[0.0, -9.81])
        both = sk.NonSmoothDynamicalSystem([*system.systems, point])
        both.link(sk.Interaction(floor, sk.EqualityConditionNSL(1)), point)
        return sk.TimeStepping(both, "HalfExplicitTrapezoidalOSI", 1e-2)

    simulation = build()
    gc.collect()
    trajectory = simulation.run(1.0)
    assert trajectory.contacts == ("contact0",)
    assert np.isfinite(trajectory.q).all()


def test_models_are_freed():
    class Watched(Pendulum):
        freed = 0

        def __del__(self):
            Watched.freed += 1

    for _ in range(3):
        system = sk.NonSmoothDynamicalSystem([Watched([0.1], [0.0])])
        sk.TimeStepping(system, "HalfExplicitTrapezoidalOSI", 1e-2).run(0.1)
        del system
    gc.collect()
    assert Watched.freed == 3


def test_out_starts_as_zero_and_arguments_are_read_only():
    class Careless(Pendulum):
        def forces(self, t, q, v, out):
            assert out[0] == 0.0
            out[0] += 1.0
            with pytest.raises(ValueError, match="read-only"):
                q[0] = 3.0

    system = sk.NonSmoothDynamicalSystem([Careless([0.0], [0.0])])
    trajectory = sk.TimeStepping(system, "HalfExplicitTrapezoidalOSI", 0.5).run(1.0)
    assert trajectory.q[-1, 0] == pytest.approx(0.5)


def test_constant_mass_of_a_python_model():
    class Free(sk.LagrangianDS):
        def forces(self, t, q, v, out):
            out[0] = t

    system = sk.NonSmoothDynamicalSystem([Free([0.0], [0.0], mass=[[2.0]])], t0=1.0)
    trajectory = sk.TimeStepping(system, "HalfExplicitTrapezoidalOSI", 1e-3).run(2.0)
    assert trajectory.t[0] == 1.0
    assert trajectory.v[-1, 0] == pytest.approx(0.5 * (4.0 - 1.0) / 2.0, rel=1e-12)


def test_observers_see_every_step_whatever_is_recorded():
    seen = []
    simulation = sk.TimeStepping(ball(), "HalfExplicitTrapezoidalOSI", 5e-3, record_every=1000)
    simulation.observe(lambda step, t, q, v, report: seen.append((step, t, q[0], report.closed)))
    simulation.run(0.5)
    assert [step for step, *_ in seen] == list(range(101))
    assert seen[-1][1] == simulation.t == 0.5
    assert seen[-1][2] == simulation.q[0]


def test_one_integrator_serves_two_simulations():
    scheme = sk.HalfExplicitTrapezoidalOSI()
    one = sk.TimeStepping(ball(1.0), scheme, 1e-2)
    two = sk.TimeStepping(ball(2.0), scheme, 1e-2)
    for _ in range(100):
        one.step()
        two.step()
    alone = sk.TimeStepping(ball(1.0), scheme, 1e-2).run(1.0)
    np.testing.assert_array_equal(one.trajectory.q, alone.q)


def test_calls_do_not_leak():
    system = sk.NonSmoothDynamicalSystem([Pendulum([0.1], [0.0])])
    simulation = sk.TimeStepping(system, "HalfExplicitTrapezoidalOSI", 1e-4, record_every=10**9)
    simulation.run(0.1)
    before = sys.getallocatedblocks()
    simulation.run(1.1)
    assert sys.getallocatedblocks() - before < 100


def test_check_accepts_a_right_model_and_names_what_is_wrong():
    class Wrong(Circle):
        def jacobian(self, q, out):
            out[0] = 2.0 * q

    def with_relation(relation):
        point = sk.LagrangianLinearTIDS([0.6, 0.8], [0.8, -0.6], np.eye(2))
        system = sk.NonSmoothDynamicalSystem([point])
        system.link(sk.Interaction(relation, sk.EqualityConditionNSL(1), "rod"), point)
        return system.check()

    assert with_relation(Circle()).ok
    report = with_relation(Wrong())
    bad = [(item.subject, item.quantity) for item in report.items if not item.ok]
    assert bad == [("rod", "jacobian against gap"), ("rod", "curvature against jacobian")]
    assert "BAD  rod" in str(report)


def test_check_finds_a_missing_centrifugal_term():
    class Crane(sk.LagrangianDS):
        def __init__(self, sign):
            super().__init__([1.0, 0.5], [0.3, 0.7])
            self.sign = sign

        def mass(self, q, out):  # polar coordinates of a point
            out[0, 0] = 1.0
            out[1, 1] = q[0] ** 2

        def forces(self, t, q, v, out):
            out[0] = self.sign * q[0] * v[1] ** 2
            out[1] = -2.0 * q[0] * v[0] * v[1]

    assert sk.NonSmoothDynamicalSystem([Crane(1.0)]).check().ok
    assert not sk.NonSmoothDynamicalSystem([Crane(-1.0)]).check().ok


def test_integrators_are_attributes_of_the_module():
    names = [entry["name"] for entry in sk.integrators()]
    assert {"HalfExplicitTrapezoidalOSI", "ExplicitMoreauJeanOSI"} <= set(names)
    for name in names:
        assert getattr(sk, name)().name == name
        assert name in dir(sk)
    with pytest.raises(AttributeError, match="NoSuchOSI"):
        sk.NoSuchOSI  # noqa: B018


def test_options_are_keywords_or_stand_in_order():
    by_name = sk.TimeStepping(ball(), sk.MoreauJeanOSI(theta=1), 1e-2).run(1.0)
    in_order = sk.TimeStepping(ball(), sk.MoreauJeanOSI(1.0), 1e-2).run(1.0)
    half = sk.TimeStepping(ball(), "MoreauJeanOSI", 1e-2).run(1.0)
    np.testing.assert_array_equal(by_name.q, in_order.q)
    assert np.abs(by_name.q - half.q).max() > 1e-3
    with pytest.raises(TypeError, match="takes 2 options, got 3"):
        sk.MoreauJeanOSI(0.5, 0.5, 1.0)
    with pytest.raises(TypeError, match="theta is given twice"):
        sk.MoreauJeanOSI(0.5, theta=1.0)


def test_shapes_follow_the_run(tmp_path):
    mass = sk.LagrangianLinearTIDS([0.0, 1.0], [1.0, 0.0], np.eye(2))
    mass.add_shape(sk.Disc(0.1), pose=lambda q: (q[0], q[1], 0.0))
    trajectory = sk.TimeStepping(sk.NonSmoothDynamicalSystem([mass]), "ExplicitMoreauJeanOSI", 0.5).run(1.0)
    (shape,) = trajectory.shapes
    assert shape.kind == "Disc"
    np.testing.assert_allclose(shape.poses, [[0.0, 1.0, 0.0], [0.5, 1.0, 0.0], [1.0, 1.0, 0.0]])
    np.testing.assert_allclose(np.hypot(*shape.points[:-1].T), 0.1)
