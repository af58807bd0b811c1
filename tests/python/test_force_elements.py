"""Springs, dampers and actuators: motions in closed form, energy, and what is refused."""

import ctypes
import gc
import math

import numpy as np
import pytest
import saltus
import saltus.kernel as sk

SCHEMES = [entry["name"] for entry in sk.integrators()]
SECOND_ORDER = ["HalfExplicitTrapezoidalOSI", "MoreauJeanOSI", "DMinusAccelerationOSI"]
BETWEEN = sk.LagrangianLinearTIR([[-1.0, 1.0]])


def mass(m=1.0, x=0.0, v=0.0):
    return sk.LagrangianLinearTIDS([x], [v], [[m]])


def on_ground(law, body=None, relation=None):
    body = body or mass()
    system = sk.NonSmoothDynamicalSystem([body])
    system.add_force(sk.ForceElement(relation or sk.LagrangianLinearTIR([[1.0]]), law), body)
    return system


@pytest.mark.parametrize("scheme", SECOND_ORDER)
def test_two_masses_on_a_spring_oscillate_at_the_frequency_of_the_reduced_mass(scheme):
    m1, m2, k, rest, stretch = 1.0, 3.0, 60.0, 0.5, 0.1
    left, right = mass(m1), mass(m2, rest + stretch)
    system = sk.NonSmoothDynamicalSystem([left, right])
    system.add_force(
        sk.ForceElement(BETWEEN, sk.SpringDamper(k, rest_length=rest), name="spring"), left, right
    )
    run = sk.TimeStepping(system, scheme, 1e-4).run(3.0)
    omega = math.sqrt(k / (m1 * m2 / (m1 + m2)))
    exact = rest + stretch * np.cos(omega * run.t)
    np.testing.assert_allclose(run.q[:, 1] - run.q[:, 0], exact, atol=1e-6)
    np.testing.assert_allclose(run.v @ [m1, m2], 0.0, atol=1e-13)
    np.testing.assert_allclose(run.energy, 0.5 * k * stretch**2, rtol=1e-6)


@pytest.mark.parametrize("scheme", SECOND_ORDER)
def test_a_damper_takes_what_the_oscillation_loses(scheme):
    omega, zeta = 8.0, 0.1
    system = on_ground(sk.SpringDamper(omega**2, 2 * zeta * omega), mass(x=1.0))
    run = sk.TimeStepping(system, scheme, 1e-4).run(1.0)
    damped = omega * math.sqrt(1 - zeta**2)
    exact = np.exp(-zeta * omega * run.t) * (
        np.cos(damped * run.t) + zeta * omega / damped * np.sin(damped * run.t)
    )
    np.testing.assert_allclose(run.q[:, 0], exact, atol=1e-6)
    kinetic = 0.5 * run.v[:, 0] ** 2
    np.testing.assert_allclose(np.cumsum(run.work_forces), kinetic, atol=1e-6)
    np.testing.assert_allclose(run.energy, kinetic + 0.5 * omega**2 * run.q[:, 0] ** 2, rtol=1e-12)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_constant_force_works_force_times_way(scheme):
    run = sk.TimeStepping(on_ground(sk.Actuator(3.0), mass(2.0)), scheme, 1e-3).run(1.0)
    np.testing.assert_allclose(run.v[:, 0], 1.5 * run.t, atol=1e-13)
    way = run.q[-1, 0] if scheme != "ExplicitMoreauJeanOSI" else 0.75 - 0.75e-3
    assert run.work_forces.sum() == pytest.approx(3.0 * way, rel=1e-12)


SOURCE = """
void cubic(double t, int n, const double* q, const double* v, double* out, const double* p) {
  out[0] = n == 1 ? -p[0] * q[0] * q[0] * q[0] - p[1] * v[0] : 1e9;
}
"""


@pytest.fixture(scope="module")
def library(shared_library):
    return shared_library(SOURCE)


@saltus.compiled
def cubic(t, length, rate, parameters):
    return -parameters[0] * length * length * length - parameters[1] * rate


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("kind", ["python", "compiled", "file", "ctypes"])
def test_all_kinds_of_functions_give_the_motion_of_the_same_system(library, kind, scheme):
    class Duffing(sk.LagrangianDS):
        def forces(self, t, q, v, out):
            out[0] = -50.0 * q[0] * q[0] * q[0] - 0.3 * v[0]

    law = {
        "python": lambda: sk.Actuator(lambda t, length, rate: -50.0 * length * length * length - 0.3 * rate),
        "compiled": lambda: sk.Actuator(cubic, parameters=[50.0, 0.3]),
        "file": lambda: sk.Actuator(f"{library}:cubic", parameters=[50.0, 0.3]),
        "ctypes": lambda: sk.Actuator(ctypes.CDLL(str(library)).cubic, [50.0, 0.3]),
    }[kind]()
    system = on_ground(law, mass(x=1.0))
    del law
    gc.collect()
    run = sk.TimeStepping(system, scheme, 1e-2).run(2.0)
    expected = sk.TimeStepping(
        sk.NonSmoothDynamicalSystem([Duffing([1.0], [0.0], [[1.0]])]), scheme, 1e-2
    ).run(2.0)
    np.testing.assert_allclose(run.q, expected.q, rtol=0, atol=1e-11)


