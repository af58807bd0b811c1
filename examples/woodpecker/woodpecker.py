r"""The woodpecker toy: a limit cycle of sticking, sliding and impacts.

A bird hangs by a spring from a sleeve with play on a pole. It pecks its way down: the tilted sleeve jams, the
bird swings back, the sleeve comes free and slides, beak and sleeve hit the pole, the sleeve jams again. Model
and numbers are those of Glocker, Dynamik von Starrkörpersystemen mit Reibung und Stößen (1995), and of Leine,
Glocker, van Campen, Nonlinear dynamics of the woodpecker toy (2001).

1. Dynamics
-----------
q = (y, φ_M, φ_S): the height of the sleeve and the angles of sleeve and bird, all small, M q̈ + K q = f with

    M = ( m_M + m_S   m_S l_M          m_S l_G       )      K = ( 0   0    0  )
        ( m_S l_M     J_M + m_S l_M²   m_S l_M l_G   )          ( 0   c   −c  )
        ( m_S l_G     m_S l_M l_G      J_S + m_S l_G²)          ( 0  −c    c  )

and the weights f = −γ (m_M + m_S, m_S l_M, m_S l_G).

2. Contacts
-----------
    beak    g = l_M + l_G − l_S − r_0 − h_S φ_S,   ẏ + l_M φ̇_M + (l_G − l_S) φ̇_S,   ε = 1/2
    lower   g = r_M − r_0 + h_M φ_M,               ẏ + r_M φ̇_M,                     ε = 0
    upper   g = r_M − r_0 − h_M φ_M,               ẏ + r_M φ̇_M,                     ε = 0

with the tangential velocities and Coulomb friction, μ = 0.3, ε_T = 0.

3. One dimension is enough
--------------------------
While the lower edge sticks nothing but the bird moves. It begins to slide where λ_T = μ λ_N, at one angle
φ_S: only the bird's rate u there is left to tell, and the motion is a map u → P(u) of numbers. Its fixed
point is the limit cycle. The slope there, −0.84, tells that the cycle is stable, but slow to forget:
deviations alternate and shrink by a sixth a period. `phases.py` computes P by differential equations:

    a period of 0.145976 s, in which the toy falls by 19.4454 mm.

4. Run it
---------
Run this file to see periods and drops. A run starts where the edge begins to slide, with the u of the cycle.
Impacts, five a period, have errors of Δt, smaller ones with `impulsive_substeps`. Periods and drops of a run
alternate about those of the cycle: that is the slope.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import saltus.kernel as sk

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from saltus.io import Trajectory
    from saltus.scene import Place

GRAVITY = 9.81  # γ [m/s²]
MASS_SLEEVE, MASS_BIRD = 3.0e-4, 4.5e-3  # m_M, m_S [kg]
INERTIA_SLEEVE, INERTIA_BIRD = 5.0e-9, 7.0e-7  # J_M, J_S [kg m²]
SPRING = 5.6e-3  # c [N m/rad]
POLE, SLEEVE, HALF_SLEEVE = 2.5e-3, 3.1e-3, 5.8e-3  # r_0, r_M, h_M [m]
TO_SPRING, TO_BIRD = 0.010, 0.015  # l_M, l_G [m]
BEAK_HEIGHT, BEAK_LENGTH = 0.02, 0.0201  # h_S, l_S [m]
MU = 0.3
BEAK_RESTITUTION = 0.5
PLAY = SLEEVE - POLE  # [m]
TIME_STEP = 1e-5  # [s]
SCHEME = "HalfExplicitTrapezoidalOSI(activity=sticky,impact=keep-resting-forces,impulsive_substeps=10)"

M = np.array(
    [
        [MASS_SLEEVE + MASS_BIRD, MASS_BIRD * TO_SPRING, MASS_BIRD * TO_BIRD],
        [
            MASS_BIRD * TO_SPRING,
            INERTIA_SLEEVE + MASS_BIRD * TO_SPRING**2,
            MASS_BIRD * TO_SPRING * TO_BIRD,
        ],
        [MASS_BIRD * TO_BIRD, MASS_BIRD * TO_SPRING * TO_BIRD, INERTIA_BIRD + MASS_BIRD * TO_BIRD**2],
    ]
)
K = SPRING * np.array([[0.0, 0.0, 0.0], [0.0, 1.0, -1.0], [0.0, -1.0, 1.0]])
WEIGHT = -GRAVITY * M[0]  # f: gravity acts like an acceleration of the sleeve upwards

CAPTION = (
    "The toy pecks its way down the pole: sleeve and bird at instants of one period, the height of the "
    "sleeve, which falls by 19.4 mm a period and sticks in between, and the swing of the bird; grey lines "
    "are impacts of the beak and of the sleeve."
)
WATCH = (
    "The tilted sleeve jams: its lower edge sticks, blue. The bird swings back, the sleeve comes free, "
    "slides down the pole and jams again at its upper edge; the beak hits the pole, and the play begins "
    "anew."
)


@dataclass(frozen=True)
class Contact:
    """g = offset + normal · q, γ_T = tangent · q̇."""

    offset: float  #: [m]
    normal: tuple[float, float, float]
    tangent: tuple[float, float, float]
    restitution: float = 0.0


CONTACTS = {
    "beak": Contact(
        TO_SPRING + TO_BIRD - BEAK_LENGTH - POLE,
        (0.0, 0.0, -BEAK_HEIGHT),
        (1.0, TO_SPRING, TO_BIRD - BEAK_LENGTH),
        BEAK_RESTITUTION,
    ),
    "lower": Contact(PLAY, (0.0, HALF_SLEEVE, 0.0), (1.0, SLEEVE, 0.0)),
    "upper": Contact(PLAY, (0.0, -HALF_SLEEVE, 0.0), (1.0, SLEEVE, 0.0)),
}


def sliding_angle() -> float:
    """The bird's angle φ_S at which the jammed lower edge begins to slide [rad]."""
    # The bird's acceleration α = (−c (φ_S − φ_M) − m_S l_G γ)/M_33 leaves for the edge, with M q̈ = (M_13,
    # M_23, M_33) α: λ_T = M_13 α + γ M_11 and h_M λ_N + r_M λ_T = M_23 α − c (φ_S − φ_M) + γ M_12
    #                                                      = M_23 α + M_33 α + γ (M_13 + M_12).
    # λ_T = μ λ_N is linear in α:
    slope = HALF_SLEEVE * M[0, 2] + MU * (SLEEVE * M[0, 2] - M[1, 2] - M[2, 2])
    constant = GRAVITY * (HALF_SLEEVE * M[0, 0] + MU * (SLEEVE * M[0, 0] - M[0, 1] - M[0, 2]))
    acceleration = -constant / slope
    return float(-PLAY / HALF_SLEEVE - (M[2, 2] * acceleration + GRAVITY * M[0, 2]) / SPRING)


