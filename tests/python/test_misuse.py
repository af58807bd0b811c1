"""What clumsy and hostile callers do: refused by name, or harmless."""

import math
import os

import h5py
import numpy as np
import pytest
import saltus.kernel as sk
from saltus import numerics
from saltus.io import read_hdf5
from test_models import Circle, Pendulum, ball

SCHEMES = [entry["name"] for entry in sk.integrators()]


def pendulum_simulation(cls=Pendulum, dt=1e-2):
    return sk.TimeStepping(sk.NonSmoothDynamicalSystem([cls([0.1], [0.0])]), "HalfExplicitTrapezoidalOSI", dt)


@pytest.mark.parametrize("call", ["step", "run", "observe"])
def test_a_running_step_is_not_entered_again(call):
    simulation = pendulum_simulation()
    enter = {
        "step": simulation.step,
        "run": lambda: simulation.run(1.0),
        "observe": lambda: simulation.observe(print),
    }

    def callback(step, *rest):
        if step == 3:
            enter[call]()

    simulation.observe(callback)
    with pytest.raises(RuntimeError, match="was called while a step of this simulation is taken"):
        simulation.run(1.0)
    assert simulation.steps == 3
    assert len(simulation.trajectory) == 4


def test_a_model_may_run_another_simulation_of_itself():
    class Nested(Pendulum):
        depth = 0

        def forces(self, t, q, v, out):
            if Nested.depth == 0 and t == pytest.approx(0.05):
                Nested.depth = 1
                sk.TimeStepping(sk.NonSmoothDynamicalSystem([self]), "HalfExplicitTrapezoidalOSI", 1e-2).run(
                    0.1
                )
                Nested.depth = 0
            super().forces(t, q, v, out)

    nested = pendulum_simulation(Nested).run(0.5)
    alone = pendulum_simulation().run(0.5)
    np.testing.assert_array_equal(nested.q, alone.q)


def test_arrays_of_a_model_cannot_be_pulled_away():
    class Resizes(Pendulum):
        def forces(self, t, q, v, out):
            out.resize(1000, refcheck=False)

    class Retypes(Pendulum):
        def forces(self, t, q, v, out):
            out.dtype = np.int64

    with pytest.raises(ValueError, match="resize"):
        pendulum_simulation(Resizes)
    with pytest.raises(TypeError, match="forces must leave type and shape of out as they are"):
        pendulum_simulation(Retypes)


def test_arrays_outlive_the_model():
    kept = []

    class Keeps(Pendulum):
        def forces(self, t, q, v, out):
            kept.append(q)

    pendulum_simulation(Keeps).run(0.1)
    assert kept[-1][0] == pytest.approx(0.1)


def test_attributes_before_super_init():
    class Early(sk.LagrangianDS):
        def __init__(self):
            self.dimension  # noqa: B018

    class EarlyRelation(sk.LagrangianScleronomousR):
        def __init__(self):
            self.size  # noqa: B018

    for cls in (Early, EarlyRelation):
        with pytest.raises(TypeError, match=r"super\(\).__init__\(\) must be called first"):
            cls()


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_a_gap_that_is_no_number_ends_the_run(scheme, value):
    class Hole(sk.LagrangianScleronomousR):
        def gap(self, q, out):
            out[0] = q[0] if q[0] > 0.1 else value

        def jacobian(self, q, out):
            out[0, 0] = 1.0

        def curvature(self, q, v, out):
            out[0] = 0.0

    mass = sk.LagrangianLinearTIDS([1.0], [0.0], [[1.0]], external_force=[-9.81])
    system = sk.NonSmoothDynamicalSystem([mass])
    system.link(sk.Interaction(Hole(1), sk.NewtonImpactNSL(0.5), "hole"), mass)
    simulation = sk.TimeStepping(system, scheme, 1e-2)
    with pytest.raises(sk.SimulationError, match="a gap is not finite"):
        simulation.run(2.0)
    assert simulation.q[0] > 0.1


