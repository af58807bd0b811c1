"""``saltus sweep``: what is lost, what is made again, and that results are the same to the last bit."""

import csv
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest
import saltus.kernel as sk
from matplotlib.figure import Figure
from pyarrow import parquet
from saltus.examples.bouncing_ball import bouncing_ball
from saltus.examples.impact_oscillator import bifurcation, impact_oscillator
from saltus.io import read_hdf5
from saltus.sweep import Samples, read_study, run_study
from saltus.sweep.picture import draw
from scipy import stats

SALTUS = Path(sys.executable).parent / "saltus"

CRANK = """
import os, signal
from saltus import _core
import saltus.kernel as sk

PARAMETERS = {"speed": [140.0 + k / 10 for k in range(COUNT // 2)], "friction": [0.01, 0.1]}
TIME_STEPS = [2e-4]
UNTIL = 0.05
UNITS = {"speed": "rad/s", "angle": "rad"}

def build(speed, friction):
    if (speed, friction) == (140.2, 0.1):
        raise RuntimeError("injected")
    if (speed, friction) == (140.4, 0.1):
        os.kill(os.getpid(), signal.SIGKILL)
    p = _core.SliderCrankParameters()
    crank = _core.CompiledSliderCrank([0.0, 0.0, 0.0], [speed, -speed / 2, 0.0], p)
    system = sk.NonSmoothDynamicalSystem([crank], parameters={"friction": friction})
    law = sk.NewtonImpactFrictionNSL(0.4, 0.0, friction, 2)
    for number, (xi, eta) in enumerate([(-p.a, p.b), (p.a, p.b), (-p.a, -p.b), (p.a, -p.b)]):
        corner = _core.CompiledSliderCorner(xi, eta, 2, p)
        system.link(sk.Interaction(corner, law, name=f"corner {number}"), crank)
    return system

def measure(trajectory):
    if trajectory.v[0, 0] == 140.6 and trajectory.provenance.parameters["friction"] == 0.1:
        return {"angle": "wide"}
    return {"angle": trajectory.q[-1, 0], "hits": trajectory.t[trajectory.impulsive]}
"""

WAITING = """
import time
from saltus.examples.bouncing_ball import bouncing_ball

PARAMETERS = {"number": list(range(12))}
TIME_STEPS, UNTIL = [1e-2], 1.0

def build(number):
    open(f"built-{number}", "w").close()
    time.sleep(PAUSE)
    return bouncing_ball.build()

def measure(trajectory):
    return {"height": trajectory.q[-1, 0]}
"""

FAILED = {(140.2, 0.1): "RuntimeError", (140.4, 0.1): "ProcessDied", (140.6, 0.1): "TypeError"}


def write(path, text, **words):
    """A study in which these words stand for others."""
    for word, other in words.items():
        text = text.replace(word, str(other))
    path.write_text(text)
    return path


def crank(folder, count=40):
    """A study of the slider crank in which three runs fail: composing, measuring, and by a signal."""
    return write(folder / "crank.py", CRANK, COUNT=count)


def saltus(*arguments, cwd):
    return subprocess.run([SALTUS, "sweep", *arguments], cwd=cwd, capture_output=True, text=True, check=False)


def start(*arguments, cwd):
    return subprocess.Popen(
        [SALTUS, "sweep", *arguments],
        cwd=cwd,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        # what runs in the background ignores Ctrl-C, and so would its children
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )


def until(condition):
    for _ in range(600):
        if condition():
            return
        time.sleep(0.05)
    raise TimeoutError


def tables(folder):
    return [(folder / name).read_bytes() for name in ("table.parquet", "table.csv")]


