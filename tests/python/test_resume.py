"""A run that goes on elsewhere has the bits of one that was never interrupted."""

import os
import re
import signal
import subprocess
import sys
import textwrap
import time

import h5py
import numpy as np
import pytest
import saltus.kernel as sk
from saltus.examples.disc_pile import disc_pile
from saltus.examples.heavy_top import heavy_top
from saltus.examples.slider_crank import slider_crank
from saltus.examples.woodpecker import woodpecker
from saltus.io import read_hdf5

SCHEMES = [
    *(entry["name"] for entry in sk.integrators()),
    "HalfExplicitTrapezoidalOSI(activity=sticky,stabilization=position)",
    "HalfExplicitTrapezoidalOSI(impulsive_substeps=10)",
    "HalfExplicitRungeKuttaOSI(tableau=HEM5)",
    "AdaptiveHalfExplicitOSI(method=trapezoidal)",
    "DMinusGalerkinOSI(stages=3)",
]
MODELS = {
    "slider crank": (slider_crank.build, 1e-4, 80),
    "heavy top": (heavy_top.build, 1e-3, 60),
    "woodpecker": (woodpecker.build, 1e-4, 200),
    "disc pile": (disc_pile.build, 1e-3, 150),
}


def require_equal(run, other):
    assert len(run) == len(other)
    for name, column in run.columns().items():
        np.testing.assert_array_equal(column, other.columns()[name], err_msg=name)


def simulation(model, scheme, **options):
    build, dt, _ = MODELS[model]
    try:
        return sk.TimeStepping(build(), scheme, dt, **options)
    except ValueError as error:
        pytest.skip(str(error))


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("model", MODELS)
def test_saved_and_loaded(model, scheme, tmp_path):
    whole = simulation(model, scheme)
    _, dt, steps = MODELS[model]
    run = whole.run(steps * dt)
    first = simulation(model, scheme)
    first.run(0.4 * steps * dt)
    second = simulation(model, scheme)
    second.load(first.save(tmp_path / "part.h5"))
    assert second.steps == first.steps
    require_equal(second.trajectory, first.trajectory)
    second.run(0.7 * steps * dt)
    third = simulation(model, scheme)
    third.load(second.save(tmp_path / "part.h5"))
    require_equal(third.run(steps * dt), run)


@pytest.mark.parametrize("every", [1, 7])
def test_a_file_goes_on(tmp_path, every):
    file = tmp_path / "crank.h5"
    run = sk.TimeStepping(slider_crank.build(), "AdaptiveHalfExplicitOSI", 1e-4, record_every=every).run(0.05)
    for until in (0.013, 0.0131, 0.04, 0.05):
        part = sk.TimeStepping(
            slider_crank.build(), "AdaptiveHalfExplicitOSI", 1e-4, record_every=every, file=file, resume=True
        )
        part.run(until)
    require_equal(part.trajectory, run)
    again = read_hdf5(file)
    require_equal(again, run)
    np.testing.assert_array_equal(again.shapes[2].poses, run.shapes[2].poses)
    np.testing.assert_array_equal(again.places[0].point, run.places[0].point)
    assert again.provenance.integrator == "AdaptiveHalfExplicitOSI"


PROGRAM = """
import saltus.kernel as sk
from saltus.examples.slider_crank.slider_crank import build
scheme = "HalfExplicitTrapezoidalOSI(activity=sticky)"
simulation = sk.TimeStepping(build(), scheme, 1e-6, file="run.h5", resume=True, record_every=3)
print("begins", flush=True)
simulation.run(0.3)
print("done", flush=True)
"""


@pytest.mark.parametrize("seed", range(3))
def test_killed_and_resumed(tmp_path, seed):
    whole = sk.TimeStepping(
        slider_crank.build(), "HalfExplicitTrapezoidalOSI(activity=sticky)", 1e-6, record_every=3
    ).run(0.3)
    moments = np.random.default_rng(seed)
    kills = 0
    for _ in range(20):
        process = subprocess.Popen(
            [sys.executable, "-c", textwrap.dedent(PROGRAM)], cwd=tmp_path, stdout=subprocess.PIPE, text=True
        )
        assert process.stdout.readline() == "begins\n"
        if kills < 4:
            time.sleep(moments.uniform(0.0, 0.25))
        if kills < 4 and process.poll() is None:
            os.kill(process.pid, signal.SIGKILL)
            process.wait()
            kills += 1
            if (tmp_path / "run.h5").exists():
                part = read_hdf5(tmp_path / "run.h5")
                np.testing.assert_array_equal(part.q, whole.q[: len(part)])
            continue
        assert process.communicate()[0] == "done\n"
        break
    require_equal(read_hdf5(tmp_path / "run.h5"), whole)


