"""Integrators and contact solvers from outside: Python classes, and a project of its own."""

import gc
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import saltus.kernel as sk
import saltus.numerics as sn
from saltus import conformance, registry
from saltus.examples.bouncing_ball import bouncing_ball
from saltus.examples.extending.trapezoidal_moreau import TrapezoidalMoreauOSI
from saltus.examples.slider_crank import slider_crank

ROOT = Path(__file__).resolve().parents[2]
OWN = "saltus.examples.extending.trapezoidal_moreau:TrapezoidalMoreauOSI"


@pytest.fixture(scope="session")
def plugin(build_project):
    """The out-of-tree project."""
    return build_project(ROOT / "examples/extending/plugin") / "libown.so"


@pytest.fixture(scope="session")
def registered():
    """Join the table while tests run, not before: other files iterate it when tests are collected."""
    sk.register_integrator(ScaledEulerOSI)
    sn.register_solver(GaussSeidelInPython)
    sn.register_solver(Liar)


def names_of_integrators():
    return [entry["name"] for entry in sk.integrators()]


def run(system, scheme, dt, until, **options):
    return sk.TimeStepping(system, scheme, dt, **options).run(until)


@pytest.mark.parametrize("name", names_of_integrators())
def test_registered_integrators_conform(name):
    findings = conformance.check(name)
    assert len(findings) >= 9
    assert all(finding.ok for finding in findings), "\n".join(map(str, findings))


def test_an_integrator_in_python_conforms():
    findings = conformance.check(OWN)
    assert all(finding.ok for finding in findings), "\n".join(map(str, findings))
    assert "TrapezoidalMoreauOSI" in names_of_integrators()
    assert isinstance(sk.TrapezoidalMoreauOSI(), TrapezoidalMoreauOSI)


def test_an_integrator_of_a_plugin_conforms(plugin):
    findings = conformance.check(f"{plugin}:TrapezoidalMoreau")
    assert all(finding.ok for finding in findings), "\n".join(map(str, findings))
    assert registry.integrator(f"{plugin.with_name('own')}:TrapezoidalMoreau").name == "TrapezoidalMoreau"


def test_the_same_scheme_in_python_and_as_plugin(plugin):
    python = run(slider_crank.build(), OWN, 1e-4, 0.05)
    cpp = run(slider_crank.build(), f"{plugin}:TrapezoidalMoreau", 1e-4, 0.05)
    assert np.abs(python.q - cpp.q).max() < 1e-12
    assert np.array_equal(python.impulsive, cpp.impulsive)
    assert np.abs(python.kinetic_energy - cpp.kinetic_energy).max() < 1e-12


def test_a_solver_of_a_plugin(plugin):
    name = f"{plugin}:ProjectedSor"
    theirs = run(bouncing_ball.build(), "HalfExplicitTrapezoidalOSI", 1e-3, 5.0, solver=name)
    own = run(bouncing_ball.build(), "HalfExplicitTrapezoidalOSI", 1e-3, 5.0)
    assert np.abs(theirs.q - own.q).max() < 1e-10
    assert "projected-sor" in sn.solvers()
    with pytest.raises(ValueError, match="'projected-sor' does not accept"):
        run(slider_crank.build(), "HalfExplicitTrapezoidalOSI", 1e-3, 0.1, solver=name)


def test_model_functions_of_a_plugin(plugin):
    mass, linear, cubic = 2.0, 10.0, 5.0
    ball = sk.LagrangianDS(
        [0.5],
        [0.0],
        f"{plugin}:ball_mass",
        forces=f"{plugin}:ball_forces",
        parameters=[mass, linear, cubic],
    )
    system = sk.NonSmoothDynamicalSystem([ball])
    relation = sk.LagrangianScleronomousR(1, gap=f"{plugin}:floor_gap", jacobian=f"{plugin}:floor_jacobian")
    system.link(sk.Interaction(relation, sk.NewtonImpactNSL(0.0), name="floor"), ball)
    trajectory = run(system, "HalfExplicitTrapezoidalOSI", 1e-4, 2.0)
    # Energy before the plastic impact, and the weight on the floor after it
    free = ~np.cumsum(trajectory.impulsive).astype(bool)
    q, v = trajectory.q[free, 0], trajectory.v[free, 0]
    energy = mass * (0.5 * v**2 + 9.81 * q) + 0.5 * linear * q**2 + 0.25 * cubic * q**4
    assert np.abs(energy - energy[0]).max() < 1e-6
    rest = trajectory.q[-1, 0]
    assert trajectory["floor"].force[-1, 0] == pytest.approx(9.81 * mass + linear * rest, abs=1e-9)