def test_failures_are_recorded_and_the_others_go_on(tmp_path):
    crank(tmp_path, 200)
    result = saltus("crank.py", "--workers", "2", "--json", cwd=tmp_path)
    assert result.returncode == 1
    said = json.loads(result.stdout)
    assert (said["runs"], said["made"]) == (200, 200)
    assert said["status"] == {"done": 197, "failed": 2, "died": 1}
    found = {(f["parameters"]["speed"], f["parameters"]["friction"]): f["error"] for f in said["failures"]}
    assert found == FAILED
    assert "197 of 200 runs have a result" in result.stderr

    rows = parquet.read_table(tmp_path / said["table"]).to_pylist()
    assert [(row["speed"], row["friction"]) for row in rows[:3]] == [
        (140.0, 0.01),
        (140.0, 0.1),
        (140.1, 0.01),
    ]
    study = read_study(tmp_path / "crank.py")
    alone = sk.TimeStepping(study.build(speed=140.1, friction=0.01), "HalfExplicitTrapezoidalOSI", 2e-4).run(
        0.05
    )
    assert rows[2]["angle"] == alone.q[-1, 0]
    assert rows[2]["hits"] == alone.t[alone.impulsive].tolist()
    assert rows[2]["energy"] == alone.energy[-1]
    assert (rows[2]["steps"], rows[2]["penetration"]) == (250, alone.penetration.max())
    wrong = rows[5]
    assert (wrong["status"], wrong["error"], wrong["message"]) == ("failed", "RuntimeError", "injected")
    assert 'raise RuntimeError("injected")' in wrong["traceback"]
    assert wrong["angle"] is None
    assert rows[9]["message"] == "its process ended by signal 9, 3 times"

    before = tables(tmp_path / "out/sweep/crank")
    again = saltus("crank.py", "--json", cwd=tmp_path)
    assert (again.returncode, json.loads(again.stdout)["made"]) == (1, 0)
    for row in (rows[0], rows[7]):
        (tmp_path / "out/sweep/crank/runs" / f"{row['id']}.json").unlink()
    (tmp_path / "out/sweep/crank/runs" / f"{rows[8]['id']}.json").write_text('{"status": "do')
    again = saltus("crank.py", "--json", cwd=tmp_path)
    assert json.loads(again.stdout)["made"] == 3
    assert tables(tmp_path / "out/sweep/crank") == before
    again = saltus("crank.py", "--retry-failed", "--json", cwd=tmp_path)
    assert json.loads(again.stdout)["made"] == 3
    assert tables(tmp_path / "out/sweep/crank") == before


def test_workers_and_kills_change_no_bit(tmp_path):
    study = crank(tmp_path, 120)
    for workers in ("1", "2"):
        saltus("crank.py", "--workers", workers, "--out", workers, cwd=tmp_path)
    assert tables(tmp_path / "1") == tables(tmp_path / "2")
    runs = tmp_path / "killed/runs"
    killed = start("crank.py", "--workers", "2", "--out", "killed", cwd=tmp_path)
    until(lambda: len(list(runs.glob("*.json"))) >= 20)
    os.killpg(killed.pid, signal.SIGKILL)
    killed.communicate()
    left = len(list(runs.glob("*.json")))
    assert 20 <= left < 120
    assert not (tmp_path / "killed/table.csv").exists()
    found = run_study(study, tmp_path / "killed", workers=2)
    assert found.made == 120 - left
    assert tables(tmp_path / "killed") == tables(tmp_path / "1")
    seconds = [
        float(row["seconds [s]"])
        for row in csv.DictReader((tmp_path / "1/times.csv").open())
        if row["seconds [s]"]
    ]
    assert len(seconds) == 119  # all but the one whose process died
    assert min(seconds) > 0


def test_ctrl_c_keeps_what_is_done_and_ends_all_processes(tmp_path):
    write(tmp_path / "waiting.py", WAITING, PAUSE="0 if number < 4 else 60")
    stopped = start("waiting.py", "--workers", "2", "--out", "out", cwd=tmp_path)
    until(lambda: (tmp_path / "built-5").exists())
    until(lambda: len(list((tmp_path / "out/runs").glob("*.json"))) == 4)
    children = Path(f"/proc/{stopped.pid}/task").glob("*/children")
    processes = [word for file in children for word in file.read_text().split()]
    assert len(processes) == 2
    os.kill(stopped.pid, signal.SIGINT)
    _, said = stopped.communicate(timeout=30)
    assert stopped.returncode == 130
    assert "the same command goes on" in said
    assert "Traceback" not in said
    assert not any(Path(f"/proc/{process}").exists() for process in processes)
    assert len(list((tmp_path / "out/runs").glob("*.json"))) == 4


