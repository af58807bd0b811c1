r"""How hard the driven oscillator hits its stop, over the driving frequency: a study for ``saltus sweep``.

    saltus sweep examples/impact_oscillator/bifurcation.py

The oscillator of `impact_oscillator`, m q̈ + m Ω² q = F cos ωt + λ with q >= 0, starts at rest on its stop
and is driven for 120 periods. It has forgotten how it began when the last 48 are looked at: each impact there
is a dot at its frequency ω, as high as the speed with which the mass arrives.

One curve is a motion that always hits equally hard, at 26 rad/s once in every period. At 26.5 rad/s it
splits, and soon chaos fills a band, with a window at 27 rad/s where three speeds follow each other. At ω =
3Ω, 30 rad/s, chaos ends: after a hard impact the mass bounces ever less, fewer times for higher
frequencies, irregularly above 31 and 32 rad/s. From 33.6 rad/s on one impact is left again. Curves are as
thick as the speeds of impacts are off that are captured within a step, an error of first order in Δt.

The parameter is ω, a run takes 120 of its own periods, and its figure is a list, because there are as many
speeds as impacts.
"""

from __future__ import annotations

from math import cos, pi
from typing import TYPE_CHECKING

import numpy as np
import saltus.kernel as sk
from saltus.examples.impact_oscillator.impact_oscillator import MASS, OMEGA

if TYPE_CHECKING:
    from saltus.io import Trajectory
    from saltus.typing import FloatArray

FORCE = 50.0  # F [N]
RESTITUTION = 0.6  # ε
PERIODS = 120  # of a run
LAST = 0.4  # part of it that is looked at

PARAMETERS = {"frequency": np.linspace(26.0, 35.0, 301)}  # ω [rad/s]
TIME_STEPS = [5e-4]  # [s]
UNITS = {"frequency": "rad/s", "impact_speed": "m/s"}


def UNTIL(frequency: float) -> float:  # noqa: N802
    """So many periods [s]."""
    return PERIODS * 2 * pi / frequency


def build(frequency: float) -> sk.NonSmoothDynamicalSystem:
    """Compose the oscillator, at rest on its stop, driven with ω [rad/s]."""
    mass = sk.LagrangianLinearTIDS([0.0], [0.0], [[MASS]], [[MASS * OMEGA**2]])
    system = sk.NonSmoothDynamicalSystem([mass], parameters={"frequency": frequency})
    along = sk.LagrangianLinearTIR([[1.0]])
    drive = sk.Actuator(lambda t, length, rate: FORCE * cos(frequency * t))
    system.add_force(sk.ForceElement(along, drive, "drive"), mass)
    system.link(sk.Interaction(along, sk.NewtonImpactNSL(RESTITUTION), name="stop"), mass)
    return system


def measure(trajectory: Trajectory) -> dict[str, FloatArray]:
    """Speeds q̇⁻ of the last impacts, from Λ = m (1 + ε) q̇⁻."""
    late = trajectory.impulsive & (trajectory.t > (1 - LAST) * trajectory.t[-1])
    return {"impact_speed": trajectory["stop"].impulse[late, 0] / (MASS * (1 + RESTITUTION))}
