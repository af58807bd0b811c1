"""The ball in a box: its exact motion, the two languages against each other."""

from math import cos, pi, sin, sqrt

import numpy as np
import pytest
import saltus.kernel as sk
from saltus import _core
from saltus.examples.ball_in_box.ball_in_box import DIRECTIONS, TIME_STEP, Parameters, build

P = Parameters()
WEIGHT = P.m * P.gravity


@pytest.fixture(scope="module")
def oblique():
    return sk.TimeStepping(build(), "HalfExplicitTrapezoidalOSI", TIME_STEP).run(2.0)


@pytest.mark.parametrize("scheme", ["HalfExplicitTrapezoidalOSI", "ExplicitMoreauJeanOSI"])
@pytest.mark.parametrize("gravity", DIRECTIONS)
def test_both_languages_give_the_same_trajectory(gravity, scheme):
    python = sk.TimeStepping(build(gravity), scheme, TIME_STEP).run(2.0).columns()
    model = _core.compiled_ball_in_box(oblique=gravity == "oblique")
    simulation = _core.TimeSteppingBase(model, _core.make_integrator(scheme), TIME_STEP, "auto")
    recording = _core.Recording()
    simulation.add_observer(recording)
    simulation.advance(2.0, None)
    compiled = recording.columns()
    assert compiled["impulsive"].sum() > 3
    for name in ("impulsive", "closed"):
        np.testing.assert_array_equal(compiled[name], python[name])
    for name in ("q", "v", "gap", "lambda_plus", "lambda_minus", "impulse", "potential_energy"):
        np.testing.assert_allclose(compiled[name], python[name], rtol=0, atol=1e-11)


@pytest.mark.parametrize("gravity", DIRECTIONS)
def test_check_finds_nothing(gravity):
    assert build(gravity).check().ok


def test_the_first_impacts_are_those_of_a_falling_ball(oblique):
    for side, share in (("left", cos(pi / 6)), ("bottom", sin(pi / 6))):
        first = np.flatnonzero(oblique[side].impulse)[0]
        exact = sqrt(2 * 1.0 / (P.gravity * share))
        assert exact <= oblique.t[first] < exact + TIME_STEP
        speed = P.gravity * share * oblique.t[first]
        assert oblique[side].impulse[first, 0] == pytest.approx(P.m * 1.3 * speed, rel=1e-12)
        assert oblique[side].velocity[first, 0] == pytest.approx(0.3 * speed, rel=1e-12)


def test_the_ball_comes_to_rest_in_the_corner_and_the_sides_carry_its_weight(oblique):
    end = sqrt(2 / (P.gravity * sin(pi / 6))) * 1.3 / 0.7
    resting = oblique.t > end + 2 * TIME_STEP
    assert resting.sum() > 100
    np.testing.assert_array_equal(oblique.v[resting], 0.0)
    np.testing.assert_array_equal(oblique.closed[resting], 2)
    for side, force in (("left", WEIGHT * cos(pi / 6)), ("bottom", WEIGHT * sin(pi / 6)), ("right", 0.0)):
        np.testing.assert_allclose(oblique[side].force[resting, 0], force, rtol=1e-12)
        np.testing.assert_array_equal(oblique[side].impulse[resting, 0], 0.0)


def test_gravity_down_is_the_other_direction_of_table_4():
    trajectory = sk.TimeStepping(build("down"), "HalfExplicitTrapezoidalOSI", TIME_STEP).run(2.0)
    np.testing.assert_array_equal(trajectory.q[:, 0], P.x0)
    assert trajectory["bottom"].force[-1, 0] == pytest.approx(WEIGHT, rel=1e-12)
    assert trajectory["left"].force[-1, 0] == 0.0
    with pytest.raises(ValueError, match="gravity must be one of oblique, down, got 'up'"):
        build("up")


def test_shapes_are_the_ball_and_its_box(oblique):
    ball, box = oblique.shapes
    np.testing.assert_array_equal(ball.poses[:, :2], oblique.q)
    assert np.abs(ball.points).max() == P.R
    np.testing.assert_array_equal(box.points.min(axis=0) + box.poses[-1, :2], [0.0, 0.0])
    np.testing.assert_array_equal(box.points.max(axis=0) + box.poses[-1, :2], [P.a, P.b])
