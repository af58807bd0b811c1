"""Figures 4 to 11: what the paper's text says of them, in numbers."""

from math import cos, pi, sin, sqrt

import numpy as np
import pytest
from saltus.examples.ball_in_box import figures as ball
from saltus.examples.ball_in_box.ball_in_box import TIME_STEP, Parameters
from saltus.examples.slider_crank import figures
from saltus.examples.slider_crank.figures import ACCELERATION, MOREAU, VELOCITY

P = Parameters()


def test_figure_4_penetrates_and_drifts():
    figure = figures.figure_4()
    assert figure.value(ACCELERATION, "largest penetration") == pytest.approx(8.321e-5, rel=1e-3)
    assert figure.value(ACCELERATION, "time of the largest penetration") == pytest.approx(0.0399)
    assert figure.value(ACCELERATION, "largest difference of left and right") < 1e-12
    # the lower corners sink at constant speed in the last contact
    gap = figures.run(ACCELERATION)["lower left"].gap[-30:, 0]
    assert (np.diff(gap) < 0).all()
    assert np.abs(np.diff(gap, 2)).max() < 0.1 * np.abs(np.diff(gap)).min()


def test_figure_5_energy_is_not_always_decreasing():
    figure = figures.figure_5()
    assert figure.value(ACCELERATION, "energy at the start") == pytest.approx(7.49554875, abs=5e-9)
    assert figure.value(ACCELERATION, "energy at the end") == pytest.approx(7.32077, abs=1e-5)
    assert figure.value(ACCELERATION, "lost in impulsive steps") == pytest.approx(0.17527, abs=1e-5)
    assert figure.value(ACCELERATION, "largest rise in a step") == pytest.approx(1.662e-4, rel=1e-3)
    assert figure.value(ACCELERATION, "sum of all rises") == pytest.approx(5.444e-3, rel=1e-3)
    trajectory = figures.run(ACCELERATION)
    assert (np.diff(trajectory.energy)[trajectory.impulsive[1:]] < 0).all()


def test_figure_7_velocity_level_does_not_drift():
    figure = figures.figure_7()
    for scheme, depth in ((MOREAU, 3.968e-4), (ACCELERATION, 8.321e-5), (VELOCITY, 5.375e-5)):
        assert figure.value(scheme, "largest penetration") == pytest.approx(depth, rel=1e-3)
    lasting = "largest penetration in lasting contact"
    assert figure.value(ACCELERATION, lasting) == pytest.approx(3.15e-5, rel=1e-2)
    assert figure.value(VELOCITY, lasting) == pytest.approx(3.75e-6, rel=1e-2)
    with pytest.raises(KeyError):  # a scheme without forces
        figure.value(MOREAU, lasting)
    whole = figure.picture.axes[0]
    styles = {line.get_label(): line.get_linestyle() for line in whole.lines if "level" in line.get_label()}
    assert styles == {
        "upper corners, velocity level": "-",
        "lower corners, velocity level": "-",
        "upper corners, acceleration level": "--",
        "lower corners, acceleration level": "--",
    }


def test_figure_8_tells_forces_and_impulses_apart():
    figure = figures.figure_8()
    assert figure.value(VELOCITY, "largest λ⁺ of a corner") == pytest.approx(19.638, abs=1e-3)
    assert figure.value(VELOCITY, "largest λ⁻ of a corner") == pytest.approx(19.032, abs=1e-3)
    assert figure.value(VELOCITY, "largest Λ of a corner") == pytest.approx(0.073616, abs=1e-6)
    assert figure.value(VELOCITY, "steps with impulses") == 23
    assert figure.value(VELOCITY, "steps with forces") == 195
    assert figure.value(VELOCITY, "steps with both") == 0


def test_figure_10():
    figure = ball.figure_10()
    start = P.m * P.gravity * 2.0 * (cos(pi / 6) + sin(pi / 6))
    assert figure.value(VELOCITY, "energy at the start") == pytest.approx(start, rel=1e-14)
    # at rest in the corner, both gaps zero but for what the last flight left
    assert figure.value(VELOCITY, "energy at the end") == pytest.approx(start / 2, abs=2e-3)
    assert figure.value(VELOCITY, "largest change in a step of flight") < 1e-14
    assert 0 < figure.value(VELOCITY, "largest rise in a step") < P.m * (P.gravity * TIME_STEP) ** 2 / 8
    (ax,) = figure.picture.axes
    energy = ax.lines[0].get_ydata()
    assert (len(energy), energy[0]) == (401, figure.value(VELOCITY, "energy at the start"))


def test_figure_11():
    figure = ball.figure_11()
    both = f"{ACCELERATION}, {VELOCITY}"
    # the left gap closes for good at t1 (1 + ε)/(1 − ε)
    at_rest = sqrt(2 / (P.gravity * cos(pi / 6))) * 1.3 / 0.7
    assert 0.9 * at_rest < figure.value(both, "gaps coincide until") < at_rest
    assert figure.value(VELOCITY, "speed at the end") == 0.0
    assert 0 < figure.value(ACCELERATION, "speed at the end") < P.gravity * TIME_STEP
    assert figure.value(both, "largest difference of the gaps") == pytest.approx(7.6e-3, rel=0.01)
    whole, near = figure.picture.axes
    styles = [line.get_linestyle() for line in whole.lines]
    assert (styles.count("-"), styles.count("--")) == (5, 4)  # four gaps on each level, and zero
    assert near.get_ylim() == (-ball.NEAR, ball.NEAR)
    with pytest.raises(KeyError, match="no 'mass' of 'ball'"):
        figure.value("ball", "mass")