def test_a_run_that_takes_too_long_is_ended(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    study = write(tmp_path / "waiting.py", WAITING, PAUSE="60 if number == 3 else 0")
    found = run_study(study, "out", workers=2, time_out=1.5)
    [late] = found.failed
    assert (late["status"], late["message"]) == ("time-out", "took longer than 1.5 s")
    assert late["parameters"] == {"number": 3}


def test_runs_are_known_by_what_decides_their_result(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    study = write(tmp_path / "waiting.py", WAITING, PAUSE="0")
    first = run_study(study, "out", workers=1)
    assert (first.made, first.other_runs) == (12, 0)
    text = study.read_text()
    study.write_text("# a note\n" + text.replace("range(12)", "range(13)"))
    assert run_study(study, "out", workers=1).made == 1
    study.write_text(text.replace("trajectory.q[-1, 0]", "trajectory.q[-1, 0] + 1"))
    changed = run_study(study, "out", workers=1)
    assert (changed.made, changed.other_runs) == (12, 13)
    assert changed.records[0]["figures"]["height"] == first.records[0]["figures"]["height"] + 1
    study.write_text(
        text.replace("range(12)", "range(12)").replace(
            "def build(number):", "def build(number):\n    print(PARAMETERS)"
        )
    )
    was = {run.identity for run in read_study(study).runs()}
    study.write_text(study.read_text().replace("range(12)", "range(13)"))
    assert not was & {run.identity for run in read_study(study).runs()}  # the list itself may decide


def test_trajectories_are_kept(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    study = write(tmp_path / "ball.py", 'MODEL = "bouncing-ball"\nTIME_STEPS = [1e-2, 5e-3]\nUNTIL = 1.0\n')
    assert run_study(study, "out", workers=1).made == 2
    found = run_study(study, "out", workers=1, keep=True)
    assert found.made == 2
    run = read_hdf5(tmp_path / "out/trajectories" / f"{found.records[1]['id']}.h5")
    alone = sk.TimeStepping(bouncing_ball.build(), "HalfExplicitTrapezoidalOSI", 5e-3).run(1.0)
    np.testing.assert_array_equal(run.q, alone.q)
    assert run_study(study, "out", workers=1, keep=True).made == 0


def test_any_scheduler_serves_and_a_worker_that_dies_is_a_failure(tmp_path, monkeypatch):
    import dask
    from distributed import LocalCluster

    monkeypatch.chdir(tmp_path)
    deadly = "0 if number else os.kill(os.getppid(), 9) or 1"  # the worker is the parent
    study = write(tmp_path / "waiting.py", "import os" + WAITING, PAUSE=deadly)
    here = run_study(write(tmp_path / "same.py", WAITING, PAUSE="0"), "here", workers=1)
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 0}),
        LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster,
    ):
        found = run_study(study, "there", scheduler=cluster.scheduler_address)
    assert [record["status"] for record in found.records] == ["died", *11 * ["done"]]
    assert found.records[0]["error"] == "KilledWorker"
    assert [r["figures"] for r in found.records[1:]] == [r["figures"] for r in here.records[1:]]


def test_samples_begin_alike_and_have_their_distribution():
    few, many = (list(Samples(count, seed=3, mu=(0.1, 0.3), gap=stats.norm(5.0, 2.0))) for count in (5, 4000))
    assert few == many[:5]
    mu, gap = (np.array([point[name] for point in many]) for name in ("mu", "gap"))
    assert stats.kstest(mu, stats.uniform(0.1, 0.2).cdf).pvalue > 0.01
    assert stats.kstest(gap, stats.norm(5.0, 2.0).cdf).pvalue > 0.01
    assert list(Samples(5, seed=4, mu=(0.1, 0.3), gap=(0.0, 1.0))) != few


