"""saltus.siconos.kernel against the same models with native classes, and what it refuses."""

import importlib
import runpy
import sys
from math import pi, sin
from pathlib import Path

import numpy as np
import pytest
import saltus.kernel as native
import saltus.siconos.kernel as sk
from saltus._core import LiveState
from saltus.siconos.script import run_script
from saltus.siconos.simulation import Changes
from scipy.integrate import solve_ivp

SCRIPTS = Path(__file__).parents[1] / "siconos" / "scripts"


def run(name, **changes):
    """dataPlot of a script and the trajectory of its simulation."""
    made = Changes(**changes)
    plot = run_script(SCRIPTS / f"{name}.py", made)["dataPlot"]
    [simulation] = made.simulations
    return plot, simulation.trajectory


def ball(h=1e-2, T=1.0):
    """A simulation that waits for its first step, and what it is made of."""
    ds = sk.LagrangianLinearTIDS([1.0], [0.0], [[2.0]])
    ds.setFExtPtr([-2.0 * 9.81])
    floor = sk.Interaction(sk.NewtonImpactNSL(0.5), sk.LagrangianLinearTIR([[1.0]]))
    model = sk.NonSmoothDynamicalSystem(0.0, T)
    model.insertDynamicalSystem(ds)
    model.link(floor, ds)
    return sk.TimeStepping(model, sk.TimeDiscretisation(0.0, h), sk.MoreauJeanOSI(0.5), sk.LCP()), ds, floor


def native_ball():
    force = [-1.5 * 9.81, 0, 0]
    ds = native.LagrangianLinearTIDS([1.0, 0, 0], [0.0, 0, 0], 1.5 * np.eye(3), external_force=force)
    system = native.NonSmoothDynamicalSystem([ds])
    floor = native.Interaction(native.NewtonImpactNSL(0.8), native.LagrangianLinearTIR([[1.0, 0, 0]]))
    system.link(floor, ds)
    return system


@pytest.mark.parametrize(
    "integrator",
    [
        None,
        "HalfExplicitTrapezoidalOSI",
        "HalfExplicitTrapezoidalOSI(activity=start)",
        "DMinusAccelerationOSI",
        "ExplicitMoreauJeanOSI",
    ],
)
def test_a_script_gives_the_bits_of_the_native_classes(integrator):
    plot, recorded = run("bouncing_ball", integrator=integrator)
    scheme = integrator or "MoreauJeanOSI"
    if scheme == "HalfExplicitTrapezoidalOSI":  # without options impulsive steps are taken in parts
        scheme += "(impulsive_substeps=10)"
    expected = native.TimeStepping(native_ball(), scheme, 5e-3).run(5.0)
    contact = expected[expected.contacts[0]]
    np.testing.assert_array_equal(plot[:, 1], expected.q[:, 0])
    np.testing.assert_array_equal(plot[:, 2], expected.v[:, 0])
    impulse = contact.impulse[:, 0] + 5e-3 * contact.force[:, 0]
    np.testing.assert_array_equal(plot[1:, 4], impulse[1:])
    np.testing.assert_array_equal(plot[1:, 3], impulse[1:])
    np.testing.assert_array_equal(plot[1:, 5], contact.gap[1:, 0])
    np.testing.assert_allclose(plot[:, 0], expected.t, rtol=1e-15)
    np.testing.assert_array_equal(recorded.q, expected.q)
    assert np.count_nonzero(impulse) > 10


def bouncing(t, e=0.8, height=1.0, gravity=9.81):
    """Height of the ball at t, from one bounce to the next."""
    start, velocity = 0.0, 0.0
    flight = (2 * height / gravity) ** 0.5
    y0 = height
    while t > start + flight:
        if flight < 1e-9:
            return 0.0
        velocity = e * (gravity * flight - velocity if start == 0.0 else velocity)
        start, y0 = start + flight, 0.0
        flight = 2 * velocity / gravity
    return y0 + velocity * (t - start) - gravity / 2 * (t - start) ** 2


def ball_error(plot):
    """Mean error of the height until 2.5 s [m], 16 bounces."""
    rows = plot[:501]
    return np.mean(np.abs(rows[:, 1] - [bouncing(t) for t in rows[:, 0]]))


def rod_error(plot):
    """Largest distance from where the mass should be [m]."""
    swing = solve_ivp(
        lambda _, y: [y[1], -9.81 / 2 * np.cos(y[0])],
        (0, 2),
        [0, 0],
        t_eval=plot[:, 0],
        rtol=1e-11,
        atol=1e-12,
    )
    angle = swing.y[0]
    return np.hypot(plot[:, 1] - 2 * np.cos(angle), plot[:, 2] - 2 * np.sin(angle)).max()


