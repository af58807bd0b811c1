"""What several test files need."""

import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def build_project(tmp_path_factory):
    """A function that builds a CMake project outside of the tree against an installation of Saltus."""
    folder = tmp_path_factory.mktemp("projects")
    installed = folder / "installed"
    development = ["--component", "development", "--prefix", installed]
    _run("cmake", "--install", ROOT / "build/dev", *development)

    def build(source, *options):
        build = folder / source.name
        _run("cmake", "-G", "Ninja", "-S", source, "-B", build, f"-DCMAKE_PREFIX_PATH={installed}", *options)
        _run("cmake", "--build", build)
        return build

    return build


@pytest.fixture(scope="session")
def shared_library(tmp_path_factory):
    """A function that compiles C into a shared library and returns its path."""

    def compile_(source):
        folder = tmp_path_factory.mktemp("library")
        (folder / "own.c").write_text(source)
        _run("gcc", "-O2", "-shared", "-fPIC", folder / "own.c", "-o", folder / "libown.so")
        return folder / "libown.so"

    return compile_


def _run(*command):
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
