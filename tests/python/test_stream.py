"""Runs that go to a file while they go on."""

import gc
import os
import random
import signal
import subprocess
import sys
import textwrap
import time

import h5py
import numpy as np
import pytest
import saltus.kernel as sk
from saltus.examples.slider_crank.slider_crank import build
from saltus.io import hdf5, read_hdf5, stream
from test_models import Pendulum, ball

SCHEME = "HalfExplicitTrapezoidalOSI"


@pytest.fixture(autouse=True)
def _small_chunks(monkeypatch):
    monkeypatch.setattr(hdf5, "CHUNK_BYTES", 20_000)


def simulate(path=None, *, dt=1e-4, **options):
    return sk.TimeStepping(build(), SCHEME, dt, file=path, **options)


def assert_same(run, expected, rows=None):
    for name, values in expected.columns().items():
        np.testing.assert_array_equal(run.columns()[name], values[:rows], err_msg=name)
        assert run.columns()[name].dtype == values.dtype
    for shape, original in zip(run.shapes, expected.shapes, strict=True):
        np.testing.assert_array_equal(shape.poses, original.poses[:rows])


@pytest.mark.parametrize("record_every", [1, 7])
def test_a_streamed_run_is_the_one_in_memory(tmp_path, record_every):
    path = tmp_path / "run.h5"
    streamed = simulate(path, record_every=record_every).run(0.1)
    memory = simulate(record_every=record_every).run(0.1)
    assert len(streamed) == len(memory)
    assert_same(streamed, memory)
    assert_same(read_hdf5(path), memory)
    assert os.listdir(tmp_path) == ["run.h5"]


def tree(path):
    """All names, attributes, types and numbers of entries in a file."""
    found = {}

    def visit(name, item):
        shape = (item.shape, item.dtype) if isinstance(item, h5py.Dataset) else None
        found[name] = shape, dict(item.attrs)

    with h5py.File(path) as file:
        visit("", file)
        file.visititems(visit)
    return found


def test_both_ways_lead_to_the_same_layout(tmp_path):
    simulate(tmp_path / "streamed.h5").run(0.05)
    simulate().run(0.05).to_hdf5(tmp_path / "memory.h5")
    streamed, memory = tree(tmp_path / "streamed.h5"), tree(tmp_path / "memory.h5")
    for file in (streamed, memory):
        del file[""][1]["provenance"]  # the time is in it
        for slot in ("0", "1"):  # trajectories have none
            del file[f"checkpoint/{slot}"]
    assert streamed == memory
    assert all("unit" in attrs for shape, attrs in memory.values() if shape)


def test_a_run_goes_on_in_the_same_file(tmp_path):
    simulation = simulate(tmp_path / "run.h5")
    half = simulation.run(0.05)
    assert len(read_hdf5(tmp_path / "run.h5")) == 501
    whole = simulation.run(0.1)
    assert half is whole
    assert_same(whole, simulate().run(0.1))
    assert_same(read_hdf5(tmp_path / "run.h5"), whole)


def test_single_steps_are_in_the_file_when_they_are_looked_at(tmp_path):
    simulation = simulate(tmp_path / "run.h5")
    for _ in range(100):
        simulation.step()
    assert 46 <= len(read_hdf5(tmp_path / "run.h5")) <= 101  # the last chunk is on its way
    assert len(simulation.trajectory) == 101
    assert simulation.trajectory.t[-1] == simulation.t
    assert len(read_hdf5(tmp_path / "run.h5")) == 101
    for _ in range(5):
        simulation.step()
    del simulation
    gc.collect()
    assert len(read_hdf5(tmp_path / "run.h5")) == 106


def test_single_steps_are_in_the_file_when_the_program_ends(tmp_path):
    code = """
        import saltus.kernel as sk
        from saltus.examples.slider_crank.slider_crank import build
        simulation = sk.TimeStepping(build(), "HalfExplicitTrapezoidalOSI", 1e-4, file="run.h5")
        for _ in range(9): simulation.step()
    """
    subprocess.run([sys.executable, "-c", textwrap.dedent(code)], cwd=tmp_path, check=True)
    assert len(read_hdf5(tmp_path / "run.h5")) == 10


def test_observers_see_the_run_so_far(tmp_path):
    simulation = simulate(tmp_path / "run.h5")
    seen = []
    simulation.observe(lambda step, *_: step % 300 or seen.append(len(simulation.trajectory.q)))
    simulation.run(0.1)
    assert seen == [1, 301, 601, 901]


