"""Rigid bodies, rotations and boundary conditions of saltus.siconos.kernel against what is known of them."""

import numpy as np
import pytest
import saltus.siconos.kernel as sk

RADIUS, MASS, G = 0.1, 2.0, 9.81
INERTIA = 0.4 * MASS * RADIUS**2
STILL = [0.0, 0.0, RADIUS, 1.0, 0.0, 0.0, 0.0]


class OnTheFloor(sk.NewtonEuler3DR):
    """The lowest point of a sphere on z = 0."""

    def computeh(self, time, q, y):
        y[0] = q[2] - RADIUS
        self.setnc([0.0, 0.0, 1.0])
        self.setpc1([q[0], q[1], q[2] - RADIUS])
        self.setpc2([q[0], q[1], 0.0])


def sphere(twist, law, relation, T, h=1e-3, q0=STILL, integrator=None):
    ball = sk.NewtonEulerDS(q0, twist, MASS, INERTIA * np.eye(3))
    ball.setFExtPtr([0.0, 0.0, -MASS * G])
    floor = sk.Interaction(law, relation)
    model = sk.NonSmoothDynamicalSystem(0.0, T)
    model.insertDynamicalSystem(ball)
    model.link(floor, ball)
    scheme = integrator or sk.MoreauJeanOSI(0.5)
    simulation = sk.TimeStepping(model, sk.TimeDiscretisation(0.0, h), scheme, sk.FrictionContact(3))
    return simulation, ball, floor


@pytest.mark.parametrize("scheme", [sk.MoreauJeanOSI(0.5), sk.HalfExplicitTrapezoidalOSI()])
def test_a_sphere_that_slides_ends_rolling(scheme):
    """At 5/7 of its speed, in the direction of its start."""
    law = sk.NewtonImpactFrictionNSL(0.0, 0.0, 0.3, 3)
    simulation, ball, floor = sphere([1.0, 0.5, 0, 0, 0, 0], law, OnTheFloor(), 0.3, integrator=scheme)
    simulation.run()
    np.testing.assert_allclose(ball.twist()[:3], [5 / 7, 2.5 / 7, 0.0], atol=1e-6)
    turn = sk.SiconosVector(ball.twist()[3:])
    sk.changeFrameBodyToAbs(ball.q(), turn)
    np.testing.assert_allclose(turn, [-2.5 / 7 / RADIUS, 5 / 7 / RADIUS, 0.0], atol=1e-5)
    np.testing.assert_allclose(floor.y(1), 0.0, atol=1e-9)
    assert np.linalg.norm(ball.q()[3:]) == pytest.approx(1.0, abs=1e-14)