def test_a_plugin_for_another_abi_is_refused_by_name(tmp_path):
    source = tmp_path / "old.cpp"
    source.write_text(
        "struct Plugin { const char* abi; void* (*entry)(); };\n"
        "static void* crash() { return *static_cast<void**>(nullptr); }\n"
        'extern "C" {\n'
        "extern const Plugin saltus_integrator_Old, saltus_contact_solver_Old;\n"
        'const Plugin saltus_integrator_Old{"saltus 0", crash};\n'
        'const Plugin saltus_contact_solver_Old{"saltus 0", crash};\n'
        "}\n"
    )
    subprocess.run(["g++", "-shared", "-fPIC", source, "-o", tmp_path / "libold.so"], check=True)
    name = f"{tmp_path / 'libold.so'}:Old"
    with pytest.raises(
        ValueError, match=r"libold.so:Old': it was built for the ABI 'saltus 0', this is 'saltus 8"
    ):
        registry.integrator(name)
    with pytest.raises(ValueError, match=r"libold.so:Old': it was built for the ABI 'saltus 0'"):
        registry.solver(name)


def test_bench_runs_an_integrator_written_in_python():
    command = [
        Path(sys.executable).parent / "saltus",
        "bench",
        "bouncing-ball",
        "--integrator",
        OWN,
        "--json",
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    [result] = json.loads(done.stdout)["results"]
    assert result["model"] == "bouncing-ball"
    assert result["integrator"] == "TrapezoidalMoreauOSI"
    assert result["us_per_step"] > 0


class ScaledEulerOSI(sk.OneStepIntegrator):
    """Explicit Euler whose step is scaled: an option of its own."""

    properties = {"friction": False}

    def __init__(self, factor=1.0, mode="plain"):
        super().__init__()
        self.factor, self.mode = factor, mode

    def prepare(self, system, solver):
        self.at = sk.Configuration(system)

    def step(self, dt, state, reactions):
        self.at.move_to(state.q)
        a = self.at.solve_mass(self.at.forces(state.t, state.v))
        state.q, state.v = state.q + self.factor * dt * state.v, state.v + self.factor * dt * a
        state.t += dt
        return sk.StepReport()


def oscillator():
    return sk.NonSmoothDynamicalSystem([sk.LagrangianLinearTIDS([1.0], [0.0], [[1.0]], [[4.0]])])


@pytest.mark.usefixtures("registered")
@pytest.mark.filterwarnings("ignore::saltus.kernel.StabilityWarning")
def test_options_of_a_python_integrator():
    [entry] = [e for e in sk.integrators() if e["name"] == "ScaledEulerOSI"]
    assert {key: about["default"] for key, about in entry["options"].items()} == {
        "factor": 1.0,
        "mode": "plain",
    }
    assert entry["properties"]["friction"] is False
    one = run(oscillator(), sk.ScaledEulerOSI(factor=2.0), 1e-3, 1e-3)
    assert one.v[-1, 0] == pytest.approx(-8e-3, rel=1e-12)
    with pytest.raises(ValueError, match="ScaledEulerOSI has no option 'size'"):
        sk.ScaledEulerOSI(size=1.0)
    with pytest.raises(ValueError, match="factor must be a number"):
        sk.ScaledEulerOSI(factor="big")


@pytest.mark.filterwarnings("ignore::saltus.kernel.StabilityWarning")
def test_simulations_take_copies_of_a_python_integrator():
    scheme = ScaledEulerOSI()
    first = sk.TimeStepping(oscillator(), scheme, 1e-3)
    scheme.factor = 2.0  # not seen by the first
    second = sk.TimeStepping(oscillator(), scheme, 1e-3)
    del scheme
    first.step()
    second.step()
    assert first.v == pytest.approx([-4e-3], rel=1e-12)
    assert second.v == pytest.approx([-8e-3], rel=1e-12)


def failing(error=None, **changes):
    class FailingOSI(sk.OneStepIntegrator):
        def prepare(self, system, solver):
            self.at = sk.Configuration(system)

        def step(self, dt, state, reactions):
            if state.t < 2.5e-3:
                state.t += dt
                return sk.StepReport()
            state.v = [7.0]
            if error:
                raise error
            for name, value in changes.items():
                setattr(state, name, value)
            return None if changes.get("t") == 0 else sk.StepReport()

    return FailingOSI()


def test_failures_of_a_python_integrator():
    simulation = sk.TimeStepping(oscillator(), failing(RuntimeError("mine")), 1e-3)
    with pytest.raises(RuntimeError, match="mine"):
        simulation.run(1.0)
    assert simulation.steps == 3
    assert simulation.v == pytest.approx([0.0])  # as before the step

    simulation = sk.TimeStepping(oscillator(), failing(v=[np.inf]), 1e-3)
    with pytest.raises(sk.SimulationError, match="not finite"):
        simulation.run(1.0)
    assert simulation.v == pytest.approx([0.0])

    with pytest.raises(TypeError, match="FailingOSI.step must return a StepReport, got NoneType"):
        sk.TimeStepping(oscillator(), failing(t=0.0), 1e-3).run(1.0)
    with pytest.raises(ValueError, match="v must have 1 entries, got 2"):
        sk.TimeStepping(oscillator(), failing(v=[1.0, 2.0]), 1e-3).run(1.0)


def test_an_integrator_can_give_up():
    class GivingUpOSI(sk.OneStepIntegrator):
        def prepare(self, system, solver):
            pass

        def step(self, dt, state, reactions):
            raise sk.StepFailure("no step")

    with pytest.raises(sk.SimulationError, match="iteration for the velocities does not converge"):
        run(bouncing_ball.build(), GivingUpOSI(), 1e-3, 1.0)


def test_a_nan_impulse_is_a_failure():
    class NanOSI(sk.OneStepIntegrator):
        def prepare(self, system, solver):
            pass

        def step(self, dt, state, reactions):
            reactions.impulse = [np.nan]
            return sk.StepReport()

    with pytest.raises(sk.SimulationError, match="not finite"):
        run(bouncing_ball.build(), NanOSI(), 1e-3, 1.0)


def test_parts_outlive_the_simulation_that_made_them():
    kept = {}

    class KeepingOSI(sk.OneStepIntegrator):
        def prepare(self, system, solver):
            kept.update(system=system, at=sk.Configuration(system), stage=sk.ContactStage(system, solver))

        def step(self, dt, state, reactions):
            return sk.StepReport()

    sk.TimeStepping(bouncing_ball.build(), KeepingOSI(), 1e-3)  # gone at once
    gc.collect()
    hit = kept["stage"].solve([0], kept["at"], kept["at"], [-2.0])
    assert hit.velocity == pytest.approx([2.0])
    assert sk.Configuration(kept["system"]).q == pytest.approx([1.0])


def test_a_configuration_of_another_system_is_refused():
    class MixingOSI(sk.OneStepIntegrator):
        def prepare(self, system, solver):
            other = sk.Configuration(oscillator())
            sk.ContactStage(system, solver).solve([0], other, other, [0.0])

    with pytest.raises(ValueError, match="configurations of the system of this ContactStage"):
        sk.TimeStepping(bouncing_ball.build(), MixingOSI(), 1e-3)


def test_two_classes_of_one_name_are_not_mixed_up(tmp_path):
    source = (ROOT / "examples/extending/trapezoidal_moreau.py").read_text()
    for folder, name in (("a", "TwiceOSI"), ("b", "TwiceOSI"), ("c", "MoreauJeanOSI")):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "own.py").write_text(source.replace("TrapezoidalMoreauOSI", name))
    assert registry.integrator(f"{tmp_path}/a/own.py:TwiceOSI").name == "TwiceOSI"
    assert registry.integrator(f"{tmp_path}/a/own.py:TwiceOSI").name == "TwiceOSI"
    with pytest.raises(ValueError, match="there is one named 'TwiceOSI' already"):
        registry.integrator(f"{tmp_path}/b/own.py:TwiceOSI")
    with pytest.raises(ValueError, match="there is one named 'MoreauJeanOSI' already"):
        registry.integrator(f"{tmp_path}/c/own.py:MoreauJeanOSI")


