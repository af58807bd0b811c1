r"""A sphere that slides, then rolls, whatever its spin; and the impact that takes its slip, or some of it.

A solid sphere, I = (2/5) m R², is thrown onto a plane with a velocity and a spin in any direction: billiards
with english.

1. Dynamics
-----------
A rigid body in space, q = (x, p), v = (ẋ, Ω), contact with the plane z = 0. With n = e_z and ω = R(p) Ω the
point of contact slides with

    u = ẋ_T − R ω × n,

and Coulomb's law in space is λ_T = −μ λ_N u/|u| while it slides, |λ_T| <= μ λ_N when it does not.

2. Sliding
----------
A tangential force changes u by 7/2 of what it changes ẋ: with m ẍ_T = λ_T and I ω̇ = −R n × λ_T it is
u̇ = (7/2) λ_T/m, against u, whose direction stays. So the centre runs along a parabola,

    x = x_0 + v_0 t − ½ μ γ t² u_0/|u_0|,    until  t = 2 |u_0|/(7 μ γ),

then along a line, since rolling needs no force. What the contact cannot change is the angular momentum about
its point, and the spin about n:

    v = v_0 − (2/7) u_0.

Without spin that is 5 v_0/7 after 2 v_0/(7 μ γ), with backspin enough the sphere comes back.

3. The impact
-------------
It falls with v_N < 0 and slip u_T. With Newton's ε and ε_T = 0 the impulses are Λ_N = −m (1 + ε) v_N and
Λ_T = −(2/7) m u_T if the cone allows that,

    (2/7) |u_T| <= μ (1 + ε) |v_N|:  it sticks, v_T⁺ = v_T − (2/7) u_T;
    else it slides:                  v_T⁺ = v_T − μ (1 + ε) |v_N| u_T/|u_T|.

4. Run it
---------
Run this file to see both. With topspin or backspin alone every scheme has v exactly: the motion is plane and
the force constant. With english, spin about other axes, the moment turns in the frame of Ω by 0.1 rad a step,
and v has an error of Δt², 4e-4 m/s at 1 ms; Moreau-Jean, which takes W at the end of the step alone, one of
Δt, 1.7e-2 m/s. The explicit Moreau-Jean scheme has v to rounding, though not q.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import saltus.kernel as sk

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from saltus.io import Trajectory
    from saltus.typing import FloatArray

GRAVITY = 9.81  # γ [m/s²]
MASS = 0.2  # [kg]
RADIUS = 0.03  # R [m]
MU = 0.2
VELOCITY = (1.5, 0.0, 0.0)  # v_0 [m/s]
SPIN = (20.0, -90.0, 40.0)  # ω_0 [rad/s], in space: backspin, and english
TIME_STEP = 1e-3  # [s]
SCHEME = "HalfExplicitTrapezoidalOSI"

CAPTION = (
    "Seen from above: the sphere is thrown to the right with backspin and english. While it slides, "
    "friction bends its way to a parabola; from the cross on, which is exact, it rolls along a line. Below, "
    "its velocity."
)
WATCH = (
    "The sphere starts with backspin and english: its contact slides along a curve, orange, and then "
    "rolls, blue, where the force of friction vanishes. Three circles on it show how it turns."
)


def build(
    velocity: Sequence[float] = VELOCITY,
    spin: Sequence[float] = SPIN,
    height: float = 0.0,
    restitution: float = 0.0,
    mu: float = MU,
) -> sk.NonSmoothDynamicalSystem:
    """Compose the sphere, contact "plane".

    Parameters
    ----------
    velocity : v_0 (3,) [m/s]
    spin : ω_0 (3,) [rad/s], in space
    height : of its lowest point over the plane [m]
    restitution : ε of the impact
    """
    sphere = sk.NewtonEulerDS(
        [0.0, 0.0, RADIUS + height, 1.0, 0.0, 0.0, 0.0],
        [*velocity, *spin],  # the frames agree at the start
        MASS,
        3 * [0.4 * MASS * RADIUS**2],
        force=[0.0, 0.0, -MASS * GRAVITY],
    )
    sphere.add_shape(sk.Sphere(RADIUS))
    system = sk.NonSmoothDynamicalSystem([sphere], parameters={"restitution": restitution, "mu": mu})
    system.add_shape(sk.Box(1.0, 0.6), pose=(0.4, 0.1, 0.0))
    plane = sk.SpherePlane(3, radius=RADIUS, point=[0.0, 0.0, 0.0], normal=[0.0, 0.0, 1.0])
    law = sk.NewtonImpactFrictionNSL(restitution, 0.0, mu, 3)
    system.link(sk.Interaction(plane, law, name="plane"), sphere)
    return system


def slip(velocity: Sequence[float] = VELOCITY, spin: Sequence[float] = SPIN) -> FloatArray:
    """Velocity u of the point of contact (2,) [m/s]."""
    v, omega = np.asarray(velocity), np.asarray(spin)
    return np.asarray((v - RADIUS * np.cross(omega, [0.0, 0.0, 1.0]))[:2])


@dataclass(frozen=True)
class Rolling:
    """The end of sliding."""

    t: float  #: [s]
    place: FloatArray  #: of the centre (2,) [m]
    velocity: FloatArray  #: of the centre (2,) [m/s], from then on


def rolling(velocity: Sequence[float] = VELOCITY, spin: Sequence[float] = SPIN, mu: float = MU) -> Rolling:
    """When, where and how fast the sphere begins to roll."""
    u, v = slip(velocity, spin), np.asarray(velocity)[:2]
    t = 2 * float(np.linalg.norm(u)) / (7 * mu * GRAVITY)
    end = v - 2 * u / 7
    return Rolling(t, t * (v + end) / 2, end)


def after_impact(
    velocity: Sequence[float], spin: Sequence[float], restitution: float, mu: float
) -> FloatArray:
    """Velocity of the centre after an impact with this velocity and spin (3,) [m/s]."""
    u, normal = slip(velocity, spin), (1 + restitution) * abs(velocity[2])
    speed = float(np.linalg.norm(u))
    taken = min(2 * speed / 7, mu * normal)  # [m/s], of the centre
    tangential = np.asarray(velocity)[:2] - (taken * u / speed if speed > 0.0 else 0.0)
    return np.array([*tangential, velocity[2] + normal])


def run() -> Trajectory:
    """The throw with backspin and english."""
    return sk.TimeStepping(build(), SCHEME, TIME_STEP).run(1.5)


def picture(shown: Trajectory) -> Figure:
    """Draw the way of the centre from above, and its velocity."""
    from saltus.examples.figure import sheet

    known = rolling()
    with sheet(2, 1, (7, 6.5)) as (figure, (above, speed)):
        above.plot(shown.q[:, 0], shown.q[:, 1])
        above.plot(*known.place, "kx", label="begins to roll, exactly")
        above.set_aspect("equal")
        above.set_xlabel("x [m]")
        above.set_ylabel("y [m]")
        above.legend()
        for k, name in enumerate("xy"):
            speed.plot(shown.t, shown.v[:, k], label=name)
            speed.axhline(known.velocity[k], color="black", linestyle="--", linewidth=0.8)
        speed.axvline(known.t, color="0.7")
        speed.set_xlabel("time t [s]")
        speed.set_ylabel("velocity [m/s]")
        speed.legend()
    return figure


def main() -> None:
    """Print where the sphere begins to roll, and what an impact makes of it."""
    run, known = sk.TimeStepping(build(), SCHEME, TIME_STEP).run(1.5), rolling()
    (vx, vy), (x, y) = run.v[-1, :2], run.q[-1, :2]
    exact = known.place + (run.t[-1] - known.t) * known.velocity
    print(f"rolls from {known.t:.4f} s on with ({vx:+.6f}, {vy:+.6f}) m/s,")
    print(f"    exactly    with ({known.velocity[0]:+.6f}, {known.velocity[1]:+.6f}) m/s;")
    print(f"at 1.5 s it is at ({x:+.6f}, {y:+.6f}) m, exactly ({exact[0]:+.6f}, {exact[1]:+.6f}) m")
    for speed in (1.0, 4.0):
        velocity = (speed, 0.0, -2.0)
        system = build(velocity, (0.0, 0.0, 0.0), height=1e-4, restitution=0.5)
        run = sk.TimeStepping(system, SCHEME, TIME_STEP).run(5 * TIME_STEP)
        hit = int(np.flatnonzero(run.impulsive)[0])
        before = [*velocity[:2], velocity[2] - GRAVITY * run.t[hit]]
        wanted = after_impact(before, (0.0, 0.0, 0.0), 0.5, MU)[0]
        print(
            f"impact with {speed} m/s along the plane: {run.v[hit, 0]:.6f}, exactly {wanted:.6f} m/s after it"
        )


if __name__ == "__main__":
    main()
