"""Bad input: a clear error that names what was expected and what came; nothing recorded is lost."""

import math

import numpy as np
import pytest
import saltus.kernel as sk
from saltus import numerics
from test_models import Pendulum, ball

EYE = np.eye(2)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: sk.LagrangianLinearTIDS([0, 0], [0], EYE), "v0 must have 2 entries.*got 1"),
        (lambda: sk.LagrangianLinearTIDS([0, math.nan], [0, 0], EYE), "q0 must be finite"),
        (lambda: sk.LagrangianLinearTIDS([0, 0], [0, math.inf], EYE), "v0 must be finite"),
        (
            lambda: sk.LagrangianLinearTIDS([[0, 0]], [0, 0], EYE),
            r"q0 must have one axis, got shape \(1, 2\)",
        ),
        (lambda: sk.LagrangianLinearTIDS([], [], EYE), "at least one entry"),
        (lambda: sk.LagrangianLinearTIDS([0, 0], [0, 0], np.eye(3)), r"mass must be \(2, 2\).*got \(3, 3\)"),
        (lambda: sk.LagrangianLinearTIDS([0, 0], [0, 0], [1, 2]), "mass must have two axes"),
        (lambda: sk.LagrangianLinearTIDS([0, 0], [0, 0], 0 * EYE), "mass must be positive definite.* 0"),
        (lambda: sk.LagrangianLinearTIDS([0, 0], [0, 0], -EYE), "mass must be positive definite.*-1"),
        (lambda: sk.LagrangianLinearTIDS([0, 0], [0, 0], [[1, 1], [1, 1]]), "mass must be positive definite"),
        (lambda: sk.LagrangianLinearTIDS([0, 0], [0, 0], [[1, 0.5], [0, 1]]), "mass must be symmetric.*0.5"),
        (lambda: sk.LagrangianLinearTIDS([0, 0], [0, 0], math.nan * EYE), "mass must be finite"),
        (
            lambda: sk.LagrangianLinearTIDS([0, 0], [0, 0], EYE, stiffness=[[1]]),
            r"stiffness must be \(2, 2\)",
        ),
        (
            lambda: sk.LagrangianLinearTIDS([0, 0], [0, 0], EYE, damping=math.nan * EYE),
            "damping must be finite",
        ),
        (
            lambda: sk.LagrangianLinearTIDS([0, 0], [0, 0], EYE, external_force=[1]),
            "external_force must have 2",
        ),
        (lambda: sk.LagrangianDS([0], [0], mass=[[0]]), "mass must be positive definite"),
        (lambda: sk.NewtonImpactNSL(1.5), r"\[0, 1\], got 1.5"),
        (lambda: sk.NewtonImpactNSL(-0.1), r"\[0, 1\], got -0.1"),
        (lambda: sk.NewtonImpactNSL(math.nan), r"\[0, 1\], got nan"),
        (lambda: sk.NewtonImpactFrictionNSL(0.5, 2.0, 0.3, 2), r"et must be in \[0, 1\], got 2"),
        (lambda: sk.NewtonImpactFrictionNSL(0.5, 0.0, -0.3, 2), "mu must be finite and >= 0, got -0.3"),
        (lambda: sk.NewtonImpactFrictionNSL(0.5, 0.0, math.nan, 2), "mu must be finite"),
        (lambda: sk.NewtonImpactFrictionNSL(0.5, 0.0, 0.3, 4), "dim must be 2 .*got 4"),
        (lambda: sk.EqualityConditionNSL(0), "n >= 1 rows, got 0"),
        (lambda: sk.LagrangianLinearTIR([[1, math.nan]]), "H must be finite"),
        (lambda: sk.LagrangianLinearTIR([[1, 0]], [1, 2]), "b must have 1 entries.*got 2"),
        (lambda: sk.LagrangianLinearTIR([1, 0]), "H must have two axes"),
        (lambda: sk.LagrangianScleronomousR(0), "at least 1, got 0"),
        (
            lambda: sk.Interaction(sk.LagrangianLinearTIR(EYE), sk.NewtonImpactNSL(0.5), "floor"),
            "same number of rows, got 2 and 1 in 'floor'",
        ),
        (lambda: sk.NonSmoothDynamicalSystem([]), "at least one dynamical system"),
        (lambda: sk.NonSmoothDynamicalSystem([Pendulum([0], [0])], t0=math.nan), "t0 must be finite"),
        (
            lambda: sk.TimeStepping(ball(), "HalfExplicitTrapezoidalOSI", 0.0),
            "time_step must be positive.*got 0",
        ),
        (lambda: sk.TimeStepping(ball(), "HalfExplicitTrapezoidalOSI", -1.0), "time_step must be positive"),
        (
            lambda: sk.TimeStepping(ball(), "HalfExplicitTrapezoidalOSI", math.nan),
            "time_step must be positive",
        ),
        (lambda: sk.TimeStepping(ball(), "Nonsense", 0.1), "no integrator named 'Nonsense', there are Exp"),
        (
            lambda: sk.TimeStepping(ball(), "ExplicitMoreauJeanOSI", 0.1, solver="x"),
            "no contact solver named 'x'",
        ),
        (lambda: sk.TimeStepping(ball(), "ExplicitMoreauJeanOSI", 0.1, record_every=0), "at least 1, got 0"),
        (lambda: sk.TimeStepping(ball(), "ExplicitMoreauJeanOSI", 0.1).run(math.nan), "until must be finite"),
        (
            lambda: sk.HalfExplicitTrapezoidalOSI(activity="never"),
            "one of start, sticky, predicted, got 'never'",
        ),
        (lambda: sk.HalfExplicitTrapezoidalOSI(theta="1"), "no option 'theta', its options: activity"),
        (lambda: sk.HalfExplicitTrapezoidalOSI(1), "one of start, sticky, predicted, got a number"),
        (lambda: sk.MoreauJeanOSI("x"), "theta must be a number, got a word"),
        (lambda: sk.MoreauJeanOSI(1.5), r"theta must be in \[0, 1\], got 1.5"),
        (lambda: sk.Disc(-1.0), "radius must be positive"),
        (lambda: numerics.solve([[1, 0]], [1], [numerics.Equality()]), r"G must be \(1, 1\).*got \(1, 2\)"),
        (lambda: numerics.solve([[math.nan]], [1], [numerics.Equality()]), "G must be finite"),
        (lambda: numerics.solve([[1]], [1], [numerics.Coulomb(0.1)]), "take 2 rows, b has 1"),
        (lambda: numerics.solve(EYE, [1, 0], [numerics.Coulomb(-0.1)]), "mu must be finite and >= 0"),
        (
            lambda: numerics.solve([[1]], [1], [numerics.Equality()], solver="x"),
            "no contact solver named 'x'",
        ),
    ],
)
def test_bad_input_is_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_linking_mistakes():
    system = ball()
    (mass,) = system.systems
    floor = sk.Interaction(sk.LagrangianLinearTIR([[1.0]]), sk.NewtonImpactNSL(0.5), "floor")
    with pytest.raises(ValueError, match="unique, got 'floor' twice"):
        system.link(floor, mass)
    with pytest.raises(ValueError, match="not part of this"):
        system.link(floor, Pendulum([0], [0]))
    with pytest.raises(ValueError, match="two different systems"):
        system.link(sk.Interaction(sk.LagrangianLinearTIR([[1.0, 1.0]]), sk.NewtonImpactNSL(0.5)), mass, mass)
    with pytest.raises(ValueError, match="H must have 1 columns.*got 2"):
        system.link(sk.Interaction(sk.LagrangianLinearTIR([[1.0, 1.0]]), sk.NewtonImpactNSL(0.5)), mass)