def test_points_grids_and_their_order(tmp_path):
    text = "import numpy as np\ndef build(a=0, b=''): pass\n"
    text += "UNTIL = lambda a=1, b='': 2.0 * a\nTIME_STEPS = [0.1, 0.2]\n"
    study = write(tmp_path / "s.py", text + "PARAMETERS = {'a': np.arange(1, 3), 'b': ['x', 'y']}")
    found = [(*run.parameters.values(), run.time_step, run.until) for run in read_study(study).runs()]
    assert found == [(a, b, dt, 2.0 * a) for a in (1, 2) for b in "xy" for dt in (0.1, 0.2)]
    study = write(tmp_path / "s.py", text + "PARAMETERS = [{'a': 5}, {'b': 'z'}]")
    assert [run.parameters for run in read_study(study).runs()] == [
        {"a": 5},
        {"a": 5},
        {"b": "z"},
        {"b": "z"},
    ]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "expected either a function build(**parameters) or MODEL"),
        ("MODEL = 'nonsense'", "no model named 'nonsense'"),
        ("MODEL = 'ball-in-box'\nPARAMETERS = {'a': [1]}", "a MODEL has no parameters"),
        ("MODEL = 'ball-in-box'\nINTEGRATORS = ['X']", "no integrator named 'X'"),
        ("MODEL = 'ball-in-box'\nTIME_STEPS = 1e-3", "TIME_STEPS must be a list of at least one value"),
        ("MODEL = 'ball-in-box'\nTIME_STEPS = [0]", "TIME_STEPS must be positive and finite, in s, got 0"),
        (
            "def build(a): pass\nTIME_STEPS, UNTIL = [1], 1\nPARAMETERS = {'a': [[1]]}",
            "must be a number or a word",
        ),
        (
            "def build(a): pass\nTIME_STEPS, UNTIL = [1], 1\nPARAMETERS = 7",
            "PARAMETERS must be lists by name",
        ),
        ("def build(): pass\nTIME_STEPS = [1]", "expected UNTIL"),
        ("1 / 0", "cannot be imported: ZeroDivisionError: division by zero"),
    ],
)
def test_misuse_of_a_study_is_one_line_and_2(tmp_path, text, message):
    write(tmp_path / "study.py", text)
    result = saltus("study.py", cwd=tmp_path)
    assert (result.returncode, result.stdout) == (2, "")
    assert message in result.stderr
    assert "Traceback" not in result.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["none.py"], "there is no file 'none.py'"),
        (["ball.py", "--workers", "0"], "workers must be at least one, got 0"),
        (["ball.py", "--time-out", "-1"], "a time-out must be positive and finite, in s, got -1"),
        (["ball.py", "--workers", "2", "--scheduler", "tcp://localhost:1"], "which has its own, got both"),
        (["ball.py", "--out", "ball.py"], "expected a writable folder"),
    ],
)
def test_misuse_of_options_is_one_line_and_2(tmp_path, words, message):
    write(tmp_path / "ball.py", 'MODEL = "bouncing-ball"')
    result = saltus(*words, cwd=tmp_path)
    assert (result.returncode, result.stdout) == (2, "")
    assert message in result.stderr
    assert "Traceback" not in result.stderr


def test_a_missing_package_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ImportError, match=r"pip install 'saltus\[sweep\]'"):
        run_study(tmp_path / "study.py")


def test_the_picture_has_a_line_for_each_combination_and_dots_for_lists(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found = run_study(crank(tmp_path, 12), "out", workers=1)
    ax = Figure().subplots()
    draw(ax, found)
    lines = {line.get_label(): line for line in ax.lines}
    assert set(lines) == {"friction = 0.01", "friction = 0.1", "no result: 2 of 12"}
    angles = [r["figures"]["angle"] for r in found.records if r["parameters"]["friction"] == 0.01]
    np.testing.assert_array_equal(lines["friction = 0.01"].get_ydata(), angles)
    np.testing.assert_array_equal(lines["no result: 2 of 12"].get_xdata(), [140.2, 140.4])
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("speed [rad/s]", "angle [rad]")
    assert (tmp_path / "out/sweep.png").read_bytes().startswith(b"\x89PNG")


def test_the_picture_of_samples_is_coloured_by_the_second_parameter(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    samples = "from saltus.sweep import Samples\n"
    samples += "PARAMETERS = Samples(20, seed=1, number=(0, 1), other=(2.0, 3.0))\n"
    text = WAITING.replace('PARAMETERS = {"number": list(range(12))}\n', samples).replace(
        "(number)", "(number, other)"
    )
    found = run_study(write(tmp_path / "waiting.py", text, PAUSE="0"), "out", workers=1)
    ax = Figure().subplots()
    draw(ax, found)
    [dots] = ax.collections
    points = np.array([[r["parameters"]["number"], r["figures"]["height"]] for r in found.records])
    np.testing.assert_array_equal(np.sort(np.asarray(dots.get_offsets())[:, 0]), np.sort(points[:, 0]))
    others = [record["parameters"]["other"] for record in found.records]
    of = {
        x: tuple(c) for x, c in zip(np.asarray(dots.get_offsets())[:, 0], dots.get_facecolors(), strict=True)
    }
    assert of[points[np.argmin(others), 0]] == plt.get_cmap("viridis")(0.0)
    assert of[points[np.argmax(others), 0]] == plt.get_cmap("viridis")(1.0)


def test_the_oscillator_of_the_example_hits_as_its_formula_says():
    drive = impact_oscillator.Drive()
    run = sk.TimeStepping(bifurcation.build(drive.frequency), "HalfExplicitTrapezoidalOSI", 5e-4)
    speeds = bifurcation.measure(run.run(bifurcation.UNTIL(drive.frequency)))["impact_speed"]
    assert len(speeds) == pytest.approx(bifurcation.LAST * bifurcation.PERIODS, abs=1)
    np.testing.assert_allclose(speeds, drive.speed / drive.restitution, rtol=0.03)
