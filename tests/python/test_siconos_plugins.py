"""Functions of shared libraries with the signatures of Siconos's plugins."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import saltus.kernel as native
import saltus.siconos.kernel as sk
from saltus._core import PluggedDS, PluggedRelation, PluggedRheonomousRelation
from saltus.siconos.script import run_script
from saltus.siconos.simulation import Changes

PENDULUM = Path(__file__).parents[1] / "siconos" / "pendulum_plugin.cpp"
SCRIPT = PENDULUM.parent / "scripts" / "plugin_pendulum.py"

# A linear system with an unsymmetric stiffness, rows of a relation, and forces of parameters z
SOURCE = """
typedef unsigned int size;
void linear(double t, size n, const double* q, const double* v, double* f, size nz, double* z) {
  f[0] = 40 * q[0] - 10 * q[1] + 0.3 * v[0];
  f[1] = 5 * q[0] + 30 * q[1] + 0.7 * v[0] + 0.2 * v[1];
}
void linear_dq(double t, size n, const double* q, const double* v, double* J, size nz, double* z) {
  J[0] = 40; J[1] = 5; J[2] = -10; J[3] = 30;
}
void linear_dv(double t, size n, const double* q, const double* v, double* J, size nz, double* z) {
  J[0] = 0.3; J[1] = 0.7; J[3] = 0.2;
}
void turn(size n, const double* q, const double* v, double* f, size nz, double* z) {
  f[0] = -2 * v[1]; f[1] = 2 * v[0];
}
void turn_dq(size n, const double* q, const double* v, double* J, size nz, double* z) {}
void turn_dv(size n, const double* q, const double* v, double* J, size nz, double* z) { J[1] = 2; J[2] = -2; }
void weight(double t, size n, double* f, size nz, double* z) {
  f[n - 1] = nz == 2 ? -z[0] * z[1] : -1e9;
  z[0] = 0;
}
void rows(size n, const double* q, size rows, double* y, size nz, double* z) { y[0] = q[1]; y[1] = 7; }
void rows_dq(size n, const double* q, size rows, double* H, size nz, double* z) { H[2] = 1; H[1] = 1; }
void circle(size n, const double* q, size rows, double* y, size nz, double* z) {
  y[0] = 1 - q[0] * q[0] - q[1] * q[1];
}
void circle_dq(size n, const double* q, size rows, double* H, size nz, double* z) {
  H[0] = -2 * q[0]; H[1] = -2 * q[1];
}
void circle_rate(size n, const double* q, size nv, const double* v, double* H, size nz, double* z) {
  H[0] = -2 * v[0]; H[1] = -2 * v[1];
}
"""


@pytest.fixture(scope="module")
def own(tmp_path_factory):
    """Path of a library made of SOURCE."""
    folder = tmp_path_factory.mktemp("own")
    (folder / "own.c").write_text(SOURCE)
    return compiled(folder / "own.c", folder / "libown.so")


@pytest.fixture(scope="module")
def pendulum(tmp_path_factory):
    return compiled(PENDULUM, tmp_path_factory.mktemp("pendulum") / "pendulum_plugin.so")


def compiled(source, library):
    subprocess.run(["gcc", "-O2", "-shared", "-fPIC", source, "-o", library, "-lm"], check=True)
    return str(library)


def run(ds, interaction=None, osi=None, T=1.0, h=1e-3):
    model = sk.NonSmoothDynamicalSystem(0.0, T)
    model.insertDynamicalSystem(ds)
    if interaction:
        model.link(interaction, ds)
    simulation = sk.TimeStepping(model, sk.TimeDiscretisation(0.0, h), osi or sk.MoreauJeanOSI(0.5), sk.LCP())
    simulation.run()
    return simulation.trajectory


class Overridden(sk.LagrangianDS):
    """What pendulum_plugin.cpp has."""

    def computeMass(self, q):
        self.mass()[:] = [[2.0 + 0.5 * np.sin(q[1]), 0.3], [0.3, 1.0 + q[0] ** 2]]

    def computeFInt(self, time, q, v):
        self.fInt()[:] = [30 * q[0] + 5 * q[0] ** 3 + 0.1 * v[1], 20 * q[1] + 0.2 * v[1]]

    def computeFExt(self, time):
        self.fExt()[:] = [4 * np.cos(3 * time), -1.0]


class Circle(sk.LagrangianScleronomousR):
    def computeh(self, q, z, y):
        y[0] = np.hypot(*q) - 0.4

    def computeJachq(self, q, z):
        self.jachq()[0] = q / np.hypot(*q)


class Floor(sk.LagrangianRheonomousR):
    def computeh(self, time, q, z, y):
        y[0] = q[0] - 0.3 * np.sin(5 * time)

    def computehDot(self, time, q, z):
        self.hDot()[0] = -1.5 * np.cos(5 * time)

    def computeJachq(self, time, q, z):
        self.jachq()[0] = [1.0, 0.0]


@pytest.mark.parametrize("scheme", ["MoreauJeanOSI", "HalfExplicitTrapezoidalOSI"])
def test_plugins_move_as_the_same_overrides(pendulum, scheme):
    plugged = sk.LagrangianDS([1.0, 0.2], [0.0, 0.5], f"{pendulum}:mass")
    plugged.setComputeFIntFunction(pendulum, "internal_force")
    plugged.setComputeFExtFunction(pendulum, "external_force")
    circle = sk.LagrangianScleronomousR(f"{pendulum}:distance", f"{pendulum}:gradient")
    runs = [
        run(ds, sk.Interaction(sk.NewtonImpactNSL(0.5), relation), getattr(sk, scheme)(), T=2.0)
        for ds, relation in ((plugged, circle), (Overridden([1.0, 0.2], [0.0, 0.5]), Circle()))
    ]
    assert np.count_nonzero(runs[0].impulsive) >= 3
    assert np.abs(runs[0].q - runs[1].q).max() < 1e-11
    assert np.abs(runs[0].v - runs[1].v).max() < 1e-10


def test_a_plugin_that_depends_on_the_time_moves_as_the_same_override(pendulum):
    names = [f"{pendulum}:height{which}" for which in ("", "_gradient", "_rate")]
    runs = []
    for relation in (sk.LagrangianRheonomousR(*names), Floor()):
        ds = sk.LagrangianLinearTIDS([1.0, 0.0], [0.0, 0.5], np.diag([2.0, 1.0]))
        ds.setFExtPtr([-20.0, 0.0])
        runs.append(run(ds, sk.Interaction(sk.NewtonImpactNSL(0.7), relation), T=3.0))
    assert np.count_nonzero(runs[0].impulsive) > 10
    assert np.abs(runs[0].q - runs[1].q).max() < 1e-12


def test_no_python_is_in_the_loop(pendulum):
    ds = sk.LagrangianDS([1.0, 0.2], [0.0, 0.5], np.eye(2))
    ds.setComputeFIntFunction(pendulum, "internal_force")
    assert isinstance(ds.native(), PluggedDS)
    circle = sk.LagrangianScleronomousR(f"{pendulum}:distance", f"{pendulum}:gradient")
    assert isinstance(circle.native(1), PluggedRelation)
    names = [f"{pendulum}:height{which}" for which in ("", "_gradient", "_rate")]
    assert isinstance(sk.LagrangianRheonomousR(*names).native(1), PluggedRheonomousRelation)


def unsymmetric(own, *jacobians):
    ds = sk.LagrangianDS([0.3, -0.1], [0.0, 1.0], [[2.0, 0.5], [0.5, 1.0]])
    ds.setComputeFIntFunction(own, "linear")
    ds.setComputeFGyrFunction(own, "turn")
    for term, function in jacobians:
        getattr(ds, f"setComputeJacobian{term}Function")(own, function)
    return ds


def test_jacobians_are_column_by_column(own):
    """A linear force in stiff steps, as the matrices of a linear system."""
    given = unsymmetric(
        own,
        ("FIntq", "linear_dq"),
        ("FIntqDot", "linear_dv"),
        ("FGyrq", "turn_dq"),
        ("FGyrqDot", "turn_dv"),
    )
    K, C = [[40, -10], [5, 30]], [[0.3, -2.0], [2.7, 0.2]]
    linear = sk.LagrangianLinearTIDS([0.3, -0.1], [0.0, 1.0], [[2.0, 0.5], [0.5, 1.0]], K, C)
    exact = run(linear, osi=sk.MoreauJeanOSI(1.0), h=0.2, T=4.0)
    for ds in (given, unsymmetric(own)):  # without them derivatives are found by differences
        np.testing.assert_allclose(run(ds, osi=sk.MoreauJeanOSI(1.0), h=0.2, T=4.0).q, exact.q, atol=1e-12)
    model = native.NonSmoothDynamicalSystem([given.native()])
    assert model.check().ok


def test_rows_of_a_relation_are_column_by_column(own):
    law = sk.NewtonImpactFrictionNSL(0.5, 0.0, 0.2, 2)
    ends = []
    for relation in (
        sk.LagrangianScleronomousR(f"{own}:rows", f"{own}:rows_dq"),
        sk.LagrangianLinearTIR([[0.0, 1.0], [1.0, 0.0]]),
    ):
        ds = sk.LagrangianLinearTIDS([0.0, 0.3], [1.0, 0.0], np.eye(2))
        ds.setFExtPtr([0.0, -10.0])
        ends.append(run(ds, sk.Interaction(law, relation), T=2.0))
    assert np.abs(ends[0].q - ends[1].q).max() < 1e-13
    assert np.count_nonzero(ends[0].impulsive) > 3


def test_the_rate_of_a_jacobian_is_for_acceleration_level(own):
    ds = sk.LagrangianLinearTIDS([1.0, 0.0], [0.0, 3.0], 2.0 * np.eye(2))
    names = [f"{own}:circle{which}" for which in ("", "_dq", "_rate")]
    relation = sk.LagrangianScleronomousR(*names)
    trajectory = run(
        ds, sk.Interaction(sk.EqualityConditionNSL(1), relation), sk.DMinusAccelerationOSI(), T=1e-3
    )
    [contact] = trajectory.contacts
    assert trajectory[contact].lambda_plus[1, 0] == pytest.approx(2.0 * 9.0 / 2.0)  # m v²/r = 2 λ


def test_z_are_parameters_that_functions_cannot_change(own):
    ds = sk.LagrangianDS([0.0, 5.0], [1.0, 0.0], np.eye(2))
    ds.setComputeFExtFunction(own, "weight")
    ds.setzPtr([2.0, 9.81])
    trajectory = run(ds, osi=sk.HalfExplicitTrapezoidalOSI())
    np.testing.assert_allclose(trajectory.v[-1], [1.0, -2.0 * 9.81], rtol=1e-13)
    assert list(ds.z()) == [2.0, 9.81]


def test_plugins_and_overrides_go_together(pendulum):
    class Half(sk.LagrangianDS):
        computeFExt = Overridden.computeFExt

    half = Half([1.0, 0.2], [0.0, 0.5], f"{pendulum}:mass")
    half.setComputeFIntFunction(pendulum, "internal_force")
    whole = Overridden([1.0, 0.2], [0.0, 0.5])
    assert np.abs(run(half).q - run(whole).q).max() < 1e-12


def test_terms_can_be_computed_by_the_script(pendulum):
    ds = sk.LagrangianDS([1.0, 0.2], [0.4, 0.5], f"{pendulum}:mass")
    ds.setComputeFIntFunction(pendulum, "internal_force")
    M = [[2.0 + 0.5 * np.sin(0.2), 0.3], [0.3, 2.0]]
    v = np.array([0.4, 0.5])
    assert ds.computeKineticEnergy() == pytest.approx(0.5 * v @ M @ v)
    ds.computeFInt(0.0, ds.q(), ds.velocity())
    np.testing.assert_allclose(ds.fInt(), [35.05, 4.1])


@pytest.mark.parametrize("name", ["pendulum_plugin.so", "libpendulum_plugin.so"])
def test_a_library_lies_beside_the_script(tmp_path, name):
    compiled(PENDULUM, tmp_path / name)
    script = SCRIPT.read_text().replace('"pendulum_plugin.so"', '"pendulum_plugin"')
    (tmp_path / "script.py").write_text(script)
    rows = run_script(tmp_path / "script.py", Changes())["dataPlot"]
    assert rows.shape == (2001, 6)
    assert np.count_nonzero(rows[:, 5]) >= 2


def test_a_library_lies_in_the_current_folder_or_where_a_path_says(pendulum, tmp_path, monkeypatch):
    monkeypatch.chdir(Path(pendulum).parent)
    for library in ("pendulum_plugin", "pendulum_plugin.so", "./pendulum_plugin", pendulum):
        sk.LagrangianDS([1.0, 0.2], [0.0, 0.5], f"{library}:mass")


def test_what_cannot_be_loaded_is_named(own, tmp_path, monkeypatch):
    def mass(plugin):
        return lambda: sk.LagrangianDS([1.0], [0.0], plugin)

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [str(tmp_path / "beside"), *sys.path[1:]])
    (tmp_path / "broken.so").write_text("no library")
    for call, message in (
        (
            mass("Ball:mass"),
            rf"'Ball': expected Ball.so or libBall.so in '{tmp_path}/beside', '{tmp_path}', got none",
        ),
        (mass("there/Ball:mass"), f"expected Ball.so or libBall.so in '{tmp_path}/there', got none"),
        (mass("broken:mass"), "plugin 'broken': the library cannot be loaded: .*broken.so"),
        (mass(f"{own}:mass"), "the library exports no 'mass'"),
        (mass("mass"), "expected a plugin as 'library:function', got 'mass'"),
    ):
        with pytest.raises(ValueError, match=message):
            call()
    with pytest.raises(TypeError, match="takes 3 plugins, got 4"):
        sk.LagrangianScleronomousR(*[f"{own}:rows"] * 4)
    with pytest.raises(NotImplementedError, match=r"must define computeJachq\(self, q, z\)"):
        run(
            sk.LagrangianLinearTIDS([1.0], [0.0], [[1.0]]),
            sk.Interaction(sk.NewtonImpactNSL(0.0), sk.LagrangianScleronomousR(f"{own}:rows")),
        )