def one(ds):
    return sk.TimeStepping(sk.NonSmoothDynamicalSystem([ds]), "HalfExplicitTrapezoidalOSI", 0.1)


def test_what_a_python_model_must_define():
    class Empty(sk.LagrangianDS):
        pass

    with pytest.raises(NotImplementedError, match=r"Empty must define mass\(self, q, out\)"):
        one(Empty([0.0], [0.0]))
    with pytest.raises(NotImplementedError, match=r"Empty must define forces\(self, t, q, v, out\)"):
        one(Empty([0.0], [0.0], mass=[[1.0]]))


def test_a_mass_is_given_in_one_way():
    with pytest.raises(ValueError, match="Pendulum.mass is defined and mass= is given"):
        one(Pendulum([0.0], [0.0], mass=[[1.0]]))


def test_python_models_that_are_wrong_at_the_start():
    class Returns(Pendulum):
        def forces(self, t, q, v, out):
            return np.zeros(1)

    class NotFinite(Pendulum):
        def forces(self, t, q, v, out):
            out[0] = math.nan

    class Singular(Pendulum):
        def mass(self, q, out):
            pass

    class WrongShape(Pendulum):
        def mass(self, q, out):
            out[:] = np.eye(2)

    with pytest.raises(
        TypeError, match="Returns.forces must write into out and return None, got numpy.ndarray"
    ):
        one(Returns([0.0], [0.0]))
    with pytest.raises(ValueError, match="forces of system 0 at t0 must be finite"):
        one(NotFinite([0.0], [0.0]))
    with pytest.raises(ValueError, match="mass of system 0 at t0 must be positive definite.* 0"):
        one(Singular([0.0], [0.0]))
    with pytest.raises(ValueError, match="could not broadcast"):
        one(WrongShape([0.0], [0.0]))


