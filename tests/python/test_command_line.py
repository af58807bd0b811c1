"""The command ``saltus``, run as a process."""

import json
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
import saltus.kernel as sk
from saltus.examples.bouncing_ball import bouncing_ball
from saltus.io import read_hdf5

SALTUS = Path(sys.executable).parent / "saltus"
ROOT = Path(__file__).parents[2]


def saltus(*arguments, cwd):
    return subprocess.run([SALTUS, *arguments], cwd=cwd, capture_output=True, text=True, check=False)


def test_demo(tmp_path):
    result = saltus("demo", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert "0.003304" in result.stdout
    assert "reference, Δt = 1e-07 s" in result.stderr
    out = tmp_path / "out" / "demo"
    assert sorted(path.name for path in out.iterdir()) == [
        "slider_crank.h5",
        "slider_crank.html",
        "slider_crank.png",
        "table3.json",
    ]
    trajectory = read_hdf5(out / "slider_crank.h5")
    assert len(trajectory) == 10001
    assert len(trajectory.shapes) == 5
    rows = json.loads((out / "table3.json").read_text())["rows"]
    assert [row["dt"] for row in rows] == 2 * [1e-3, 1e-4, 1e-5]


def test_reproduce_prints_json_alone(tmp_path):
    result = saltus("reproduce", "table2", "--json", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    rows = json.loads(result.stdout)["rows"]
    assert {row["variant"] for row in rows} == {"c=0", "equality"}
    assert {"scheme", "variant", "dt", "error", "paper", "order"} <= set(rows[0])
    fine = [row for row in rows if row["scheme"] == "HalfExplicitTrapezoidalOSI" and row["dt"] == 1e-5]
    assert [row["paper"] for row in fine] == [8.4e-4, 8.4e-4]


def test_reproduce_all_writes_what_it_prints(tmp_path):
    result = saltus("reproduce", "all", "--out", "paper", "--json", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    printed = json.loads(result.stdout)
    figures = ["fig4", "fig5", "fig7", "fig8", "fig10", "fig11", "fig13", "fig14", "fig15"]
    assert list(printed) == ["table2", "table3", *figures]
    out = tmp_path / "paper"
    assert {path.name for path in out.iterdir()} == {
        *(f"{name}.json" for name in printed),
        *(f"{name}.png" for name in figures),
    }
    for name, content in printed.items():
        assert json.loads((out / f"{name}.json").read_text()) == content
    for name in figures:
        assert (out / f"{name}.png").read_bytes().startswith(b"\x89PNG")
        assert {"scheme", "quantity", "value", "unit"} == set(printed[name]["rows"][0])


def test_reproduce_prints_the_numbers_behind_a_figure(tmp_path):
    result = saltus("reproduce", "fig7", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert result.stdout.startswith("Figure 7: Normal gap functions of the slider")
    for number in ("8.3213e-05", "5.375e-05", "0.0003968"):
        assert number in result.stdout
    assert result.stdout.endswith("out/paper/fig7.png\n")
    assert (tmp_path / "out/paper/fig7.png").exists()


def test_errors_are_one_line(tmp_path):
    (tmp_path / "out").write_text("a file")
    for command, folder in ((["demo"], "out/demo"), (["reproduce", "fig4"], "out/paper")):
        result = saltus(*command, cwd=tmp_path)
        assert result.returncode == 1
        assert result.stdout == ""
        assert f"cannot write into '{folder}': expected a writable folder" in result.stderr
        assert "Traceback" not in result.stderr


@pytest.mark.parametrize("arguments", [["reproduce", "table9"], ["nonsense"]])
def test_misuse_exits_with_2(tmp_path, arguments):
    assert saltus(*arguments, cwd=tmp_path).returncode == 2


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["bench", "nonsense"], "no model named 'nonsense'"),
        (["bench", "ball-in-box", "--integrator", "Nonsense"], "no integrator named 'Nonsense'"),
        (["compare", "ball-in-box", "--json", "."], "expected a file to write, got the folder '.'"),
        (
            ["converge", "ball-in-box", "--time-steps", "1e-3,1e-2", "--picture", "a.xyz"],
            "must end in one of",
        ),
        (["compare", "broken.py"], "build() of 'broken.py' failed: ZeroDivisionError: "),
    ],
)
def test_misuse_is_one_line_before_anything_is_computed(tmp_path, arguments, message):
    (tmp_path / "broken.py").write_text("def build():\n    return 1 / 0\n")
    result = saltus(*arguments, cwd=tmp_path)
    assert result.returncode == 2
    assert message in result.stderr
    assert "Traceback" not in result.stderr
    assert result.stdout == ""


COMPARE = ["compare", "ball-in-box", "--integrators", "HalfExplicitTrapezoidalOSI,MoreauJeanOSI(theta=1)"]
BASELINE = ["--baseline", "ExplicitMoreauJeanOSI"]


def test_compare_prints_table_3(tmp_path):
    words = ["slider-crank", "--integrators", "HalfExplicitTrapezoidalOSI", *BASELINE, "--time-steps", "1e-4"]
    result = saltus("compare", *words, "--max-error", "0.01", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    lines = {line.split()[1]: line for line in result.stdout.splitlines() if line.startswith("│")}
    assert set(lines) == {"ExplicitMoreauJeanOSI", "HalfExplicitTrapezoidalOSI"}
    for number in ("0.1526", "0.01747", "30, reference 44", "all limits hold: max-error 0.01"):
        assert number in result.stdout
    assert "…" not in result.stdout  # nothing is cut, though a pipe has 80 columns


def test_compare_writes_what_a_machine_reads(tmp_path):
    files = ["--json", "out/c.json", "--junit", "out/c.xml", "--markdown", "out/c.md"]
    limits = ["--max-error", "0.02", "--max-penetration", "0.05"]
    result = saltus(*COMPARE, *BASELINE, *limits, *files, cwd=tmp_path)
    assert result.returncode == 1
    assert "BROKEN  HalfExplicitTrapezoidalOSI, Δt = 0.005 s: max-error, 0.0257" in result.stdout
    content = json.loads((tmp_path / "out/c.json").read_text())
    assert content["ok"] is False
    assert [row["integrator"] for row in content["rows"]][0] == "ExplicitMoreauJeanOSI"
    assert content["breaches"][0]["limit"] == "max-error"
    suite = ElementTree.parse(tmp_path / "out/c.xml").getroot()[0]
    assert (suite.get("tests"), suite.get("errors")) == ("6", "0")
    failed = {case.get("name") for case in suite if case.find("failure") is not None}
    assert int(suite.get("failures")) == len(failed)
    assert "HalfExplicitTrapezoidalOSI, Δt = 0.005 s: max-error" in failed
    assert not any("max-penetration" in name or "until" in name for name in failed)
    table = [line for line in (tmp_path / "out/c.md").read_text().splitlines() if line.startswith("|")]
    assert len(table) == 5
    assert len({line.count("|") for line in table}) == 1


@pytest.mark.parametrize("option", ["--json", "--junit", "--markdown"])
def test_compare_prints_one_format_alone(tmp_path, option):
    result = saltus(*COMPARE, option, "-", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    start = {"--json": "{", "--junit": "<?xml", "--markdown": "**ball-in-box until 2 s"}[option]
    assert result.stdout.startswith(start)
    if option == "--json":
        assert json.loads(result.stdout)["ok"] is True
    if option == "--junit":
        assert ElementTree.fromstring(result.stdout.encode()).tag == "testsuites"


def test_converge(tmp_path):
    words = ["ball-in-box", "--integrators", "MoreauJeanOSI", "--time-steps", "5e-3,1e-3", "--json", "c.json"]
    result = saltus("converge", *words, cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert (tmp_path / "out/converge.png").read_bytes().startswith(b"\x89PNG")
    [comparison] = json.loads((tmp_path / "c.json").read_text())["comparisons"]
    assert comparison["reference"] == "MoreauJeanOSI"
    assert comparison["orders"]["q"] == pytest.approx(1.0, abs=0.2)
    assert f"order of q: {comparison['orders']['q']:.2f}" in result.stdout


def test_models_are_listed(tmp_path):
    result = saltus("models", cwd=tmp_path)
    assert result.returncode == 0
    for text in ("slider-crank", "bouncing-ball", "ball-in-box", "bar-100000", "Δt [s]", "1e-05"):
        assert text in result.stdout


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["compare", "nonsense"], "no model named 'nonsense'"),
        (["compare", "ball-in-box", "--integrators", "X"], "no integrator named 'X'"),
        (["compare", "slider-crank", "--integrators", "DMinusAccelerationOSI"], "takes no friction"),
        (["compare", "ball-in-box", "--time-steps", "small"], "numbers between commas, got 'small'"),
        (["compare", "ball-in-box", "--min-order", "1"], "at least two time steps"),
        (["compare", "ball-in-box", "--reference", "truth.h5"], "a reference must be INTEGRATOR@DT or"),
        (["compare", "ball-in-box", "--json", "-", "--junit", "-"], "only one output can go to stdout"),
        (["compare", "ball-in-box", "--json", "file/c.json"], "expected a writable folder"),
        (["converge", "ball-in-box", "--time-steps", "1e-3"], "at least two time steps"),
    ],
)
def test_misuse_of_compare_is_one_line_and_2(tmp_path, arguments, message):
    (tmp_path / "file").write_text("")
    result = saltus(*arguments, cwd=tmp_path)
    assert result.returncode == 2
    assert result.stdout == ""
    assert message in result.stderr
    assert "Traceback" not in result.stderr


def test_bench_measures_calls_of_model_functions(tmp_path):
    out = json.loads(saltus("bench", "model-functions", "--json", cwd=tmp_path).stdout)
    assert out["results"] == []
    kinds = {row["function"]: row["ns_per_call"] for row in out["model_functions"]}
    assert set(kinds) == {"method", "compiled", "pointer"}


def test_stubs_agree_with_the_module():
    """Every name and signature; what pybind11 classes have in common is left out."""
    command = [sys.executable, "-m", "mypy.stubtest", "saltus._core"]
    result = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    errors = [line for line in result.stdout.splitlines() if line.startswith("error:")]
    common = (
        "metaclass differs",
        "__pybind11_native_enum__",
        "__init__ is inconsistent, stub does not have *args parameter",
    )
    assert [line for line in errors if not any(words in line for words in common)] == []
    assert errors or result.returncode == 0, result.stdout + result.stderr


def test_report(tmp_path):
    run = sk.TimeStepping(bouncing_ball.build(), "HalfExplicitTrapezoidalOSI", 1e-2).run(1.0)
    run.to_hdf5(tmp_path / "ball.h5")
    result = saltus("report", "ball.h5", "--caption", "It falls.", cwd=tmp_path)
    assert (result.returncode, Path(result.stdout.strip()).name) == (0, "ball.html")
    page = (tmp_path / "ball.html").read_text(encoding="utf-8")
    assert "<title>ball</title>" in page
    assert "It falls." in page
    assert saltus("report", "ball.h5", "--out", "other.html", cwd=tmp_path).returncode == 0
    (tmp_path / "text.h5").write_text("no run")
    for arguments, said in [
        (["none.h5"], "cannot read 'none.h5'"),
        (["text.h5"], "expected an HDF5 file"),
        (["ball.h5", "--out", "nowhere/page.html"], "cannot write"),
    ]:
        result = saltus("report", *arguments, cwd=tmp_path)
        assert result.returncode == 2
        assert said in result.stderr
        assert "Traceback" not in result.stderr