def test_a_file_that_cannot_be_imported_is_named_each_time(tmp_path):
    path = tmp_path / "broken.py"
    path.write_text("raise RuntimeError('mine')")
    for _ in range(2):
        with pytest.raises(ValueError, match=r"broken.py' cannot be imported: RuntimeError: mine"):
            registry.integrator(f"{path}:OSI")


def test_a_part_that_fails_ends_the_run_with_its_status():
    class LostOSI(sk.OneStepIntegrator):
        def prepare(self, system, solver):
            self.at = sk.Configuration(system)

        def step(self, dt, state, reactions):
            self.at.move_to([np.nan])
            return sk.StepReport()

    with pytest.raises(sk.SimulationError, match="a gap is not finite"):
        sk.TimeStepping(bouncing_ball.build(), LostOSI(), 1e-3).run(1.0)


class GaussSeidelInPython(sn.ContactSolver):
    """Gauss-Seidel without friction."""

    def accepts(self, sets):
        return all(isinstance(s, sn.NonNegative) for s in sets)

    def solve(self, G, b, sets, P):
        for _ in range(100):
            for i in range(len(b)):
                if G[i, i] > 0:
                    P[i] = max(0.0, P[i] - (G[i] @ P + b[i]) / G[i, i])
        return 100


class Liar(sn.ContactSolver):
    """Says nothing, does nothing."""

    def solve(self, G, b, sets, P):
        P[:] = 1.0


