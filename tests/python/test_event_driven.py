"""EventDrivenOSI from Python: models in Python, refusals by name, and the count of its inner steps."""

from math import sqrt

import numpy as np
import pytest
import saltus.kernel as sk
from saltus.examples.slider_crank import slider_crank

GRAVITY = 9.81


def ball(restitution):
    body = sk.LagrangianLinearTIDS([1.0], [0.0], np.eye(1), external_force=[-GRAVITY])
    system = sk.NonSmoothDynamicalSystem([body])
    system.link(
        sk.Interaction(sk.LagrangianLinearTIR([[1.0]]), sk.NewtonImpactNSL(restitution), name="floor"), body
    )
    return system


def test_an_impact_is_met_in_time():
    run = sk.TimeStepping(ball(0.5), sk.EventDrivenOSI(), 0.1).run(0.7)
    fall, speed = sqrt(2 / GRAVITY), 0.5 * sqrt(2 * GRAVITY)
    t = run.t[-1] - fall
    assert run.q[-1, 0] == pytest.approx(speed * t - 0.5 * GRAVITY * t**2, abs=1e-12)
    assert run.event_steps.sum() == 1


def test_bounces_that_accumulate_are_refused_by_name():
    with pytest.raises(sk.SimulationError, match="'floor'.*velocity_tolerance"):
        sk.TimeStepping(ball(0.5), sk.EventDrivenOSI(), 0.01).run(2.0)
    run = sk.TimeStepping(ball(0.5), sk.EventDrivenOSI(velocity_tolerance=1e-6), 0.01).run(2.0)
    assert run.captures.sum() == 1
    assert run.v[-1, 0] == 0.0
    assert run["floor"].force[-1, 0] == pytest.approx(GRAVITY, abs=1e-9)


class Pendulum(sk.LagrangianDS):
    """A model in Python that breaks where it is told to."""

    breaks = np.inf

    def mass(self, q, out):
        out[0, 0] = 1.0

    def forces(self, t, q, v, out):
        if t > self.breaks:
            raise RuntimeError("no forces beyond this time")
        out[0] = -GRAVITY * np.sin(q[0])


def test_what_a_model_throws_arrives_through_sundials():
    pendulum = Pendulum([0.5], [0.0])
    simulation = sk.TimeStepping(sk.NonSmoothDynamicalSystem([pendulum]), sk.EventDrivenOSI(), 0.1)
    simulation.run(0.2)
    pendulum.breaks = 0.25
    before = simulation.q.copy()
    with pytest.raises(RuntimeError, match="no forces beyond this time"):
        simulation.step()
    assert np.array_equal(simulation.q, before)
    pendulum.breaks = np.inf
    energy = 0.5 * simulation.run(1.0).v[-1, 0] ** 2 - GRAVITY * np.cos(simulation.q[0])
    assert energy == pytest.approx(-GRAVITY * np.cos(0.5), abs=1e-9)


def test_the_crank_at_two_tolerances():
    ends = [
        sk.TimeStepping(slider_crank.build(), sk.EventDrivenOSI(rtol, 1e-5), 1e-3).run(0.05).q[-1, :2]
        for rtol in (1e-8, 1e-10)
    ]
    assert ends[0] == pytest.approx(ends[1], abs=1e-6)
