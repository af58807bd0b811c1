"""Solvers compared on problems, and what becomes of those that hang, crash or lie."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from saltus import numerics
from saltus.cli.app import app
from saltus.cli.bench_solvers import CONTACTS, LCP_SIZES, Row, judge, made_collection
from saltus.cli.profiles import draw
from saltus.cli.solver_worker import Answer
from typer.testing import CliRunner

SALTUS = Path(sys.executable).parent / "saltus"

OWN = """
import ctypes
import os
from pathlib import Path

from saltus.numerics import ContactSolver


class Own(ContactSolver):
    def accepts(self, sets):
        return True


class Sleeper(Own):
    def solve(self, G, b, sets, P):
        Path("sleeper").write_text(str(os.getpid()))
        ctypes.PyDLL(None).sleep(60)   # holds the interpreter as C++ does


class Quitter(Own):
    def solve(self, G, b, sets, P):
        os._exit(0)


class Clumsy(Own):
    def solve(self, G, b, sets, P):
        raise ValueError("not my day")


class Loud(Own):
    def solve(self, G, b, sets, P):
        print("I am Loud")
        os.write(1, b"I am Loud")
        P[:] = 1.0
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The current folder, with own.py and two problems: w = z - 1, and two contacts in space."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "own.py").write_text(OWN)
    (tmp_path / "problems/[").mkdir(parents=True)
    numerics.LCP([[1.0]], [-1.0]).write("problems/one.dat")
    numerics.random_friction("regular", 2, 3, 1).write("problems/[/two].hdf5")
    return tmp_path


def bench(*arguments):
    return CliRunner().invoke(app, ["bench", "solvers", *arguments])


def test_curves_are_the_steps_of_the_profile():
    steps = {"a": [(1.0, 0.2), (10.0, 0.6)], "b": [(2.0, 0.8)], "c": []}
    figure = draw({1e-4: steps, 1e-8: {name: [] for name in steps}})
    assert [ax.get_title(loc="left") for ax in figure.axes] == ["tolerance 0.0001", "tolerance 1e-08"]
    a, b, c = figure.axes[0].get_lines()
    assert a.get_drawstyle() == "steps-post"
    np.testing.assert_allclose(a.get_xydata(), [(1, 0), (1, 0.2), (10, 0.6), (13, 0.6)])
    np.testing.assert_allclose(b.get_xydata(), [(1, 0), (2, 0.8), (13, 0.8)])
    np.testing.assert_allclose(c.get_xydata(), [(1, 0), (13, 0)])
    assert len({line.get_linestyle() for line in (a, b, c)}) == 3
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["a", "b", "c"]