@pytest.mark.usefixtures("registered")
def test_contact_solvers_in_python():
    solution = sn.solve([[2.0, 1.0], [1.0, 2.0]], [-1.0, 3.0], [sn.NonNegative()] * 2, "GaussSeidelInPython")
    assert solution.status == "solved"
    assert solution.iterations == 100
    assert pytest.approx([0.5, 0.0], abs=1e-15) == solution.P
    with pytest.raises(ValueError, match="'GaussSeidelInPython' does not accept"):
        sn.solve(np.eye(2), [-1.0, 0.0], [sn.Coulomb(0.1)], "GaussSeidelInPython")
    trajectory = run(
        bouncing_ball.build(), "HalfExplicitTrapezoidalOSI", 1e-3, 5.0, solver="GaussSeidelInPython"
    )
    assert trajectory["floor"].force[-1, 0] == pytest.approx(9.81, abs=1e-9)


@pytest.mark.usefixtures("registered")
def test_a_contact_solver_is_not_believed():
    solution = sn.solve([[2.0]], [-1.0], [sn.NonNegative()], "Liar")
    assert solution.status == "breakdown"
    assert solution.residual == pytest.approx(1.0)
    with pytest.raises(sk.SimulationError, match="no impulses that satisfy"):
        run(bouncing_ball.build(), "HalfExplicitTrapezoidalOSI", 1e-3, 5.0, solver="Liar")


@pytest.mark.usefixtures("registered")
def test_what_cannot_join_the_registry_is_refused():
    with pytest.raises(ValueError, match="there is one named 'ScaledEulerOSI' already"):
        sk.register_integrator(ScaledEulerOSI)
    with pytest.raises(TypeError, match="derived from OneStepIntegrator"):
        sk.register_integrator(int)
    with pytest.raises(TypeError, match="derived from ContactSolver"):
        sn.register_solver(ScaledEulerOSI)

    class NoDefaultOSI(sk.OneStepIntegrator):
        def __init__(self, factor):
            super().__init__()

    with pytest.raises(TypeError, match="factor must default to a number or a word"):
        sk.register_integrator(NoDefaultOSI)

    class WrongOSI(sk.OneStepIntegrator):
        properties = {"order": 2}

    with pytest.raises(ValueError, match="properties has no 'order', it has friction"):
        sk.register_integrator(WrongOSI)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("NoSuchOSI", "no integrator named 'NoSuchOSI', there are ExplicitMoreauJeanOSI"),
        ("./nowhere:OSI", "cannot be loaded"),
        ("nowhere.py:OSI", "there is no file 'nowhere.py'"),
        ("saltus.kernel:NoSuchOSI", "'saltus.kernel' has no class 'NoSuchOSI'"),
        (":OSI", "library:name"),
    ],
)
def test_integrators_that_are_not_there(name, message):
    with pytest.raises((ValueError, TypeError), match=message):
        sk.TimeStepping(oscillator(), name, 1e-3)


def test_an_integrator_in_a_file(tmp_path):
    source = (ROOT / "examples/extending/trapezoidal_moreau.py").read_text()
    path = tmp_path / "mine.py"
    path.write_text(source.replace("TrapezoidalMoreauOSI", "MineOSI"))
    lines = source[source.index("class ") :].splitlines()
    assert len(lines) < 60  # what an integrator in Python takes
    trajectory = run(bouncing_ball.build(), f"{path}:MineOSI", 1e-3, 1.0)
    again = run(bouncing_ball.build(), OWN, 1e-3, 1.0)
    assert np.array_equal(trajectory.q, again.q)
