"""What comparisons are asked of: models, integrators with options, and what is refused."""

from pathlib import Path

import numpy as np
import pytest
import saltus.kernel as sk
from saltus import registry
from saltus.compare import compare
from saltus.examples.bouncing_ball.bouncing_ball import build as ball

ROOT = Path(__file__).resolve().parents[2]
HALF_EXPLICIT = "HalfExplicitTrapezoidalOSI"


def test_models_of_files_and_modules(tmp_path):
    source = (ROOT / "examples/bouncing_ball/bouncing_ball.py").read_text()
    (tmp_path / "own_ball.py").write_text(
        source + "\nTIME_STEP, UNTIL = 1e-3, 2.0\nREFERENCE = 'MoreauJeanOSI@1e-5'\n"
    )
    own = compare(tmp_path / "own_ball.py", [HALF_EXPLICIT], timings=0)
    assert (own.reference, own.until, own.rows[1].time_step) == ("MoreauJeanOSI", 2.0, 1e-3)
    module = compare(
        "saltus.examples.bouncing_ball.bouncing_ball",
        [HALF_EXPLICIT],
        time_steps=[1e-3],
        until=2.0,
        timings=0,
    )
    assert module.rows[1].penetration == own.rows[1].penetration


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("none.py", "x = 1", r"must define build\(\)"),
        ("wrong.py", "def build(): return 3", "must build a NonSmoothDynamicalSystem, got int"),
        (
            "step.py",
            "TIME_STEP = 'big'\ndef build(): pass",
            "TIME_STEP must be a number of seconds, got 'big'",
        ),
        ("reference.py", "REFERENCE = 3\ndef build(): pass", "REFERENCE must be a text INTEGRATOR@DT, got 3"),
        (
            "nothing.py",
            "from saltus.examples.bouncing_ball.bouncing_ball import build",
            "no time step of its own",
        ),
    ],
)
def test_files_that_are_no_models(tmp_path, name, text, message):
    (tmp_path / name).write_text(text)
    with pytest.raises(ValueError, match=message):
        compare(tmp_path / name, [HALF_EXPLICIT])


def test_what_is_no_model():
    with pytest.raises(ValueError, match="no model named 'nonsense', there are slider-crank"):
        compare("nonsense")
    with pytest.raises(ValueError, match="there is no file 'nowhere.py'"):
        compare("nowhere.py")
    with pytest.raises(ValueError, match="cannot be loaded"):
        compare("./nowhere.so:model")
    with pytest.raises(ValueError, match="a name, a system or a function, got int"):
        compare(3)


def test_integrators_with_options():
    scheme = registry.make_integrator(" MoreauJeanOSI(theta=0.75)")
    assert scheme.options == {"theta": 0.75, "gamma": 0.5}
    predicted = registry.make_integrator("HalfExplicitTrapezoidalOSI(activity=predicted)")
    assert predicted.options == {
        "activity": "predicted",
        "stabilization": "none",
        "impact": "paper",
        "impulsive_substeps": 1.0,
    }
    assert registry.label(predicted) == "HalfExplicitTrapezoidalOSI(activity=predicted)"
    hyphens = registry.make_integrator(
        "HalfExplicitRungeKuttaOSI(tableau=third-order, impact='keep-resting-forces')"
    )
    assert registry.label(hyphens) == "HalfExplicitRungeKuttaOSI(impact=keep-resting-forces)"
    assert registry.split_specs("A, B(x=1, y='a'),lib.so:C,") == ["A", "B(x=1, y='a')", "lib.so:C"]
    one = sk.TimeStepping(ball(), "MoreauJeanOSI(theta=1.0)", 1e-3).run(0.1)
    two = sk.TimeStepping(ball(), sk.MoreauJeanOSI(theta=1.0), 1e-3).run(0.1)
    assert np.array_equal(one.q, two.q)
    found = compare(ball, [sk.MoreauJeanOSI(theta=1.0)], time_steps=[1e-3], until=0.1)
    assert found.rows[1].integrator == "MoreauJeanOSI(theta=1.0)"


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        ("MoreauJeanOSI(0.5)", "expected an integrator as NAME"),
        ("MoreauJeanOSI(theta=0.5", "expected an integrator as NAME"),
        ("MoreauJeanOSI(theta=print(1))", "expected an integrator as NAME"),
        ("MoreauJeanOSI(theta=True)", "theta must be a number"),
        ("MoreauJeanOSI(theta=0.5, theta=1)", "expected an integrator as NAME"),
        ("MoreauJeanOSI(theta=0.5, )", "expected an integrator as NAME"),
        ("MoreauJeanOSI(theta=1e)", "expected an integrator as NAME"),
        ("MoreauJeanOSI(theta=big)", "theta must be a number"),
        ("MoreauJeanOSI(size=1)", "has no option 'size'"),
        ("NoSuchOSI(x=1)", "no integrator named 'NoSuchOSI'"),
        ("saltus.conformance.models:DoublePendulum", "derived from OneStepIntegrator"),
    ],
)
def test_specs_that_are_refused(spec, message):
    with pytest.raises(ValueError, match=message):
        compare(ball, [spec], time_steps=[1e-3], until=0.1)