def test_what_a_run_cannot_go_on_with(tmp_path):
    first = sk.TimeStepping(slider_crank.build(), "AdaptiveHalfExplicitOSI", 1e-4)
    first.run(0.01)
    path = first.save(tmp_path / "run.h5")
    for other, said in [
        (
            sk.TimeStepping(slider_crank.build(), "AdaptiveHalfExplicitOSI", 2e-4),
            "its own time_step, 0.0001, got",
        ),
        (sk.TimeStepping(slider_crank.build(), "MoreauJeanOSI", 1e-4), "its own integrator"),
        (
            sk.TimeStepping(slider_crank.build(), "AdaptiveHalfExplicitOSI(rtol=1e-3)", 1e-4),
            "its own options",
        ),
        (sk.TimeStepping(slider_crank.build("frictionless"), "AdaptiveHalfExplicitOSI", 1e-4), "its own"),
        (sk.TimeStepping(slider_crank.build(), "AdaptiveHalfExplicitOSI", 1e-4, tolerance=1e-9), "tolerance"),
        (
            sk.TimeStepping(slider_crank.build(), "AdaptiveHalfExplicitOSI", 1e-4, record_every=2),
            "record_every",
        ),
    ]:
        with pytest.raises(ValueError, match=said):
            other.load(path)
        assert other.steps == 0
        assert len(other.trajectory) == 1
    for height, fits in ((1.0, True), (2.0, False)):
        ball = sk.LagrangianLinearTIDS([height], [0.0], [[1.0]], external_force=[-9.81])
        other = sk.TimeStepping(sk.NonSmoothDynamicalSystem([ball]), "MoreauJeanOSI", 0.1)
        if fits:
            other.run(0.5)
            ball_path = other.save(tmp_path / "ball.h5")
        else:
            with pytest.raises(ValueError, match="a model of the same q0"):
                other.load(ball_path)
    with pytest.raises(ValueError, match="got no checkpoint"):
        sk.TimeStepping(slider_crank.build(), "AdaptiveHalfExplicitOSI", 1e-4).load(
            first.trajectory.to_hdf5(tmp_path / "arrays.h5")
        )
    with pytest.raises(ValueError, match="resume needs a file"):
        sk.TimeStepping(slider_crank.build(), "AdaptiveHalfExplicitOSI", 1e-4, resume=True)
    streaming = sk.TimeStepping(
        slider_crank.build(), "AdaptiveHalfExplicitOSI", 1e-4, file=tmp_path / "own.h5"
    )
    with pytest.raises(ValueError, match="goes on by resume=True"):
        streaming.load(path)


def test_a_run_goes_on_only_with_its_own_shapes(tmp_path):
    def build(shape):
        ball = sk.LagrangianLinearTIDS([1.0], [0.0], [[1.0]], external_force=[-9.81])
        if shape:
            ball.add_shape(sk.Disc(0.1), lambda q: (0.0, q[0], 0.0))
        return sk.NonSmoothDynamicalSystem([ball])

    path = tmp_path / "run.h5"
    sk.TimeStepping(build(True), "MoreauJeanOSI", 0.1, file=path).run(0.5)
    for shape in (False, True):
        if shape:
            assert sk.TimeStepping(build(True), "MoreauJeanOSI", 0.1, file=path, resume=True).steps == 5
            continue
        with pytest.raises(ValueError, match="its own shapes and places of contacts, 1 and 0, got 0 and 0"):
            sk.TimeStepping(build(False), "MoreauJeanOSI", 0.1, file=path, resume=True)
        assert len(read_hdf5(path)) == 6


def test_a_run_that_is_cut_off_is_refused_at_once(tmp_path):
    path = tmp_path / "run.h5"
    sk.TimeStepping(slider_crank.build(), "MoreauJeanOSI", 1e-4, file=path).run(0.02)
    content = path.read_bytes()
    for part in (0.1, 0.5, 0.9):
        path.write_bytes(content[: int(part * len(content))])
        script = f"import saltus.io; saltus.io.read_hdf5({str(path)!r})"  # elsewhere: it must not wait
        done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
        assert "truncated file" in done.stderr