def test_the_force_of_a_contact_is_that_on_the_body():
    relation = OnTheFloor()
    law = sk.NewtonImpactFrictionNSL(0.0, 0.0, 0.3, 3)
    simulation, ball, floor = sphere([1.0, 0, 0, 0, 0, 0], law, relation, 0.01)
    simulation.computeOneStep()
    impulse = MASS * G * 1e-3
    np.testing.assert_allclose(relation.contactForce(), [-0.3 * impulse, 0.0, impulse], rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(ball.p(1)[:3], relation.contactForce(), rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(ball.p(1)[3:], [0.0, 0.3 * impulse * RADIUS, 0.0], rtol=1e-6, atol=1e-9)
    assert floor.lambda_(1)[0] == pytest.approx(impulse)


def test_two_bodies_exchange_what_a_contact_takes():
    class Between(sk.NewtonEuler1DR):
        def computeh(self, time, q, y):
            y[0] = q[7] - q[0] - 2 * RADIUS
            self.setnc([-1.0, 0.0, 0.0])
            self.setpc1([q[0] + RADIUS, 0.01, 0.0])
            self.setpc2([q[7] - RADIUS, 0.01, 0.0])

    left = sk.NewtonEulerDS([0, 0, 0, 1, 0, 0, 0], [1.0, 0, 0, 0, 0, 0], MASS, INERTIA * np.eye(3))
    right = sk.NewtonEulerDS([0.25, 0, 0, 1, 0, 0, 0], np.zeros(6), MASS, INERTIA * np.eye(3))
    touch = sk.Interaction(sk.NewtonImpactNSL(1.0), Between())
    model = sk.NonSmoothDynamicalSystem(0.0, 0.1)
    for ds in (left, right):
        model.insertDynamicalSystem(ds)
    model.link(touch, left, right)
    simulation = sk.TimeStepping(model, sk.TimeDiscretisation(0.0, 1e-3), sk.MoreauJeanOSI(0.5), sk.LCP())
    total = 0.0
    while simulation.hasNextEvent():
        simulation.computeOneStep()
        total += touch.lambda_(1)[0]
        simulation.nextStep()
    # an impulse at an arm of 1 cm: the relative velocity of the points turns round
    expected = 2.0 / (2 / MASS + 2 * 0.01**2 / INERTIA)
    assert total == pytest.approx(expected, rel=1e-12)
    np.testing.assert_allclose(
        left.twist(), [1 - expected / MASS, 0, 0, 0, 0, 0.01 * expected / INERTIA], atol=1e-12
    )
    np.testing.assert_allclose(
        right.twist(), [expected / MASS, 0, 0, 0, 0, -0.01 * expected / INERTIA], atol=1e-12
    )


@pytest.mark.parametrize("in_space", [False, True])
def test_moments_are_in_the_frame_that_is_said(in_space):
    """About its axis a body that lies on its side turns by the one, about the vertical by the other."""

    class Driven(sk.NewtonEulerDS):
        def computeMExt(self, time):
            self.mExt()[2] = 0.3

    c = np.cos(np.pi / 4)
    made = []
    for kind in (sk.NewtonEulerDS, Driven):
        body = kind([0, 0, 0, c, c, 0, 0], np.zeros(6), MASS, np.diag([0.1, 0.2, 0.3]))
        body.setMExtPtr([0.0, 0.0, 0.3])
        body.setIsMextExpressedInInertialFrame(in_space)
        model = sk.NonSmoothDynamicalSystem(0.0, 0.1)
        model.insertDynamicalSystem(body)
        sk.TimeStepping(model, sk.TimeDiscretisation(0.0, 1e-2), sk.MoreauJeanOSI(0.5)).run()
        made.append(body.twist().copy())
    expected = [0, 0.1 * 0.3 / 0.2, 0] if in_space else [0, 0, 0.1]
    np.testing.assert_allclose(made[0][3:], expected, atol=1e-12)
    np.testing.assert_allclose(made[1], made[0], atol=1e-14)


def test_forces_and_rates_of_a_body():
    body = sk.NewtonEulerDS([0, 0, 0, 1, 0, 0, 0], [4.0, 5, 6, 1, 2, 3], 2.0, np.diag([1.0, 2, 3]))
    body.setFExtPtr([1.0, 1.0, -9.81])
    body.update(0.0)
    gyroscopic = np.cross([1, 2, 3], [1.0, 4, 9])
    np.testing.assert_allclose(body.forces(), [1, 1, -9.81, *-gyroscopic])
    np.testing.assert_allclose(body.rhs()[:7], [4, 5, 6, 0, 0.5, 1, 1.5])
    np.testing.assert_allclose(body.rhs()[7:], [0.5, 0.5, -4.905, *(-gyroscopic / [1, 2, 3])])
    assert body.computeKineticEnergy() == 0.5 * (2 * 77 + 1 + 8 + 27)
    np.testing.assert_allclose(body.jacobianRhsx()[3], [0, 0, 0, 0, -3, -2], atol=1e-8)  # Ω̇1 = −Ω2 Ω3


def test_rotations():
    q, rotation, back = sk.SiconosVector(7), np.array([0.3, -0.4, 1.2]), sk.SiconosVector(3)
    sk.quaternionFromRotationVector(rotation, q)
    assert np.linalg.norm(np.asarray(q)[3:]) == pytest.approx(1.0, abs=1e-15)
    sk.rotationVectorFromConfiguration(q, back)
    np.testing.assert_allclose(back, rotation, rtol=1e-14)
    sk.rotationVectorFromQuaternion(*-np.asarray(q)[3:], back)
    np.testing.assert_allclose(back, rotation, rtol=1e-14)
    along = sk.SiconosVector(rotation)
    sk.changeFrameAbsToBody(q, along)  # the axis stays where it is
    np.testing.assert_allclose(along, rotation, rtol=1e-14)
    sk.quaternionFromRotationVector([0, 0, np.pi / 2], q)
    x = sk.SiconosVector([1.0, 0.0, 0.0])
    sk.changeFrameBodyToAbs(q, x)
    np.testing.assert_allclose(x, [0, 1, 0], atol=1e-15)
    sk.changeFrameAbsToBody(q, x)
    np.testing.assert_allclose(x, [1, 0, 0], atol=1e-15)
    sk.quaternionFromRotationVector([0, 0, 0], q)
    np.testing.assert_array_equal(np.asarray(q)[3:], [1, 0, 0, 0])


def test_boundary_conditions_hold_freedoms():
    """Two masses on springs: with the first held, the second swings alone."""
    K = np.array([[20.0, -10.0], [-10.0, 10.0]])
    ds = sk.LagrangianLinearTIDS([0.0, 1.0], [0.0, 0.0], np.eye(2), K)
    condition = sk.BoundaryCondition([1])
    condition.velocityIndices()[0] = 0
    ds.setBoundaryConditions(condition)
    model = sk.NonSmoothDynamicalSystem(0.0, 1.0)
    model.insertDynamicalSystem(ds)
    sk.TimeStepping(model, sk.TimeDiscretisation(0.0, 1e-4), sk.MoreauJeanOSI(0.5), sk.LCP()).run()
    assert (ds.q()[0], ds.velocity()[0], ds.p(1)[0]) == (0.0, 0.0, 0.0)
    assert ds.q()[1] == pytest.approx(np.cos(np.sqrt(10.0)), abs=1e-6)


def test_misuse_says_what_was_expected():
    with pytest.raises(ValueError, match="expected 7 coordinates and 6 velocities, got 3, 6"):
        sk.NewtonEulerDS([0, 0, 0], np.zeros(6), 1.0, np.eye(3))
    with pytest.raises(ValueError, match=r"expected an inertia of \(3, 3\), got \(2, 2\)"):
        sk.NewtonEulerDS(STILL, np.zeros(6), 1.0, np.eye(2))
    simulation, _, _ = sphere(np.zeros(6), sk.NewtonImpactNSL(0.0), OnTheFloor(), 1.0)
    with pytest.raises(ValueError, match="OnTheFloor needs a law of 3 rows, got 1"):
        simulation.computeOneStep()
    ds = sk.LagrangianLinearTIDS([0.0], [0.0], [[1.0]])
    ds.setBoundaryConditions(sk.FixedBC([3]))
    with pytest.raises(ValueError, match=r"names velocities from 0 to 0, got \[3\]"):
        ds.held()
    with pytest.raises(NotImplementedError, match="velocities of a boundary condition are zero"):
        sk.BoundaryCondition([0], [1.0])
    with pytest.raises(ValueError, match="nc must have 3 entries, got 2"):
        OnTheFloor().setnc([1.0, 0.0])