def block_error(plot):
    """Mean error while it slides [m]: about ±0.06 m it swings with amplitudes that lose 0.12 m."""
    t = plot[:2400, 0]
    half = np.floor(5 * t / pi)
    exact = (-1) ** half * (0.06 + (0.94 - 0.12 * half) * np.cos(5 * t - pi * half))
    return np.mean(np.abs(plot[:2400, 1] - exact))


@pytest.mark.parametrize(
    ("script", "error", "ratio"),
    [
        ("rod", rod_error, 0.01),
        ("friction_oscillator", block_error, 0.97),
        ("bouncing_ball", ball_error, 0.3),
    ],
)
def test_half_explicit_runs_have_smaller_errors_than_moreau_jean(script, error, ratio):
    theirs = error(run(script)[0])
    ours = error(run(script, integrator="HalfExplicitTrapezoidalOSI")[0])
    assert theirs < 0.05
    assert ours < ratio * theirs


@pytest.mark.parametrize(("integrator", "tolerance"), [(None, 1e-6), ("HalfExplicitTrapezoidalOSI", 1e-5)])
def test_an_overridden_force_is_integrated(integrator, tolerance):
    plot, _ = run("driven_ball", integrator=integrator)
    flight = plot[:200]
    t = flight[:, 0]
    exact = 1.0 - 9.81 / 2 * t**2 + 2.0 / 3 * (t - np.sin(3 * t) / 3)
    np.testing.assert_allclose(flight[:, 1], exact, atol=tolerance)


@pytest.mark.parametrize(("integrator", "tolerance"), [(None, 1e-3), ("HalfExplicitTrapezoidalOSI", 1e-4)])
def test_a_block_stops_where_friction_holds_it(integrator, tolerance):
    """Each half swing of ω = 5/s shortens the amplitude by 2 μ g m / k = 0.12 m; within 0.06 m it sticks."""
    plot, _ = run("friction_oscillator", integrator=integrator)
    for half in range(1, 5):
        at = round(half * pi / 5 / 1e-3)
        assert plot[at, 1] == pytest.approx((-1) ** half * (1.0 - 0.12 * half), abs=tolerance)
    np.testing.assert_allclose(plot[2:, 3], 10.0 * 1e-3, rtol=1e-9)  # the weight
    sliding = np.abs(plot[2:, 2]) > 1e-2
    np.testing.assert_allclose(np.abs(plot[2:, 4][sliding]), 0.15 * 10.0 * 1e-3, rtol=1e-9)


@pytest.mark.parametrize(("integrator", "tolerance"), [(None, 1e-4), ("HalfExplicitTrapezoidalOSI", 5e-5)])
def test_a_pendulum_loses_energy_at_the_wall_alone(integrator, tolerance):
    plot, _ = run("pendulum", integrator=integrator)
    energy = 0.5 * 1.5**2 * plot[:, 2] ** 2 - 9.81 * 1.5 * np.cos(plot[:, 1])
    [hits] = np.nonzero(plot[:, 3])
    assert len(hits) >= 2
    first = hits[0]
    np.testing.assert_allclose(energy[: first - 1], energy[0], atol=tolerance * 15)
    before, after = plot[first - 1, 2], plot[first, 2]
    assert after == pytest.approx(-0.9 * before, abs=0.02)
    assert plot[first, 1] == pytest.approx(-0.3, abs=5e-3)


def test_two_systems_share_an_impulse():
    plot, _ = run("two_balls")
    floor, between = plot[:, 5], plot[:, 6]
    np.testing.assert_allclose(plot[:, 4], between, atol=1e-15)
    np.testing.assert_allclose(plot[:, 3], floor - between, atol=1e-15)
    assert np.count_nonzero(between) > 3


def test_a_floor_that_moves_throws_the_ball():
    plot, _ = run("moving_floor")
    [first, *_] = np.nonzero(plot[:, 3])[0]
    t = plot[first, 0]
    floor_velocity = 0.05 * 8 * np.cos(8 * t)
    before, after = plot[first - 1, 2], plot[first, 2]
    assert after - floor_velocity == pytest.approx(-0.5 * (before - floor_velocity), abs=0.02)
    assert np.all(plot[:, 1] - 0.05 * np.sin(8 * plot[:, 0]) > -6e-3)


