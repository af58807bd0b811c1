"""The fuzz target over the readers, for some seconds; .ci/run lets it run for longer."""

import subprocess
import sys
from pathlib import Path

TARGET = Path(__file__).parents[1] / "fuzz" / "readers.py"


def run(*arguments):
    return subprocess.run(
        [sys.executable, TARGET, *arguments], capture_output=True, text=True, timeout=120, check=False
    )


def test_mutated_files_are_read_or_refused(tmp_path):
    result = run("--seconds", "2", "--seed", "1", "--folder", tmp_path / "failures")
    assert result.returncode == 0, result.stdout + result.stderr
    read, refused = (int(result.stdout.rsplit(f" {word}", 1)[0].split()[-1]) for word in ("read", "refused"))
    assert read > 0
    assert refused > 0


def test_an_input_is_read_again(tmp_path):
    (tmp_path / "a.dat").write_text("1 0 1 1 1 1 2 -1")
    (tmp_path / "b.dat").write_text("nothing")
    result = run(tmp_path / "a.dat", tmp_path / "b.dat")
    assert result.returncode == 0, result.stderr
    assert [line.split()[-1] for line in result.stdout.splitlines()] == ["read", "refused"]
