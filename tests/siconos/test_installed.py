"""C++ programs against an installation of Saltus."""

import subprocess
from pathlib import Path

import numpy as np
import pytest
import saltus.kernel as sk

ROOT = Path(__file__).resolve().parents[2]


def run(*command, **options):
    done = subprocess.run(command, capture_output=True, text=True, **options)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def programs(tmp_path_factory):
    """The folder of the programs that tests/siconos/project makes."""
    folder = tmp_path_factory.mktemp("installed")
    for component in ("development", "siconos"):
        run("cmake", "--install", ROOT / "build/dev", "--component", component, "--prefix", folder / "saltus")
    places = [f"-DCMAKE_PREFIX_PATH={folder / 'saltus'}", f"-DEXAMPLES={ROOT / 'examples'}"]
    run("cmake", "-G", "Ninja", "-S", Path(__file__).parent / "project", "-B", folder / "build", *places)
    run("cmake", "--build", folder / "build")
    return folder / "build"


def test_a_program_in_siconos_names_has_the_run_of_saltus(programs, tmp_path):
    printed = run(programs / "ball", "rows.dat", cwd=tmp_path)
    rows = np.loadtxt(tmp_path / "rows.dat")
    ball = sk.LagrangianLinearTIDS(
        [1.0, 0, 0], [0, 0, 0], np.diag([1, 1, 0.004]), external_force=[-9.81, 0, 0]
    )
    model = sk.NonSmoothDynamicalSystem([ball])
    model.link(
        sk.Interaction(sk.LagrangianLinearTIR([[1.0, 0, 0]]), sk.NewtonImpactNSL(0.9), name="floor"), ball
    )
    expected = sk.TimeStepping(model, "HalfExplicitTrapezoidalOSI", 5e-3).run(10)
    assert printed.startswith("2000 steps")
    np.testing.assert_allclose(rows[:, 1], expected.q[:, 0], atol=1e-12)
    np.testing.assert_allclose(rows[:, 2], expected.v[:, 0], atol=1e-12)
    floor = expected["floor"]
    np.testing.assert_allclose(rows[:, 4], floor.impulse[:, 0] + 5e-3 * floor.force[:, 0], atol=1e-12)


def test_a_program_inside_of_siconos_is_linked_to_the_library(programs):
    if not (programs / "crank").exists():
        pytest.skip("the development files of Siconos are not installed")
    assert run(programs / "crank").startswith("10000 steps; theta = (9.0005")