KILLED = """
    from saltus.io import hdf5, stream
    hdf5.CHUNK_BYTES, stream.SECONDS = 20_000, 0.003
    import saltus.kernel as sk
    from saltus.examples.slider_crank.slider_crank import build
    simulation = sk.TimeStepping(build(), "HalfExplicitTrapezoidalOSI", 1e-6, file="run.h5")
    print("ready", flush=True)
    simulation.run(10.0)
"""


def test_a_killed_run_is_readable_up_to_its_last_chunk(tmp_path):
    expected = simulate(dt=1e-6).run(0.1)
    moment = random.Random(7)
    lengths = []
    for _ in range(6):
        code = textwrap.dedent(KILLED)
        process = subprocess.Popen([sys.executable, "-c", code], cwd=tmp_path, stdout=subprocess.PIPE)
        assert process.stdout.readline() == b"ready\n"
        time.sleep(moment.uniform(0.0, 0.4))
        lengths.append(len(read_hdf5(tmp_path / "run.h5")))  # while it is written
        process.send_signal(signal.SIGKILL)
        process.wait()
        run = read_hdf5(tmp_path / "run.h5")
        assert lengths[-1] <= len(run) < len(expected)
        assert_same(run, expected, rows=len(run))
        lengths.append(len(run))
    assert max(lengths) > 100
    assert len(simulate(tmp_path / "run.h5").run(0.001)) == 11  # a killed run makes room for the next


@pytest.mark.parametrize("flush", ["not done", "done"])
def test_a_half_written_chunk_does_not_count(tmp_path, flush):
    """Killed before or after the rows are in the file, but before they count."""
    code = """
        import os, signal, sys
        import h5py
        real, calls = h5py.File.flush, []

        def flush(self):
            calls.append(self)
            last = len(calls) == 16  # the first of three for the sixth chunk
            if not last or sys.argv[1] == "done":
                real(self)
            if last:
                os.kill(os.getpid(), signal.SIGKILL)

        h5py.File.flush = flush
    """
    code = textwrap.dedent(code) + textwrap.dedent(KILLED).replace("0.003", "1e9")
    process = subprocess.run(
        [sys.executable, "-c", code, flush], cwd=tmp_path, stdout=subprocess.PIPE, check=False
    )
    assert process.returncode == -signal.SIGKILL
    run = read_hdf5(tmp_path / "run.h5")
    chunk = (len(run) - 1) // 4  # row 0 stands alone
    assert len(run) == 1 + 4 * chunk > 100
    assert_same(run, simulate(dt=1e-6).run(0.001), rows=len(run))
    with h5py.File(tmp_path / "run.h5", swmr=True) as file:
        assert len(file["columns/t"]) == len(run) + (chunk if flush == "done" else 0)


class Failing(Pendulum):
    def __init__(self, error):
        super().__init__([0.1], [0.0])
        self.error = error

    def forces(self, t, q, v, out):
        super().forces(t, q, v, out)
        if t > 0.499:
            if self.error is not None:
                raise self.error
            out[0] = np.nan


def run(simulation):
    simulation.run(1.0)


def steps(simulation):
    while simulation.t < 1.0:
        simulation.step()


@pytest.mark.parametrize(
    ("error", "run_or_step"),
    [(None, run), (None, steps), (ZeroDivisionError("by the model"), run), (KeyboardInterrupt(), run)],
)
def test_whatever_ends_a_run_leaves_a_closed_file_with_all_of_it(tmp_path, error, run_or_step):
    system = sk.NonSmoothDynamicalSystem([Failing(error)])
    simulation = sk.TimeStepping(system, SCHEME, 1e-3, file=tmp_path / "run.h5")
    expected = sk.SimulationError if error is None else type(error)
    with pytest.raises(expected) as caught:
        run_or_step(simulation)
    assert simulation.steps == 499
    with h5py.File(tmp_path / "run.h5") as file:  # refused while another has it open for writing
        assert file["rows"][()] == 500
    if error is None:
        assert len(caught.value.trajectory) == 500


def test_an_interrupt_while_a_chunk_is_written_doubles_nothing(tmp_path, monkeypatch):
    simulation = simulate(tmp_path / "run.h5")
    write = hdf5.RunFile.write

    def interrupted(self, start, *rest):
        write(self, start, *rest)
        if start > 100:
            monkeypatch.undo()
            raise KeyboardInterrupt

    monkeypatch.setattr(hdf5.RunFile, "write", interrupted)
    with pytest.raises(KeyboardInterrupt):
        simulation.run(0.1)
    simulation.run(0.1)
    assert_same(read_hdf5(tmp_path / "run.h5"), simulate().run(0.1))


