r"""A heavy top on a ball joint: spatial rotations and a bilateral constraint.

A symmetric top of mass m turns about a fixed point, at the distance l below its centre of mass. It precesses
and nods, and its fast spin keeps it from falling.

1. Dynamics
-----------
As a rigid body in space, q = (x, p) with a unit quaternion and v = (ẋ, Ω), Ω in the frame of the body; the
ball joint holds the point −l e_3 of the body at the origin, g = x − l R(p) e_3 = 0 in three rows:

    m ẍ = (0, 0, −m γ) + λ,    J Ω̇ + Ω × J Ω = −l e_3 × R(p)ᵀ λ,    J = diag(A, A, C).

2. The same without a constraint
--------------------------------
About the fixed point, with J_O = J + m l² diag(1, 1, 0), Euler's equations know no λ:

    J_O Ω̇ + Ω × J_O Ω = l e_3 × R(p)ᵀ (0, 0, −m γ),    ṗ = ½ p ∘ (0, Ω).

They are the reference, and tell the force of the joint: λ = m ẍ + (0, 0, m γ).

3. What is kept
---------------
The energy, the vertical angular momentum about the origin and the spin Ω_3, since no force has a moment
about the axis. With these the inclination moves between two zeros of a cubic. It stays where it is if the
top precesses at a rate ω that solves

    (A + m l²) ω² cos θ − C Ω_3 ω + m γ l = 0.

4. Run it
---------
Run this file to see errors against Euler's equations and what is kept. Schemes of half-explicit kind impose
Wᵀ v = 0 and let g drift; `stabilization="position"` closes the joint to rounding.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, pi, sin, sqrt
from typing import TYPE_CHECKING

import numpy as np
import saltus.kernel as sk

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from saltus.io import Trajectory
    from saltus.typing import FloatArray

GRAVITY = 9.81  # γ [m/s²]
MASS = 0.3  # [kg]
LENGTH = 0.05  # l [m]
ACROSS, ALONG = 2.0e-4, 3.0e-4  # A and C [kg m²], about the centre of mass
ABOUT_ORIGIN = ACROSS + MASS * LENGTH**2  # A + m l²
TILT = pi / 5  # θ at the start [rad]
SPIN = 100.0  # Ω_3 [rad/s]
TIME_STEP = 1e-3  # [s]
SCHEME = "HalfExplicitTrapezoidalOSI(activity=sticky,stabilization=position)"

CAPTION = (
    "Way of the centre of mass, seen from above: let go without precession, the top nods between two "
    "inclinations, the dashed circles, which are exact. At the inner one it stands still for an instant, as "
    "at the start."
)
WATCH = (
    "The top spins, nods between two inclinations and goes round; its joint carries the weight, the green "
    "arrow."
)


@dataclass(frozen=True)
class Motion:
    """Of the top at some times."""

    q: FloatArray  #: (times, 7)
    v: FloatArray  #: (times, 6)


def build(precession: float = 0.0) -> sk.NonSmoothDynamicalSystem:
    """Compose the top, joint "pivot", with this rate of precession at the start [rad/s]."""
    p = [cos(TILT / 2), sin(TILT / 2), 0.0, 0.0]
    top = sk.NewtonEulerDS(
        [*(LENGTH * axis(p)), *p],
        [precession * LENGTH * sin(TILT), 0.0, 0.0, *start(precession)],
        MASS,
        [ACROSS, ACROSS, ALONG],
        force=[0.0, 0.0, -MASS * GRAVITY],
    )
    top.add_shape(sk.Cylinder(0.03, 0.012))
    top.add_shape(sk.Polyline(((0.0, 0.0, -LENGTH), (0.0, 0.0, 0.4 * LENGTH))))
    system = sk.NonSmoothDynamicalSystem([top], parameters={"precession": precession})
    system.add_shape(sk.Box(0.1, 0.1))
    joint = sk.Joint.ball(top, at=[0.0, 0.0, 0.0])
    system.link(sk.Interaction(joint, sk.EqualityConditionNSL(joint.size), name="pivot"), top)
    return system


def axis(p: FloatArray | list[float]) -> FloatArray:
    """The axis of the top in space: e_3 turned by a quaternion."""
    return sk.rotation_matrix(p)[:, 2]


def start(precession: float) -> FloatArray:
    """Ω (3,) [rad/s]: the spin, and a rotation about the vertical whose part along the axis it contains."""
    return np.array([0.0, precession * sin(TILT), SPIN])


def slow_precession() -> float:
    """The smaller rate at which the inclination stays [rad/s]."""
    half = ALONG * SPIN / 2
    product = ABOUT_ORIGIN * cos(TILT) * MASS * GRAVITY * LENGTH
    return (half - sqrt(half**2 - product)) / (ABOUT_ORIGIN * cos(TILT))


def euler(t: float, state: FloatArray) -> FloatArray:
    """Rates of (p, Ω), Euler's equations about the fixed point."""
    p, omega = state[:4], state[4:]
    inertia = np.array([ABOUT_ORIGIN, ABOUT_ORIGIN, ALONG])
    down = -MASS * GRAVITY * sk.rotation_matrix(p)[2]  # R(p)ᵀ (0, 0, −m γ)
    moment = LENGTH * np.array([-down[1], down[0], 0.0])
    w, x, y, z = p
    turn = np.array([[-x, -y, -z], [w, -z, y], [z, w, -x], [-y, x, w]])
    return np.concatenate([turn @ omega / 2, (moment - np.cross(omega, inertia * omega)) / inertia])


