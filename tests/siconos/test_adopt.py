"""`saltus.siconos.adopt` against Siconos 4.4, where python3-siconos and this Saltus fit one Python."""

import json
import subprocess
import sysconfig
from pathlib import Path

import pytest

HERE = Path(__file__).parent
PYTHON = "/usr/bin/python3"  # Debian's packages are not seen by others
SITE = sysconfig.get_path("platlib")
BOTH = "import site, sys; site.addsitedir(sys.argv[1]); import siconos.kernel, saltus.siconos"


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("adopt")
    try:
        subprocess.run([PYTHON, "-c", BOTH, SITE], check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("no Python has both Siconos and Saltus")
    library = folder / "pendulum_plugin.so"
    compiler = ["gcc", "-O2", "-shared", "-fPIC", HERE / "pendulum_plugin.cpp", "-o", library, "-lm"]
    subprocess.run(compiler, check=True)
    command = [PYTHON, HERE / "adopted.py", SITE, library]
    out = subprocess.run(command, check=True, capture_output=True, text=True, cwd=folder).stdout
    return json.loads(out.splitlines()[-1])


@pytest.mark.parametrize(
    ("name", "tolerance"),
    [
        ("bouncing_ball", 1e-12),
        ("pendulum", 1e-12),
        ("friction_oscillator", 1e-12),
        ("two_oscillators", 1e-12),
        ("compiled_pendulum", 1e-11),
        ("moving_floor", 1e-12),
    ],
)
def test_an_adopted_model_has_the_trajectory_of_siconos(results, name, tolerance):
    run = results["runs"][name]
    assert run["impacts"] >= 2
    assert run["difference"] < tolerance  # of each column's scale


def test_compiled_masses_and_relations_in_python_are_asked(results):
    assert abs(results["kinetic energy"]) < 1e-15
    assert results["relation"] == 0.0


def test_what_cannot_be_adopted_is_refused_by_name(results):
    assert results["refusals"] == [
        "a system must be a LagrangianDS, got a NewtonEulerDS",
        "a law must be a NewtonImpactNSL of one row or a NewtonImpactFrictionNSL, got a RelayNSL",
        "expected a siconos.kernel.NonSmoothDynamicalSystem, got LagrangianLinearTIDS",
    ]
