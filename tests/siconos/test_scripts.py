"""Scripts run as they are, by Siconos 4.4 and by Saltus; skipped where python3-siconos is not installed."""

import json
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from saltus.siconos.script import run_script
from saltus.siconos.simulation import Changes

SCRIPTS = Path(__file__).parent / "scripts"
PYTHON = "/usr/bin/python3"  # Debian's packages are not seen by others
PRINT = "import json, runpy, sys; print(json.dumps(runpy.run_path(sys.argv[1])['dataPlot'].tolist()))"


# Not moving_floor.py and rod.py: from Python, Siconos 4.4 has no hDot() to write into, and no Equality.
@pytest.mark.parametrize(
    "name",
    [
        "bar",
        "bouncing_ball",
        "diode_bridge",
        "driven_ball",
        "driven_rectifier",
        "event_driven_ball",
        "filtered_bridge",
        "friction_oscillator",
        "mixed_laws",
        "nonlinear_relay",
        "pendulum",
        "plugin_pendulum",
        "problems",
        "relay_oscillator",
        "spiral_relays",
        "string",
        "two_balls",
    ],
)
def test_a_script_gives_the_numbers_of_siconos(name, tmp_path, monkeypatch):
    script = SCRIPTS / f"{name}.py"
    monkeypatch.chdir(tmp_path)
    if name == "plugin_pendulum":
        source = SCRIPTS.parent / "pendulum_plugin.cpp"
        subprocess.run(
            ["gcc", "-O2", "-shared", "-fPIC", source, "-o", "pendulum_plugin.so", "-lm"], check=True
        )
    try:
        subprocess.run([PYTHON, "-c", "import siconos.kernel"], check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("python3-siconos is not installed")
    command = [PYTHON, "-c", PRINT, script]
    environment = os.environ | {"LD_LIBRARY_PATH": str(tmp_path)}
    out = subprocess.run(command, check=True, capture_output=True, text=True, env=environment).stdout
    theirs = np.array(json.loads(out.splitlines()[-1]))
    ours = run_script(script, Changes())["dataPlot"]
    assert ours.shape == theirs.shape
    scale = np.abs(theirs).max(axis=0)
    assert scale.min() > 0.0
    assert (np.abs(ours - theirs).max(axis=0) / scale).max() < 1e-9
