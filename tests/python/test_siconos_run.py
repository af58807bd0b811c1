"""`saltus run`, as a process."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import saltus.kernel as native
from saltus.compare import compare
from saltus.io import read_first_order, read_hdf5
from saltus.models import model
from saltus.siconos.script import is_script, run_script
from saltus.siconos.simulation import Changes

SALTUS = Path(sys.executable).parent / "saltus"
SCRIPTS = Path(__file__).parents[1] / "siconos" / "scripts"
BALL = SCRIPTS / "bouncing_ball.py"


def saltus(*arguments, cwd):
    return subprocess.run(
        [SALTUS, "run", *map(str, arguments)], cwd=cwd, capture_output=True, text=True, check=False
    )


def test_a_script_runs_as_it_is_and_is_recorded(tmp_path):
    result = saltus(BALL, "--record", "ball.h5", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert "ball.h5: 1001 rows" in result.stderr
    trajectory = read_hdf5(tmp_path / "ball.h5")
    assert trajectory.provenance.integrator == "MoreauJeanOSI"
    assert trajectory.provenance.time_step == 5e-3
    assert trajectory.q[0, 0] == 1.0


def test_integrator_solver_step_and_end_are_swapped(tmp_path):
    options = ["--integrator", "HalfExplicitRungeKuttaOSI(tableau=RK4)", "--solver", "lemke"]
    steps = ["--time-step", "0.01", "--until", "1.5", "--record", "ball.csv"]
    result = saltus(BALL, *options, *steps, cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    table = np.genfromtxt(tmp_path / "ball.csv", delimiter=",", names=True)
    assert len(table) == 151
    h5 = saltus(BALL, *options, *steps[:-1], "ball.h5", cwd=tmp_path)
    assert h5.returncode == 0
    provenance = read_hdf5(tmp_path / "ball.h5").provenance
    assert (provenance.integrator, provenance.solver) == ("HalfExplicitRungeKuttaOSI", "lemke")


def test_the_integrator_of_a_circuit_is_swapped(tmp_path):
    bridge = BALL.with_name("diode_bridge.py")
    options = ["--record", "run.h5", "--integrator"]
    result = saltus(bridge, *options, "EulerMoreauOSI(theta=1,gamma=0.5)", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    run = read_first_order(tmp_path / "run.h5")
    assert len(run) == 1001
    assert run.provenance.options == {"theta": 1.0, "gamma": 0.5, "gamma_for_relation": False}
    refused = saltus(bridge, *options, "MoreauJeanOSI", cwd=tmp_path)
    assert "no integrator of first-order systems named 'MoreauJeanOSI'" in refused.stderr
    refused = saltus(bridge, *options, "EulerMoreauOSI(alpha=1)", cwd=tmp_path)
    assert refused.returncode == 2
    assert "options of EulerMoreauOSI are numbers: gamma, gamma_for_relation, theta" in refused.stderr


def test_a_picture_opens_no_window_and_arguments_arrive(tmp_path):
    (tmp_path / "picture.py").write_text(
        "import sys\nimport siconos.kernel as sk\nimport matplotlib\nimport matplotlib.pyplot as plt\n"
        "plt.plot([0, 1])\nplt.show()\nplt.savefig(sys.argv[1])\nprint(matplotlib.get_backend().lower())\n"
    )
    result = saltus("picture.py", "--", "picture.png", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert result.stdout == "agg\n"
    assert (tmp_path / "picture.png").read_bytes().startswith(b"\x89PNG")


def test_an_error_of_the_script_names_its_line(tmp_path):
    (tmp_path / "broken.py").write_text("import siconos.kernel as sk\nsk.Hem5OSI(1, 2)\n")
    result = saltus("broken.py", cwd=tmp_path)
    assert result.returncode == 1
    assert "broken.py, line 2: NotThere: Hem5OSI: not there" in result.stderr
    assert "Traceback" not in result.stderr
    (tmp_path / "other.py").write_text("import siconos.mechanics\n")
    assert "siconos.kernel and siconos.numerics are there" in saltus("other.py", cwd=tmp_path).stderr


def test_what_was_recorded_before_an_error_is_kept(tmp_path):
    text = BALL.read_text().replace(
        "    simulation.nextStep()", "    simulation.nextStep()\n    1 / (k - 11)"
    )
    (tmp_path / "ends.py").write_text(text)
    result = saltus("ends.py", "--record", "ends.h5", cwd=tmp_path)
    assert result.returncode == 1
    assert "ZeroDivisionError" in result.stderr
    assert len(read_hdf5(tmp_path / "ends.h5")) == 11


def test_each_simulation_has_its_file(tmp_path):
    (tmp_path / "twice.py").write_text(2 * BALL.read_text())
    result = saltus("twice.py", "--until", "0.1", "--record", "run.h5", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert len(read_hdf5(tmp_path / "run.h5")) == len(read_hdf5(tmp_path / "run-2.h5")) == 21


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["none.py"], "there is no file 'none.py'"),
        ([BALL, "--integrator", "Nonsense"], "no integrator named 'Nonsense'"),
        ([BALL, "--solver", "nonsense"], "no contact solver named 'nonsense'"),
        ([BALL, "--time-step", "-1"], "--time-step must be positive and finite, got -1"),
        ([BALL, "--until", "inf"], "--until must be positive and finite, got inf"),
        ([BALL, "--record", "a.txt"], "--record must end in one of .h5, .hdf5, .csv, got 'a.txt'"),
    ],
)
def test_misuse_is_one_line_and_2(tmp_path, arguments, message):
    result = saltus(*arguments, cwd=tmp_path)
    assert result.returncode == 2
    assert message in result.stderr
    assert "Traceback" not in result.stderr


def test_a_step_that_does_not_divide_the_scripts_is_refused(tmp_path):
    result = saltus(BALL, "--time-step", "0.003", cwd=tmp_path)
    assert result.returncode == 1
    assert "must be a whole fraction of the script's, 0.005 s, got 0.003 s" in result.stderr


def test_a_script_is_a_model_to_compare():
    """A rod that swings has a closed solution: the coarse scheme of the script is far from it."""
    script = SCRIPTS / "rod.py"
    found = model(script)
    assert (found.time_step, found.until) == (1e-3, 2.0)
    result = compare(script, ["HalfExplicitTrapezoidalOSI"], until=0.5, timings=0)
    moreau, half = result.rows
    assert half.error_q < 0.01 * moreau.error_q


def test_each_build_starts_where_the_script_does(tmp_path):
    found = model(BALL)
    first = native.TimeStepping(found.build(), "MoreauJeanOSI", 5e-3).run(1.0)
    second = native.TimeStepping(found.build(), "MoreauJeanOSI", 5e-3).run(1.0)
    np.testing.assert_array_equal(first.q, second.q)
    assert second.q[0, 0] == 1.0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("import siconos.kernel\n", "must simulate something, got to its end without a step"),
        ("import siconos.kernel\nraise SystemExit(0)\n", r"must simulate something, got sys.exit\(0\)"),
        ("import siconos.kernel\n1 / 0\n", "failed: ZeroDivisionError: division by zero"),
        ((SCRIPTS / "diode_bridge.py").read_text(), "is of first order, expected a mechanical model"),
    ],
)
def test_what_is_no_model_is_refused(tmp_path, text, message):
    (tmp_path / "script.py").write_text(text)
    with pytest.raises(ValueError, match=message):
        model(tmp_path / "script.py")


def test_a_module_with_build_is_no_script(tmp_path):
    (tmp_path / "module.py").write_text("import siconos.kernel\n\ndef build():\n    return None\n")
    assert not is_script(tmp_path / "module.py")
    (tmp_path / "late.py").write_text("def f():\n    from siconos import kernel\n")
    assert is_script(tmp_path / "late.py")
    assert not is_script(tmp_path / "none.py")


def bouncing(t, e):
    """Height of a ball dropped from 1 m, at times t."""
    gravity, heights = 9.81, []
    for time in t:
        fall, speed = np.sqrt(2 / gravity), np.sqrt(2 * gravity)
        if time < fall:
            heights.append(1.0 - 0.5 * gravity * time**2)
            continue
        time, speed = time - fall, e * speed
        while time > 2 * speed / gravity:
            time, speed = time - 2 * speed / gravity, e * speed
        heights.append(speed * time - 0.5 * gravity * time**2)
    return np.array(heights)


@pytest.mark.parametrize("integrator", ["HalfExplicitTrapezoidalOSI", "HalfExplicitRungeKuttaOSI"])
def test_a_swapped_integrator_is_nearer_to_the_exact_bounces(integrator):
    """Before they accumulate, on average over the run; the option can be seen in what is recorded."""
    errors = []
    for name in (None, integrator):
        changes = Changes(integrator=name, until=3.0)
        run_script(BALL, changes)
        run = changes.simulations[0].trajectory
        errors.append(np.abs(run.q[:, 0] - bouncing(run.t, 0.8)).mean())
    assert errors[1] < 0.5 * errors[0]
    assert run.provenance.options["impulsive_substeps"] == 10