@pytest.mark.filterwarnings("ignore::saltus.kernel.StabilityWarning")
def test_a_diverging_run_keeps_what_it_has():
    stiff = sk.LagrangianLinearTIDS([1.0], [0.0], [[1.0]], stiffness=[[1e6]])
    simulation = one(stiff)
    with pytest.raises(sk.SimulationError, match="velocities are not finite") as caught:
        simulation.run(1000.0)
    error = caught.value
    assert error.trajectory is simulation.trajectory
    assert len(error.trajectory) == error.step  # row 0 and the steps before the one that failed
    assert error.time == error.trajectory.t[-1]
    assert error.contacts == []
    assert np.isfinite(error.trajectory.q).all()


def test_a_contact_that_becomes_undefined():
    mass = sk.LagrangianLinearTIDS([0.0], [1.0], [[1.0]])
    system = sk.NonSmoothDynamicalSystem([mass])

    class Vanishing(sk.LagrangianScleronomousR):
        def gap(self, q, out):
            out[0] = 1.0 - q[0]

        def jacobian(self, q, out):
            out[0, 0] = -1.0 if q[0] < 1.0 else -math.nan

    system.link(sk.Interaction(Vanishing(1), sk.NewtonImpactNSL(0.0), "wall"), mass)
    simulation = sk.TimeStepping(system, "HalfExplicitTrapezoidalOSI", 0.3)
    with pytest.raises(sk.SimulationError) as caught:
        simulation.run(10.0)
    assert caught.value.step == 4
    assert simulation.q[0] == pytest.approx(0.9)
    assert len(caught.value.trajectory) == 4


def test_an_exception_in_a_python_model_passes_and_keeps_the_run():
    class Breaks(Pendulum):
        def forces(self, t, q, v, out):
            if t > 0.55:
                raise KeyError("lost")
            out[0] = 0.0

    simulation = one(Breaks([0.0], [1.0]))
    with pytest.raises(KeyError, match="lost"):
        simulation.run(2.0)
    assert len(simulation.trajectory) == 6
    assert simulation.q[0] == pytest.approx(0.5)


def test_an_exception_in_an_observer_passes():
    def look(step, t, q, v, report):
        if step == 3:
            raise RuntimeError("enough")

    simulation = one(Pendulum([0.1], [0.0]))
    simulation.observe(look)
    with pytest.raises(RuntimeError, match="enough"):
        simulation.run(2.0)
    assert simulation.steps == 3


@pytest.mark.parametrize("solver", ["enumeration", "lemke"])
def test_friction_in_space_is_refused_by_solvers_of_the_plane(solver):
    mass = sk.LagrangianLinearTIDS([0, 0, 0], [0, 0, 0], np.eye(3))
    system = sk.NonSmoothDynamicalSystem([mass])
    system.link(
        sk.Interaction(sk.LagrangianLinearTIR(np.eye(3)), sk.NewtonImpactFrictionNSL(0, 0, 0.1, 3)), mass
    )
    with pytest.raises(ValueError, match="does not accept a law with 3 rows: friction in space"):
        sk.TimeStepping(system, "HalfExplicitTrapezoidalOSI", 0.1, solver=solver)


def test_unknown_contact_names_those_there_are():
    trajectory = sk.TimeStepping(ball(), "HalfExplicitTrapezoidalOSI", 0.1).run(0.2)
    with pytest.raises(KeyError, match="no contact named 'flor', there are floor"):
        trajectory["flor"]