def test_overflow_is_not_a_solution():
    solution = numerics.solve(
        [[1e308]], [-1.0], [numerics.NonNegative()], solver="semismooth-newton", warm_start=[1e300]
    )
    assert solution.status != "solved" or solution.residual < 1e-12
    wild = numerics.solve([[1e308, 1e308], [1e308, 1.5e308]], [-1e308, -1e308], 2 * [numerics.NonNegative()])
    assert wild.status != "solved" or math.isfinite(wild.scale)


def test_large_times_neither_overshoot_nor_stand_still():
    mass = sk.LagrangianLinearTIDS([0.0], [1.0], [[1.0]])
    late = sk.TimeStepping(sk.NonSmoothDynamicalSystem([mass], t0=1e9), "ExplicitMoreauJeanOSI", 1e-4)
    assert len(late.run(1e9 + 0.01)) == 101
    with pytest.raises(ValueError, match="time_step must change t0 = 1e"):
        sk.TimeStepping(sk.NonSmoothDynamicalSystem([mass], t0=1e16), "ExplicitMoreauJeanOSI", 1e-3)


def test_systems_may_come_from_a_generator():
    system = sk.NonSmoothDynamicalSystem(ds for ds in [Pendulum([0.0], [0.0])])
    assert len(system.systems) == 1


def test_reports_and_columns_do_not_change_afterwards():
    simulation = sk.TimeStepping(ball(), "HalfExplicitTrapezoidalOSI", 1e-2)
    simulation.run(0.1)
    report = simulation.report
    energy = report.kinetic_energy
    trajectory = simulation.run(0.2)
    assert report.kinetic_energy == energy != simulation.report.kinetic_energy
    with pytest.raises(ValueError, match="read-only"):
        trajectory.q[:] = 99.0


def test_potential_energy_must_be_a_number():
    class Odd(Pendulum):
        def potential_energy(self, q):
            return None

    with pytest.raises(TypeError, match="Odd.potential_energy must return a number, got NoneType"):
        pendulum_simulation(Odd)


def test_one_python_relation_in_interactions_of_different_shape():
    class Wall(sk.LagrangianScleronomousR):
        def gap(self, q, out):
            out[:] = q[: len(out)] + 1.0

        def jacobian(self, q, out):
            out[0, 0] = 1.0

    wall = Wall(1)
    one = sk.LagrangianLinearTIDS([0.0], [-1.0], [[1.0]])
    two = sk.LagrangianLinearTIDS([0.0, 0.0], [-1.0, 0.0], np.eye(2))
    system = sk.NonSmoothDynamicalSystem([one, two])
    system.link(sk.Interaction(wall, sk.NewtonImpactNSL(0.0), "first"), one)
    system.link(sk.Interaction(wall, sk.NewtonImpactNSL(0.0), "second"), two)
    q = sk.TimeStepping(system, "HalfExplicitTrapezoidalOSI", 1e-2).run(2.0).q[-1]
    np.testing.assert_allclose(q, [-1.0, -1.0, 0.0], atol=1e-2)


def test_given_names_and_made_names_do_not_collide():
    mass = sk.LagrangianLinearTIDS([0.0], [0.0], [[1.0]])
    system = sk.NonSmoothDynamicalSystem([mass])
    for name in ("contact1", "", ""):
        system.link(sk.Interaction(sk.LagrangianLinearTIR([[1.0]]), sk.NewtonImpactNSL(0.0), name), mass)
    trajectory = sk.TimeStepping(system, "ExplicitMoreauJeanOSI", 0.1).trajectory
    assert trajectory.contacts == ("contact1", "contact2", "contact3")


@pytest.mark.parametrize(
    "values",
    [[1j], np.ma.masked_array([1.0], mask=[True]), ["a"], np.array(["2020"], dtype="datetime64[s]"), [None]],
)
def test_only_real_numbers_are_numbers(values):
    with pytest.raises(ValueError, match="q0 must"):
        sk.LagrangianLinearTIDS(values, [0.0], [[1.0]])


def test_integers_and_views_are_numbers():
    values = np.arange(8, dtype=np.float32).reshape(4, 2).T[1][::2]
    np.testing.assert_array_equal(
        sk.LagrangianLinearTIDS(values, [0, 1], np.eye(2, dtype=int)).q0, [1.0, 5.0]
    )


