"""Moreau-Jean's theta scheme against that of Siconos 4.4, where Debian's python3-siconos is installed."""

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
import saltus.kernel as sk

SCRIPT = Path(__file__).parent / "bouncing_ball.py"
PYTHON = "/usr/bin/python3"  # Debian's packages are not seen by others
TIME_STEP, UNTIL = 5e-3, 10.0


@pytest.fixture(scope="session")
def siconos():
    try:
        subprocess.run([PYTHON, "-c", "import siconos.kernel"], check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("python3-siconos is not installed")
    return PYTHON


@pytest.mark.parametrize("theta", [0.5, 0.7, 1.0])
@pytest.mark.parametrize("restitution", [0.0, 0.3, 0.9])
def test_the_theta_scheme_gives_the_numbers_of_siconos(siconos, theta, restitution):
    arguments = map(str, (theta, restitution, TIME_STEP, UNTIL))
    out = subprocess.run([siconos, SCRIPT, *arguments], check=True, capture_output=True, text=True).stdout
    theirs = np.array(json.loads(out.splitlines()[-1]))

    ball = sk.LagrangianLinearTIDS([1.0, 0, 0], [0.0, 0, 0], np.eye(3), external_force=[-9.81, 0, 0])
    system = sk.NonSmoothDynamicalSystem([ball])
    relation = sk.LagrangianLinearTIR([[1.0, 0, 0]])
    system.link(sk.Interaction(sk.NewtonImpactNSL(restitution), relation, name="floor"), ball)
    run = sk.TimeStepping(system, sk.MoreauJeanOSI(theta), TIME_STEP).run(UNTIL)

    ours = np.column_stack([run.t, run.q[:, 0], run.v[:, 0], run["floor"].impulse[:, 0]])
    assert ours.shape == theirs.shape
    assert np.count_nonzero(ours[:, 3]) > 10
    assert np.abs(ours - theirs).max() < 1e-11