class Spring(sk.LagrangianDS):
    """Mass and stiffness depend on the position, through every kind of override."""

    def computeMass(self, position):
        self.mass()[0, 0] = 2.0 + sin(position[0])

    def computeFInt(self, time, position, velocity):
        self.setFIntPtr([4.0 * position[0]])

    def computeFGyr(self, position, velocity):
        self.fGyr()[0] = 0.5 * np.cos(position[0]) * velocity[0] ** 2

    def computeFExt(self, time):
        self.fExt()[0] = np.sin(time)


class NativeSpring(native.LagrangianDS):
    def mass(self, q, out):
        out[0, 0] = 2.0 + sin(q[0])

    def forces(self, t, q, v, out):
        out[0] = np.sin(t) - 4.0 * q[0] - 0.5 * np.cos(q[0]) * v[0] ** 2


def test_overridden_terms_give_the_bits_of_native_forces():
    ds = Spring([0.5], [0.0])
    model = sk.NonSmoothDynamicalSystem(0.0, 2.0)
    model.insertDynamicalSystem(ds)
    simulation = sk.TimeStepping(model, sk.TimeDiscretisation(0.0, 1e-2), sk.MoreauJeanOSI(0.5))
    simulation.run()
    system = native.NonSmoothDynamicalSystem([NativeSpring([0.5], [0.0])])
    expected = native.TimeStepping(system, native.MoreauJeanOSI(0.5), 1e-2).run(2.0)
    np.testing.assert_array_equal(simulation.trajectory.v, expected.v)
    assert ds.q()[0] == expected.q[-1, 0]
    assert ds.computeKineticEnergy() == pytest.approx(expected.kinetic_energy[-1], rel=1e-14)


def test_a_driven_linear_system_keeps_stiffness_and_damping():
    class Driven(sk.LagrangianLinearTIDS):
        def computeFExt(self, time):
            self.setFExtPtr([np.cos(time), 0.0])

    K, C = [[3.0, -1.0], [-1.0, 2.0]], [[0.2, 0.0], [0.0, 0.1]]
    ds = Driven([1.0, 0.0], [0.0, 0.5], np.eye(2), K, C)
    ds.setFIntPtr([0.3, -0.2])
    model = sk.NonSmoothDynamicalSystem(0.0, 1.0)
    model.insertDynamicalSystem(ds)
    simulation = sk.TimeStepping(model, sk.TimeDiscretisation(0.0, 1e-2), sk.MoreauJeanOSI(0.5))
    simulation.run()

    class Expected(native.LagrangianDS):
        def forces(self, t, q, v, out):
            out[:] = [np.cos(t) - 0.3, 0.2] - np.array(K) @ q - np.array(C) @ v

    system = native.NonSmoothDynamicalSystem([Expected([1.0, 0.0], [0.0, 0.5], np.eye(2))])
    expected = native.TimeStepping(system, native.MoreauJeanOSI(0.5), 1e-2).run(1.0)
    np.testing.assert_allclose(simulation.trajectory.q, expected.q, atol=1e-12)


def test_sparse_matrices_stay_sparse_and_give_the_same():
    n, results = 50, []
    k = np.full(n, 100.0)
    for kind in ("diagonal", "sparse", "dense"):
        if kind == "diagonal":
            ds = sk.LagrangianLinearDiagonalDS(np.linspace(0, 1, n), np.zeros(n), k, 0.1 * k, np.full(n, 2.0))
        else:
            M, K = (sk.SimpleMatrix(n, n, getattr(sk, kind.upper())) for _ in range(2))
            for i in range(n):
                M.setValue(i, i, 2.0)
                K.setValue(i, i, k[i])
            ds = sk.LagrangianLinearTIDS(np.linspace(0, 1, n), np.zeros(n), M, K, 0.1 * K.matrix)
        model = sk.NonSmoothDynamicalSystem(0.0, 0.1)
        model.insertDynamicalSystem(ds)
        simulation = sk.TimeStepping(model, sk.TimeDiscretisation(0.0, 1e-3), sk.MoreauJeanOSI(0.5))
        simulation.run()
        results.append(ds.q().copy())
    np.testing.assert_allclose(results[0], results[2], atol=1e-13)
    np.testing.assert_allclose(results[1], results[2], atol=1e-13)