def test_whatever_a_solver_does_the_others_are_measured(folder):
    names = ["Sleeper", "Quitter", "Clumsy", "Loud", "lemke"]
    specs = ",".join(f"own.py:{name}" for name in names[:-1]) + ",lemke"
    command = [SALTUS, "bench", "solvers", "problems", "--solvers", specs, "--tolerances", "1e-8"]
    done = subprocess.run([*command, "--time-out", "0.2", "--json", "-"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout, parse_constant=pytest.fail)
    assert found["problems"] == [
        {"name": "[/two].hdf5", "class": "FrictionProblem", "rows": 6, "contacts": 2},
        {"name": "one.dat", "class": "LCP", "rows": 1, "contacts": None},
    ]
    assert [row["solver"] for row in found["rows"]] == 2 * names
    assert {frozenset(row) for row in found["rows"]} == {frozenset(Row.__dataclass_fields__)}
    statuses = [row["status"] for row in found["rows"]]
    assert statuses[:5] == ["time-out", "crash", "crash", "breakdown", "not-accepted"]
    assert statuses[5:] == ["time-out", "crash", "crash", "solved", "solved"]
    for row in found["rows"]:
        answered = row["status"] in ("solved", "breakdown")
        assert all((row[key] is not None) == answered for key in ("seconds", "iterations", "residual"))
    problem = numerics.read_problem("problems/[/two].hdf5")
    assert found["rows"][3]["residual"] == problem.residual(np.ones(6))
    assert found["rows"][8]["residual"] == 0.0
    profiles = {profile["solver"]: profile["steps"] for profile in found["profiles"]}
    assert [profiles[name] for name in names[:3]] == [[], [], []]
    assert sorted([profiles["Loud"], profiles["lemke"]])[0] == [[1.0, 0.5]]
    assert "I am Loud" in done.stderr
    assert "not my day" in done.stderr


def test_tables_files_and_what_cannot_be_read(folder):
    (folder / "problems/broken.dat").write_text("nonsense")
    (folder / "problems/notes.txt").write_text("no problem")
    files = ["--json", "out/b.json", "--out", "out/b.svg"]
    result = bench("problems", "--solvers", "lemke,nsgs,lemke", "--tolerances", "1e-4,1e-12", *files)
    assert result.exit_code == 0, result.output
    assert "broken.dat cannot be read: " in result.stderr
    assert "1 of 3 files cannot be read" in result.stderr
    rows = [line.replace("│", " ").split() for line in result.stdout.splitlines() if line.startswith("│")]
    assert [row[:7] for row in rows] == 2 * [
        ["lemke", "1", "of", "2", "1", "0", "0"],
        ["nsgs", "2", "of", "2", "0", "0", "0"],
    ]
    found = json.loads((folder / "out/b.json").read_text())
    assert found["unreadable"] == ["broken.dat"]
    assert found["tolerances"] == [1e-4, 1e-12]
    assert len(found["rows"]) == 8
    assert (folder / "out/b.svg").read_text().startswith("<?xml")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["nowhere"], "expected a folder of contact problems, got 'nowhere'"),
        (["empty"], "there is no file *.dat, *.hdf5, *.h5 in 'empty'"),
        (["unreadable", "--solvers", "lemke"], "no file in 'unreadable' can be read as a contact problem"),
        (["--tolerances", "1e-4,0"], "tolerances must be positive numbers between commas, got '1e-4,0'"),
        (["--tolerances", "inf"], "tolerances must be positive numbers"),
        (["--tolerances", ","], "tolerances must be positive numbers"),
        (["--tolerances", "small"], "tolerances must be numbers between commas, got 'small'"),
        (["--time-out", "0"], "a time-out must be between 0 and 1e+06 s, got 0"),
        (["--time-out", "nan"], "a time-out must be between 0 and 1e+06 s, got nan"),
        (["--out", "picture.xyz"], "a picture must end in one of"),
        (["--solvers", "nonsense"], "no contact solver named 'nonsense'"),
        (["--solvers", "ends.py:Any"], "the process that loads ['ends.py:Any'] ended with 3"),
    ],
)
def test_misuse_is_one_line_before_anything_is_computed(tmp_path, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    for name in ("empty", "unreadable"):
        (tmp_path / name).mkdir()
    (tmp_path / "unreadable/broken.dat").write_text("nonsense")
    (tmp_path / "ends.py").write_text("import os\n\nos._exit(3)\n")
    result = bench(*arguments)
    assert result.exit_code == 2
    assert message in result.stderr
    assert "Traceback" not in result.stderr
    assert result.stdout == ""


def test_ctrl_c_ends_the_worker(folder):
    command = [SALTUS, "bench", "solvers", "problems", "--solvers", "own.py:Sleeper", "--time-out", "60"]
    process = subprocess.Popen(
        command,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        # what runs in the background ignores Ctrl-C, and so would its children
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    marker = folder / "sleeper"
    while not (marker.exists() and marker.read_text()):
        assert process.poll() is None
        time.sleep(0.02)
    os.killpg(process.pid, signal.SIGINT)
    assert "Traceback" not in process.communicate(timeout=10)[1]
    assert process.returncode != 0
    with pytest.raises(ProcessLookupError):
        os.kill(int(marker.read_text()), 0)


def test_what_is_called_solved_must_be():
    problem = numerics.LCP([[1.0]], [-1.0])
    for status, solution, expected in (
        ("solved", 1.0, "solved"),
        ("solved", 0.9, "wrong"),
        ("ray", 0.9, "ray"),
    ):
        row = judge("p", problem, "s", 1e-8, Answer(status, 1, np.array([solution]), 1e-3))
        assert row.status == expected
        assert row.residual == problem.residual([solution])


def test_the_collection_has_every_kind_and_is_the_same_again():
    made, again = made_collection(), made_collection()
    lcps, frictions = len(numerics.LCP_KINDS) - 1, 2 * len(numerics.FRICTION_KINDS)
    assert len(made) == lcps * len(LCP_SIZES) + frictions * len(CONTACTS)
    for name, make in made.items():
        np.testing.assert_array_equal(make().q, again[name]().q)