def test_masses_of_mixed_units():
    sk.LagrangianLinearTIDS([0.0, 0.0], [0.0, 0.0], np.diag([1e6, 1e-12]))
    with pytest.raises(ValueError, match="positive definite"):
        sk.LagrangianLinearTIDS([0.0, 0.0], [0.0, 0.0], [[1e6, 1e-3], [1e-3, 1e-12]])


def test_simulation_arguments_of_the_wrong_type():
    with pytest.raises(TypeError, match=r"call it, HalfExplicitTrapezoidalOSI\(\)"):
        sk.TimeStepping(ball(), sk.HalfExplicitTrapezoidalOSI, 0.1)
    with pytest.raises(
        TypeError, match="system must be a NonSmoothDynamicalSystem, got LagrangianLinearTIDS"
    ):
        sk.TimeStepping(ball().systems[0], "HalfExplicitTrapezoidalOSI", 0.1)
    with pytest.raises(TypeError, match="time_step must be a number, got str"):
        sk.TimeStepping(ball(), "HalfExplicitTrapezoidalOSI", "0.1")


def test_links_stay_links_and_devices_devices(tmp_path):
    trajectory = sk.TimeStepping(ball(), "HalfExplicitTrapezoidalOSI", 1e-1).run(1.0)
    (tmp_path / "real.h5").touch()
    (tmp_path / "link.h5").symlink_to(tmp_path / "real.h5")
    trajectory.to_hdf5(tmp_path / "link.h5")
    assert (tmp_path / "link.h5").is_symlink()
    assert len(read_hdf5(tmp_path / "real.h5")) == len(trajectory)
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(OSError, match="expected a writable file"):
        trajectory.to_hdf5(tmp_path / "pipe")


def test_incomplete_files_are_named(tmp_path):
    path = sk.TimeStepping(ball(), "HalfExplicitTrapezoidalOSI", 1e-1).run(1.0).to_hdf5(tmp_path / "run.h5")
    with h5py.File(path, "a") as file:
        del file["columns/impulse"]
    with pytest.raises(ValueError, match="complete run of Saltus.*impulse"):
        read_hdf5(path)
    with h5py.File(path, "a") as file:
        file.attrs["layout"] = "{"
    with pytest.raises(ValueError, match="complete run of Saltus"):
        read_hdf5(path)


class Drag(sk.LagrangianDS):
    """A constant mass in a wind: the force is even and odd in v."""

    def forces(self, t, q, v, out):
        out[:] = -abs(v[0] - 3.0) * (v[0] - 3.0)


class Rim(sk.LagrangianScleronomousR):
    """Distance of a point from a disc about (0, 0)."""

    def __init__(self, radius):
        super().__init__(1)
        self.radius = radius

    def gap(self, q, out):
        out[0] = math.hypot(*q) - self.radius

    def jacobian(self, q, out):
        out[0] = q / math.hypot(*q)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e6])
def test_check_does_not_cry_wolf(scale):
    point = sk.LagrangianLinearTIDS([0.6 * scale, 0.8 * scale], [0.1, 0.2], np.eye(2))
    system = sk.NonSmoothDynamicalSystem([point, Drag([0.0], [0.0], mass=[[1.0]])])
    system.link(sk.Interaction(Rim(0.9 * scale), sk.NewtonImpactNSL(0.0)), point)
    assert system.check().ok, system.check()
    stiff = sk.LagrangianLinearTIDS([10.0], [0.0], [[1.0]], stiffness=[[1e9]], external_force=[1e10])
    assert sk.NonSmoothDynamicalSystem([stiff]).check().ok


def test_check_sees_bilateral_constraints_that_are_violated():
    point = sk.LagrangianLinearTIDS([2.0, 0.0], [3.0, 0.0], np.eye(2))
    system = sk.NonSmoothDynamicalSystem([point])
    system.link(sk.Interaction(Circle(), sk.EqualityConditionNSL(1), "rod"), point)
    bad = [item.quantity for item in system.check().items if not item.ok]
    assert bad == ["bilateral gap at t0", "bilateral velocity at t0"]