def test_views_are_live_and_cannot_be_written():
    simulation, ds, floor = ball()
    q, v, p, y, impulse = ds.q(), ds.velocity(), ds.p(1), floor.y(0), floor.lambda_(1)
    assert (q[0], v[0], simulation.startingTime(), simulation.nextTime()) == (1.0, 0.0, 0.0, 1e-2)
    simulation.computeOneStep()
    assert v[0] == pytest.approx(-9.81e-2)
    assert y[0] == q[0] < 1.0
    assert simulation.nextTime() == 1e-2
    simulation.nextStep()
    assert simulation.startingTime() == 1e-2
    while simulation.hasNextEvent():
        simulation.computeOneStep()
        simulation.nextStep()
    assert simulation.startingTime() == pytest.approx(1.0)
    assert len(simulation.trajectory) == 101
    assert simulation.trajectory.q[-1, 0] == q[0]
    assert p[0] == impulse[0]
    with pytest.raises(ValueError, match="read-only"):
        q[0] = 2.0


@pytest.mark.parametrize(("T", "h", "steps"), [(1, 0.3, 3), (1, 0.1, 10), (10, 0.005, 2000), (0.9, 0.3, 3)])
def test_steps_end_where_those_of_siconos_do(T, h, steps):
    simulation, _, _ = ball(h, T)
    simulation.run()
    assert len(simulation.trajectory) == steps + 1


def test_steps_come_one_after_the_other():
    simulation, ds, _ = ball()
    with pytest.raises(RuntimeError, match="expected computeOneStep"):
        simulation.nextStep()
    once, ball_once, _ = ball()
    once.computeOneStep()
    for _ in range(2):  # it is the same step
        simulation.computeOneStep()
    np.testing.assert_array_equal(ds.q(), ball_once.q())
    assert len(simulation.trajectory) == 2


def test_constants_cannot_change_behind_the_simulation():
    force = np.array([-1.0])
    simulation, ds, _ = ball()
    ds.setFExtPtr(force)
    force[0] = -2.0
    simulation.computeOneStep()
    assert ds.velocity()[0] == pytest.approx(-1e-2)
    with pytest.raises(ValueError, match="read-only"):
        force[0] = -3.0


def test_a_smaller_step_sums_its_impulses_up():
    plain, _ = run("bouncing_ball", time_step=1e-3, until=1.0)
    changes = Changes(time_step=1e-3, until=1.0)
    run_script(SCRIPTS / "bouncing_ball.py", changes)
    fine = changes.simulations[0].trajectory
    assert len(fine) == 1001
    rows = plain[:201]
    np.testing.assert_array_equal(rows[:, 1], fine.q[::5, 0])
    impulse = fine[fine.contacts[0]].impulse[1:, 0].reshape(-1, 5).sum(axis=1)
    np.testing.assert_allclose(rows[1:, 4], impulse, rtol=1e-14)
    np.testing.assert_allclose(rows[1:, 3], impulse, rtol=1e-14)


def test_a_script_leaves_no_trace(tmp_path):
    script = tmp_path / "script.py"
    script.write_text("import sys, siconos.kernel as sk\nname, rest = sk.__name__, sys.argv[1:]\n")
    before = (list(sys.argv), list(sys.path))
    names = run_script(script, Changes(), ["a", "b"])
    assert names["name"] == "saltus.siconos.kernel"
    assert names["rest"] == ["a", "b"]
    assert (sys.argv, sys.path) == before
    assert not [key for key in sys.modules if key.partition(".")[0] == "siconos"]
    with pytest.raises(ValueError, match="there is no file"):
        run_script(tmp_path / "none.py", Changes())


def test_a_script_runs_with_its_imports_changed(tmp_path):
    text = (SCRIPTS / "two_balls.py").read_text().replace("siconos.kernel", "saltus.siconos.kernel")
    (tmp_path / "changed.py").write_text(text)
    changed = runpy.run_path(str(tmp_path / "changed.py"))["dataPlot"]
    np.testing.assert_array_equal(changed, run("two_balls")[0])
    assert importlib.import_module("saltus.siconos.kernel") is sk


def test_live_arrays_must_fit():
    system = native_ball()
    simulation = native.TimeStepping(system, native.MoreauJeanOSI(0.5), 1e-2)
    three, one = (lambda: np.zeros(3)), (lambda: np.zeros(1))
    with pytest.raises(ValueError, match="must have the sizes of the model"):
        simulation.add_observer(
            LiveState([(three(), three(), one(), one())], [(one(), one(), one(), one())], 1e-2)
        )
    with pytest.raises(TypeError, match="contiguous and of float64"):
        LiveState([(np.zeros(6)[::2], three(), three(), three())], [], 1e-2)
    with pytest.raises(ValueError, match="steps must be at least 1, got 0"):
        LiveState([], [], 1e-2, 0)