def build(rate: float = 17.574666) -> sk.NonSmoothDynamicalSystem:
    """Compose the toy, contacts "beak", "lower" and "upper", jammed and about to slide.

    Parameters
    ----------
    rate : u of the bird, φ̇_S [rad/s]; the default is that of the limit cycle
    """
    toy = sk.LagrangianLinearTIDS(
        [0.0, -PLAY / HALF_SLEEVE, sliding_angle()], [0.0, 0.0, rate], M, K, external_force=WEIGHT
    )
    toy.add_shape(sk.Box(2 * SLEEVE, 2 * HALF_SLEEVE), pose=lambda q: (0.0, q[0], q[1]))
    bird = ((0.0, 0.0), (TO_BIRD, 0.0), (TO_BIRD - BEAK_LENGTH, BEAK_HEIGHT))
    toy.add_shape(sk.Polyline(bird), pose=lambda q: (TO_SPRING, q[0] + TO_SPRING * q[1], q[2]))
    system = sk.NonSmoothDynamicalSystem([toy], parameters={"rate": rate})
    for name, contact in CONTACTS.items():
        relation = sk.LagrangianLinearTIR([contact.normal, contact.tangent], [contact.offset, 0.0])
        interaction = sk.Interaction(
            relation, sk.NewtonImpactFrictionNSL(contact.restitution, 0.0, MU, 2), name=name
        )
        interaction.show_at(on_the_pole(name))
        system.link(interaction, toy)
    for side in (-POLE, POLE):
        system.add_shape(sk.Polyline(((side, -0.12), (side, 0.04))))
    return system


def on_the_pole(name: str) -> Place:
    """Where a contact touches the pole, which pushes to the right."""
    height = {"beak": BEAK_HEIGHT, "lower": -HALF_SLEEVE, "upper": HALF_SLEEVE}[name]
    tangent = np.array(CONTACTS[name].tangent) if name == "beak" else np.eye(3)[0]
    return lambda q: ((POLE, height + float(tangent @ q)), (1.0, 0.0), (0.0, 1.0))


def run() -> Trajectory:
    """Five periods of the limit cycle."""
    return sk.TimeStepping(build(), SCHEME, TIME_STEP, record_every=10).run(0.73)


def picture(shown: Trajectory) -> Figure:
    """Draw the toy in one period, its way down and its swing."""
    from saltus import plot
    from saltus.examples.figure import sheet

    with sheet(1, 3, (10, 4.2), width_ratios=[1, 1.6, 1.6]) as (figure, (toy, way, swing)):
        plot.shapes(toy, shown, [int(row) for row in np.searchsorted(shown.t, (0.0, 0.04, 0.08, 0.12))])
        way.plot(shown.t, 1e3 * shown.q[:, 0])
        way.set_ylabel("height of the sleeve y [mm]")
        swing.plot(shown.t, shown.q[:, 2], label="bird φ_S")
        swing.plot(shown.t, shown.q[:, 1], label="sleeve φ_M")
        swing.set_ylabel("angle [rad]")
        plot.legend_strip(swing)
        for ax in (way, swing):
            plot.mark_impacts(ax, shown)
            ax.set_xlabel("time t [s]")
    return figure


def main() -> None:
    """Print periods and drops of a run, and those of the map."""
    from saltus.examples.woodpecker.phases import limit_cycle

    cycle = limit_cycle()
    for scheme in (SCHEME, "HalfExplicitTrapezoidalOSI", "MoreauJeanOSI"):
        run = sk.TimeStepping(build(), scheme, TIME_STEP).run(1.2)
        pecks = np.flatnonzero(run["beak"].impulse[:, 0] > 0)
        periods = ", ".join(f"{1e3 * period:.2f}" for period in np.diff(run.t[pecks]))
        drops = ", ".join(f"{1e3 * drop:.2f}" for drop in -np.diff(run.q[pecks, 0]))
        print(f"{scheme}\n    periods {periods} ms\n    drops {drops} mm")
    print(
        f"exactly {1e3 * cycle.period:.4f} ms, {1e3 * cycle.drop:.4f} mm; slope of the map {cycle.slope:.4f}"
    )


if __name__ == "__main__":
    main()