def test_a_full_disk_ends_the_run_and_keeps_what_is_written(tmp_path, monkeypatch):
    simulation = simulate(tmp_path / "run.h5")
    simulation.run(0.02)
    statvfs = os.statvfs
    monkeypatch.setattr(os, "statvfs", lambda path: os.statvfs_result((4096, 4096, 9, 9, 9, 9, 9, 9, 9, 9)))
    with pytest.raises(OSError, match=r"cannot write '.*run.h5'.*No space left on device"):
        simulation.run(0.1)
    assert simulation.steps < 300
    assert len(read_hdf5(tmp_path / "run.h5")) == 201
    monkeypatch.setattr(os, "statvfs", statvfs)
    assert_same(simulation.run(0.1), simulate().run(0.1))  # nothing is lost once there is room again


def test_targets_are_tried_before_the_run(tmp_path):
    (tmp_path / "notes.txt").write_text("kept")
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["data"] = [1.0]
    for name in ("notes.txt", "other.h5"):
        before = (tmp_path / name).read_bytes()
        with pytest.raises(FileExistsError, match=f"{name}': expected a new file or a run to replace"):
            simulate(tmp_path / name)
        with pytest.raises(FileExistsError, match=name):
            simulate().run(1e-3).to_hdf5(tmp_path / name)
        assert (tmp_path / name).read_bytes() == before
    for name in ("no/such/run.h5", "notes.txt/run.h5", "."):
        with pytest.raises(
            OSError, match=r"cannot write '.*': expected a writable file in an existing folder"
        ):
            simulate(tmp_path / name)
    (tmp_path / "empty.h5").touch()
    simulate(tmp_path / "empty.h5")
    assert sorted(os.listdir(tmp_path)) == ["empty.h5", "notes.txt", "other.h5"]


def test_a_refused_model_costs_no_file(tmp_path):
    path = simulate().run(1e-3).to_hdf5(tmp_path / "run.h5")
    before = path.read_bytes()
    with pytest.raises(ValueError, match="time_step must be positive"):
        simulate(path, dt=-1.0)
    system = build()
    system.systems[0].add_shape(sk.Disc(0.1), pose=lambda q: (0.0, 0.0))
    with pytest.raises(ValueError, match="three finite numbers"):
        sk.TimeStepping(system, SCHEME, 1e-4, file=path)
    assert path.read_bytes() == before
    assert os.listdir(tmp_path) == ["run.h5"]


def test_a_run_that_was_replaced_is_not_mistaken_for_the_other(tmp_path):
    first = simulate(tmp_path / "run.h5")
    early = first.run(0.01)
    simulate(tmp_path / "run.h5").run(0.02)
    with pytest.raises(OSError, match="must hold this run, got another one that has replaced it"):
        _ = early.q
    with pytest.raises(OSError, match="must hold this run, got another one that has replaced it"):
        first.run(0.05)
    assert len(read_hdf5(tmp_path / "run.h5")) == 201


def test_a_model_without_contacts(tmp_path):
    system = sk.NonSmoothDynamicalSystem([Pendulum([0.1], [0.0])])
    streamed = sk.TimeStepping(system, SCHEME, 1e-2, file=tmp_path / "run.h5").run(3.0)
    assert streamed.columns()["gap"].shape == (301, 0)
    assert_same(read_hdf5(tmp_path / "run.h5"), sk.TimeStepping(system, SCHEME, 1e-2).run(3.0))


def test_a_slow_run_does_not_keep_its_rows(tmp_path, monkeypatch):
    monkeypatch.setattr(stream, "SECONDS", 0.02)
    simulation = sk.TimeStepping(ball(), SCHEME, 1e-3, file=tmp_path / "run.h5")
    simulation.step()
    time.sleep(0.03)
    simulation.step()
    assert len(read_hdf5(tmp_path / "run.h5")) == 3


def test_memory_is_that_of_a_chunk(tmp_path):
    code = """
        import sys
        import saltus.kernel as sk
        from test_models import ball

        def peak():  # [MB]
            lines = open("/proc/self/status").read().splitlines()
            return int(next(line for line in lines if line.startswith("VmHWM")).split()[1]) / 1000

        def run(until):
            sk.TimeStepping(ball(), "HalfExplicitTrapezoidalOSI", 1e-6, file=sys.argv[1] or None).run(until)

        run(0.05)
        before = peak()
        run(0.4)
        print(peak() - before)
    """

    def growth(file):
        arguments = [sys.executable, "-c", textwrap.dedent(code), file]
        folder = {**os.environ, "PYTHONPATH": os.path.dirname(__file__)}
        return float(subprocess.run(arguments, env=folder, capture_output=True, text=True, check=True).stdout)

    assert growth("") > 40  # 350 000 rows of 150 bytes
    assert growth(str(tmp_path / "run.h5")) < 4