def reference(times: FloatArray, precession: float = 0.0) -> Motion:
    """Solve Euler's equations with a relative tolerance of 1e-13, at these times [s]."""
    from scipy.integrate import solve_ivp  # slow to import, and not needed to run the model

    p = [cos(TILT / 2), sin(TILT / 2), 0.0, 0.0]
    solution = solve_ivp(
        euler,
        (0.0, float(times[-1])),
        [*p, *start(precession)],
        "DOP853",
        t_eval=times,
        rtol=1e-13,
        atol=1e-13,
    )
    q, v = np.empty((len(times), 7)), np.empty((len(times), 6))
    for k, (p_k, omega) in enumerate(zip(solution.y[:4].T, solution.y[4:].T, strict=True)):
        R = sk.rotation_matrix(p_k)
        q[k] = [*(LENGTH * R[:, 2]), *(p_k / np.linalg.norm(p_k))]
        v[k] = [*(R @ np.cross(omega, [0.0, 0.0, LENGTH])), *omega]
    return Motion(q, v)


def vertical_momentum(run: Trajectory) -> FloatArray:
    """Angular momentum about the vertical through the origin [kg m²/s], (rows,)."""
    orbital = MASS * (run.q[:, 0] * run.v[:, 1] - run.q[:, 1] * run.v[:, 0])
    up = np.array([sk.rotation_matrix(p)[2] for p in run.q[:, 3:]])
    return np.asarray(orbital + (up * [ACROSS, ACROSS, ALONG] * run.v[:, 3:]).sum(axis=1))


def turning_inclinations() -> FloatArray:
    """Bounds of cos θ while a top nods that starts without precession, the smaller one first (2,)."""
    # with u = cos θ, u = u0 at the start, and the rate of precession C Ω_3 (u0 − u)/((A + m l²)(1 − u²)), the
    # energy is 2 m γ l (A + m l²)(u0 − u)(1 − u²) = (C Ω_3)² (u0 − u)² where θ turns
    u0, drive = cos(TILT), (ALONG * SPIN) ** 2 / (2 * MASS * GRAVITY * LENGTH * ABOUT_ORIGIN)
    roots = np.roots([1.0, -drive, drive * u0 - 1.0])
    return np.array([float(roots[np.abs(roots) < 1][0]), u0])


def run() -> Trajectory:
    """A second of nodding, from a start without precession."""
    return sk.TimeStepping(build(), SCHEME, TIME_STEP).run(1.0)


def picture(shown: Trajectory) -> Figure:
    """Draw the way of the centre from above, and the inclination."""
    from saltus.examples.figure import sheet

    bounds = np.arccos(turning_inclinations())
    with sheet(1, 2, (9, 4.5)) as (figure, (above, nod)):
        above.plot(1e3 * shown.q[:, 0], 1e3 * shown.q[:, 1])
        circle = np.linspace(0.0, 2 * pi, 200)
        for bound in bounds:
            radius = 1e3 * LENGTH * sin(bound)
            above.plot(radius * np.cos(circle), radius * np.sin(circle), "k--", linewidth=0.8)
            nod.axhline(bound, color="black", linestyle="--", linewidth=0.8)
        above.set_aspect("equal")
        above.set_xlabel("x [mm]")
        above.set_ylabel("y [mm]")
        nod.plot(shown.t, np.arccos(shown.q[:, 2] / LENGTH))
        nod.set_xlabel("time t [s]")
        nod.set_ylabel("inclination θ [rad]")
    return figure


def main() -> None:
    """Print errors, the joint's gap and what is kept."""
    for scheme in ("HalfExplicitTrapezoidalOSI", SCHEME, "HalfExplicitRungeKuttaOSI(tableau=HEM5)"):
        run = sk.TimeStepping(build(), scheme, TIME_STEP).run(1.0)
        exact = reference(run.t)
        momentum = vertical_momentum(run)
        error, gap = np.abs(run.q - exact.q).max(), np.abs(run["pivot"].gap).max()
        print(f"{scheme}: q within {error:.1e}, joint {gap:.1e} m")
        print(
            f"    energy {np.ptp(run.energy) / run.kinetic_energy[0]:.1e}, "
            f"vertical angular momentum {np.ptp(momentum) / momentum[0]:.1e}, relative"
        )


if __name__ == "__main__":
    main()