def test_a_checkpoint_that_is_torn_does_not_count(tmp_path):
    file = tmp_path / "run.h5"
    simulation = sk.TimeStepping(slider_crank.build(), "HalfExplicitTrapezoidalOSI", 1e-4, file=file)
    simulation.run(0.01)
    simulation.run(0.02)
    with h5py.File(file, "r+") as data:
        slots = [data["checkpoint"][name][:] for name in ("0", "1")]
        assert all(len(slot) for slot in slots)
        data["checkpoint/1"][-20:] = 0
    other = sk.TimeStepping(slider_crank.build(), "HalfExplicitTrapezoidalOSI", 1e-4, file=file, resume=True)
    assert other.steps in (100, 200)
    run = sk.TimeStepping(slider_crank.build(), "HalfExplicitTrapezoidalOSI", 1e-4).run(0.03)
    require_equal(other.run(0.03), run)


def test_checkpoints_that_do_not_fit():
    simulation = sk.TimeStepping(slider_crank.build(), "AdaptiveHalfExplicitOSI", 1e-4)
    simulation.run(0.01)
    values = simulation.checkpoint()
    for change, said in [
        ({"q": np.zeros(2)}, "q of a checkpoint must have 3 entries, got 2"),
        ({"v": [0.0, np.nan, 0.0]}, "finite q and v"),
        ({"impulse": np.zeros(1)}, "reactions of a checkpoint must have 8 entries"),
        ({"memory": values["memory"][:-1]}, "memory of a scheme must be that of the same scheme"),
        ({"memory": np.append(values["memory"], 0.0)}, "memory of a scheme must be that of the same scheme"),
    ]:
        with pytest.raises(ValueError, match=said):
            simulation.restore({**values, **change})
    with pytest.raises(ValueError, match="carries nothing from step to step"):
        sk.TimeStepping(slider_crank.build(), "HalfExplicitTrapezoidalOSI", 1e-4).restore(values)
    with pytest.raises(ValueError, match="a checkpoint must have 'q'"):
        simulation.restore({"step": 1, "t": 0.0})


class Alternating(sk.OneStepIntegrator):
    """Takes every other step with the velocity of its start: what it remembers decides."""

    def prepare(self, system, solver):
        self.odd = 0.0

    def step(self, dt, state, reactions):
        v = np.array(state.v) - 9.81 * dt
        state.q = np.array(state.q) + dt * (state.v if self.odd else v)
        state.v = v
        self.odd = 1.0 - self.odd
        return sk.StepReport()


class Remembering(Alternating):
    def memory(self):
        return [self.odd]

    def remember(self, memory):
        (self.odd,) = memory


class Forgetful(Alternating):
    def memory(self):
        return [self.odd]


def falling(scheme):
    ball = sk.LagrangianLinearTIDS([1.0], [0.0], [[1.0]])
    return sk.TimeStepping(sk.NonSmoothDynamicalSystem([ball]), scheme, 0.1)


def test_an_integrator_in_python_remembers(tmp_path):
    for scheme, equal in ((Remembering, True), (Alternating, False)):
        whole = falling(scheme()).run(1.0)
        first = falling(scheme())
        first.run(0.3)
        second = falling(scheme())
        second.load(first.save(tmp_path / "run.h5"))
        assert (second.run(1.0).q == whole.q).all() == equal
    first = falling(Forgetful())
    first.run(0.3)
    second = falling(Forgetful())
    with pytest.raises(NotImplementedError, match=r"Forgetful must define remember\(self, memory\)"):
        second.load(first.save(tmp_path / "run.h5"))


def test_an_interrupted_run_says_how_to_go_on(tmp_path):
    program = textwrap.dedent(PROGRAM).replace("0.3)", "1e3, progress=True)")
    process = subprocess.Popen(
        [sys.executable, "-c", program],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # what runs in the background ignores Ctrl-C, and so would its children
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    assert process.stdout.readline() == "begins\n"
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60)
    step = int(
        re.search(r"KeyboardInterrupt: the run ended after step (\d+) at .*resume=True goes on", said)[1]
    )
    steps, rate = re.search(r"(\d+) steps in .* s, (\S+) steps/s", said).groups()
    assert int(steps) == step > 1000
    assert float(rate) > 1000
    last = read_hdf5(tmp_path / "run.h5")
    assert last.step[-1] == step - step % 3 or last.impulsive[-1]
    scheme = "HalfExplicitTrapezoidalOSI(activity=sticky)"
    again = sk.TimeStepping(
        slider_crank.build(), scheme, 1e-6, file=tmp_path / "run.h5", resume=True, record_every=3
    )
    assert again.steps <= step
    whole = sk.TimeStepping(slider_crank.build(), scheme, 1e-6, record_every=3)
    until = (step + 100) * 1e-6
    require_equal(again.run(until), whole.run(until))


def test_progress_of_a_run_without_steps(capfd):
    falling("ExplicitMoreauJeanOSI").run(0.0, progress=True)
    assert "0 steps in" in capfd.readouterr().err
