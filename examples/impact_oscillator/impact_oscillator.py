r"""A driven oscillator that hits a stop once in every period: a periodic motion that is known exactly.

Hammers, presses and gears that rattle are driven masses with a stop. The simplest of them,

    m q̈ + m Ω² q = F cos(ω t + φ) + λ,    q >= 0,    q̇⁺ = −ε q̇⁻,

moves chaotically for some ω. For others it settles to one impact in each period T = 2π/ω of the force, and
that motion has a formula.

1. The periodic motion
----------------------
Let impacts be at t = 0, T, 2T, … With a = F/(m (Ω² − ω²)) the flight in between is

    q = c cos Ωt + s sin Ωt + a cos(ωt + φ).

q(0) = 0 gives c = −a cos φ, q(T) = 0 then s = c tan(ΩT/2), and the impact law

    tan φ = −(Ω/ω) (1 − ε)/(1 + ε) tan(ΩT/2),    q̇⁺ = 2 ε/(1 + ε) s Ω,    q̇⁻ = −q̇⁺/ε.

Of the two φ the one with s > 0 is meant: the mass leaves the stop. Whether it stays away until T remains to
be seen; `build()` starts such a motion at t = 0, just after an impact.

2. What it tests
----------------
With ω = 25 rad/s the motion attracts others, so that a run may go on for ever: times and speeds of its
impacts tell what errors a scheme makes there, those of an impact captured within a step, of first order in
Δt. What the force gives in a period is what an impact takes, (1 − ε²)/2 m q̇⁻². With ω = 30 rad/s the
formula has a motion as well, but it repels, and every scheme leaves it.

Run this file to see it.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import atan, cos, pi, sin, tan
from typing import TYPE_CHECKING

import saltus.kernel as sk

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from saltus.io import Trajectory

MASS = 1.0  # [kg]
OMEGA = 10.0  # Ω, of the free oscillator [rad/s]
TIME_STEP = 1e-4  # [s]

CAPTION = (
    "One impact in every period: position over time, and the same in the plane of position and velocity, "
    "where the motion runs along one closed curve. The dashed one is the formula; at the stop the velocity "
    "jumps."
)
WATCH = (
    "Driven by a force, the mass hits the stop once in every period, always equally hard: red arrows of "
    "one length."
)


@dataclass(frozen=True)
class Drive:
    """Force F cos(ωt + φ) with the φ that puts the impacts at multiples of its period."""

    frequency: float = 25.0  #: ω [rad/s]; not Ω, and ΩT/2 no multiple of π/2
    force: float = 50.0  #: F [N]
    restitution: float = 0.6  #: ε in (0, 1)

    @property
    def period(self) -> float:
        """T [s]."""
        return 2 * pi / self.frequency

    @property
    def phase(self) -> float:
        """φ with s > 0 [rad]."""
        loss = (1 - self.restitution) / (1 + self.restitution)
        phase = atan(-OMEGA / self.frequency * loss * tan(OMEGA * self.period / 2))
        return phase if self._sine(phase) > 0 else phase + pi

    @property
    def speed(self) -> float:
        """q̇⁺ [m/s]."""
        return 2 * self.restitution / (1 + self.restitution) * self._sine(self.phase) * OMEGA

    @property
    def amplitude(self) -> float:
        """Of the forced part, a [m]."""
        return self.force / MASS / (OMEGA**2 - self.frequency**2)

    def at(self, t: float) -> float:
        """F cos(ωt + φ) [N]."""
        return self.force * cos(self.frequency * t + self.phase)

    def position(self, t: float) -> float:
        """Of the periodic motion, q [m] at 0 <= t <= T."""
        forced = self.amplitude * cos(self.frequency * t + self.phase)
        free = -self.amplitude * cos(self.phase) * cos(OMEGA * t) + self._sine(self.phase) * sin(OMEGA * t)
        return free + forced

    def _sine(self, phase: float) -> float:
        """Of the sine in the free part, s [m]."""
        return -self.amplitude * cos(phase) * tan(OMEGA * self.period / 2)


def build(drive: Drive | None = None) -> sk.NonSmoothDynamicalSystem:
    """Compose the oscillator, which starts on its periodic motion."""
    d = drive or Drive()
    mass = sk.LagrangianLinearTIDS([0.0], [d.speed], [[MASS]], [[MASS * OMEGA**2]])
    system = sk.NonSmoothDynamicalSystem(
        [mass],
        parameters={"frequency": d.frequency, "force": d.force, "restitution": d.restitution},
    )
    along = sk.LagrangianLinearTIR([[1.0]])
    system.add_force(sk.ForceElement(along, sk.Actuator(lambda t, length, rate: d.at(t)), "drive"), mass)
    stop = sk.Interaction(along, sk.NewtonImpactNSL(d.restitution), name="stop")
    stop.show_at(lambda q: ((q[0], 0.0), (1.0, 0.0)))
    system.link(stop, mass)
    mass.add_shape(sk.Box(0.02, 0.02), pose=lambda q: (q[0] + 0.01, 0.0, 0.0))
    system.add_shape(sk.Polyline(((0.0, -0.02), (0.0, 0.02))))
    return system


def run() -> Trajectory:
    """Four periods."""
    return sk.TimeStepping(build(), "HalfExplicitTrapezoidalOSI", TIME_STEP).run(4.2 * Drive().period)


def picture(shown: Trajectory) -> Figure:
    """Draw position and phase plane."""
    from saltus.examples.figure import sheet

    drive = Drive()
    times = [drive.period * k / 200 for k in range(201)]
    exact = [1e3 * drive.position(t) for t in times]
    speed = [(b - a) / (times[1] - times[0]) / 1e3 for a, b in pairwise(exact)]
    with sheet(1, 2, (9, 3.8)) as (figure, (place, phase)):
        place.plot(shown.t, 1e3 * shown.q[:, 0])
        place.set_xlabel("time t [s]")
        place.set_ylabel("position q [mm]")
        phase.plot(1e3 * shown.q[:, 0], shown.v[:, 0])
        phase.plot([(a + b) / 2 for a, b in pairwise(exact)], speed, "k--", linewidth=0.9, label="exactly")
        phase.set_xlabel("position q [mm]")
        phase.set_ylabel("velocity [m/s]")
        phase.legend()
    return figure


def main() -> None:
    """Print speeds after impacts, computed and exact."""
    drive = Drive()
    print(f"exactly: an impact every {drive.period:.5f} s, from which it leaves with {drive.speed:.5f} m/s")
    for integrator in ("HalfExplicitTrapezoidalOSI", "MoreauJeanOSI"):
        run = sk.TimeStepping(build(drive), integrator, TIME_STEP).run(20.5 * drive.period)
        times, speeds = run.t[run.impulsive], run.v[run.impulsive, 0]
        apart = (times[-1] - times[-11]) / 10
        print(f"{integrator}: {len(times)} impacts, {apart:.5f} s apart, {speeds[-10:].mean():.5f} m/s")


if __name__ == "__main__":
    main()
