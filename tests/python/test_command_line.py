"""The command ``saltus``, run as a process."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
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
        "slider_crank.png",
        "table3.json",
    ]
    trajectory = read_hdf5(out / "slider_crank.h5")
    assert len(trajectory) == 10001
    assert len(trajectory.shapes) == 3
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
    figures = ["fig4", "fig5", "fig7", "fig8", "fig10", "fig11"]
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
    for number in ("8.321e-05", "5.375e-05", "0.0003968"):
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