class Length(sk.LagrangianScleronomousR):
    """Distance of two points in the plane, in Python."""

    def __init__(self):
        super().__init__(size=1)

    def gap(self, q, out):
        out[0] = math.hypot(q[2] - q[0], q[3] - q[1])

    def jacobian(self, q, out):
        d = (q[2:] - q[:2]) / math.hypot(q[2] - q[0], q[3] - q[1])
        out[0] = [-d[0], -d[1], d[0], d[1]]


def two_points(relation):
    points = [
        sk.LagrangianLinearTIDS(q, v, m * np.eye(2))
        for m, q, v in ((1.0, [0.0, 0.0], [0.0, 0.0]), (2.0, [0.8, 0.6], [-0.6, 0.8]))
    ]
    system = sk.NonSmoothDynamicalSystem(points)
    system.add_force(sk.ForceElement(relation, sk.SpringDamper(400.0, 0.0, 0.9)), *points)
    return system


@pytest.mark.parametrize("scheme", SECOND_ORDER)
def test_a_spring_between_two_points_keeps_energy_and_angular_momentum(scheme):
    H = [[-1, 0, 1, 0], [0, -1, 0, 1]]
    run = sk.TimeStepping(two_points(sk.Distance(H)), scheme, 1e-3).run(3.0)
    moments = run.q[:, ::2] * run.v[:, 1::2] - run.q[:, 1::2] * run.v[:, ::2]
    momentum = moments @ [1.0, 2.0]
    np.testing.assert_allclose(momentum, momentum[0], atol=2e-3)
    np.testing.assert_allclose(run.energy, 3.0, atol=2e-3)  # ½·2·1² + ½·400·0.1²
    python = sk.TimeStepping(two_points(Length()), scheme, 1e-3).run(0.2)
    np.testing.assert_allclose(python.q, run.q[:201], atol=1e-12)
    assert two_points(Length()).check().ok


def test_a_scheme_in_python_sees_the_force_elements():
    system = on_ground(sk.SpringDamper(9.0, 2.0, 0.5), mass(x=1.0, v=0.25))
    configuration = sk.Configuration(system)
    configuration.move_to([1.0])
    np.testing.assert_allclose(configuration.forces(0.0, [0.25]), [-9.0 * 0.5 - 2.0 * 0.25], rtol=1e-15)


def test_check_names_the_element_whose_gradient_is_wrong():
    class Wrong(Length):
        def jacobian(self, q, out):
            out[0] = 1.0

    report = two_points(Wrong()).check()
    assert not report.ok
    assert [(item.subject, item.quantity) for item in report.items if not item.ok] == [
        ("force0", "jacobian against length")
    ]


def test_an_element_outlives_its_python_names():
    system = two_points(Length())
    gc.collect()
    run = sk.TimeStepping(system, "HalfExplicitTrapezoidalOSI", 1e-3)
    del system
    gc.collect()
    assert np.isfinite(run.run(0.1).q).all()


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: sk.SpringDamper(1.0, -1.0), ValueError, "damping must be >= 0, got -1"),
        (lambda: sk.SpringDamper(math.nan), ValueError, "stiffness must be finite, got nan"),
        (lambda: sk.Actuator(math.inf), ValueError, "force must be finite, got inf"),
        (lambda: sk.Actuator(None), TypeError, "force must be a number, .* got NoneType"),
        (lambda: sk.Actuator(1j), TypeError, "force must be a number, .* got complex"),
        (lambda: sk.Actuator(1.0, [2.0]), ValueError, "parameters are for compiled .* a number"),
        (lambda: sk.Actuator(math.hypot, [2.0]), ValueError, "parameters are for .* a Python function"),
        (
            lambda: sk.ForceElement(sk.LagrangianLinearTIR(np.eye(2)), sk.SpringDamper(1.0)),
            ValueError,
            "1 row",
        ),
        (lambda: sk.Distance(np.ones((4, 2))), ValueError, "1 to 3 rows.* got 4"),
        (lambda: on_ground(sk.SpringDamper(1.0), relation=BETWEEN), ValueError, "1 columns .* got 2"),
        (
            lambda: on_ground(sk.SpringDamper(1.0)).add_force(
                sk.ForceElement(BETWEEN, sk.SpringDamper(1.0)), mass()
            ),
            ValueError,
            "not part of",
        ),
    ],
)
def test_bad_input_is_refused_by_name(make, error, message):
    with pytest.raises(error, match=message):
        make()


@pytest.mark.parametrize(("result", "kind"), [("strong", "str"), (None, "NoneType")])
def test_a_force_that_is_no_number_is_refused(result, kind):
    with pytest.raises(TypeError, match=f"must return a number, got {kind}"):
        sk.TimeStepping(on_ground(sk.Actuator(lambda t, length, rate: result)), SCHEMES[0], 1e-3)


def test_a_force_that_is_not_finite_ends_the_run():
    law = sk.Actuator(lambda t, length, rate: math.nan if t > 0.1 else 0.0)
    with pytest.raises(sk.SimulationError, match="not finite"):
        sk.TimeStepping(on_ground(law), "HalfExplicitTrapezoidalOSI", 1e-3).run(1.0)
    with pytest.raises(ValueError, match="jacobian of force element 'force0' at t0"):
        sk.TimeStepping(on_ground(sk.SpringDamper(1.0), relation=sk.Distance([[1.0]])), SCHEMES[0], 1e-3)
