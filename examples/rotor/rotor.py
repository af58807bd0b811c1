r"""The rotor with a journal bearing, Section 6.2 of the paper.

A flexible axle carries a flywheel. Its right end is held and driven, its left end carries a short cylinder
(the frustum) that may move by 0.1 mm inside of a bearing ring. Driven from rest, and pushed aside by a fault,
the cylinder hits the ring, slides along it and leaves it again. Between these impacts the half-explicit
scheme is of second order; Moreau-Jean stays a scheme of first order all the time.

1. The axle
-----------
x is the axis, z points up. At the station s the cross-section is turned by α(s, t) about the axis, and its
centre is deflected by w and u along the directions that turn with it,

    x(s) = s e_x + w e_y' + u e_z',    e_y' = (0, cos α, sin α),    e_z' = (0, −sin α, cos α).

There is no axial freedom. With A = πr², I_b = πr⁴/4, I_p = 2I_b the energies are

    T = ½∫ρA[(ẇ − α̇u)² + (u̇ + α̇w)²] ds + ½∫ρI_p α̇² ds,
    V = ½∫EI_b(w''² + u''²) ds + ½∫GI_p α'² ds + ∫ρAγ (w sin α + u cos α) ds.

N_A elements have 5 freedoms a node, (α, w, w', u, u'): α is linear in each of them, w and u are cubic
(Hermite), so that loads at the nodes bend a resting beam exactly. Lagrange's equations give

    M(q) = ∂²T/∂v²,    h(q, v) = −(Ṁv − ∂T/∂q) − ∂V/∂q − d_1 M v − d_2 (rates of twist),

for an axle that turns with α̇ the Coriolis and centrifugal forces 2ρAα̇u̇ + ρAα̇²w along w, and
−2ρAα̇ẇ + ρAα̇²u along u. generate_element.py derives these expressions of an element with SymPy, and
writes them as C++, axle_element.cpp; all integrals are closed but that of gravity, for which three points of
Gauss are taken, in V and so in h. Of the axle, which is 30 freedoms with a varying mass matrix, a test
compares M, h and V with each other.

At x = l_A a spring and a damper hold the section's centre on the axis; the drive's torque T_D acts on α
there, and the fault's T_F about −z on the slopes, which turn with ω = −u̇' e_y' + ẇ' e_z'.

2. What is fixed to it
----------------------
Flywheel and frustum are rigid bodies of 6 freedoms with unit quaternions, q̇ = Y(q)v (74), each welded to the
section at its station by six bilateral constraints. With the tangent t = e_x + w' e_y' + u' e_z' and the
body's axes b_1, b_2, b_3,

    0 = x_B − x(s),    0 = t·b_2,    0 = t·b_3,    0 = e_y'·b_3.

The last one fixes the angle about the axis: that of the section up to the product of the slopes. The bearing
is a third body, held at the origin by c and d on translation and rotation, the rotation by its vector θn.

3. Contact
----------
The frustum is a cylinder about b_1, the ring a circle across the bearing's axis at x = b/2, the middle of the
cylinder's right half. Only there can they touch. With ρ the distance of the cylinder's centre, at b/2 along
b_1, from the bearing's axis,

    g = R − r − ρ,    n = −e_r    (the direction from the axis to that centre, inward).

The obliquity of the cut through the cylinder, r/cos of an angle of 10⁻³, is left out. ε = 0 and friction μ in
the two directions across n: the cylinder's surface slides with rα̇ along the ring.

4. What the paper leaves open
-----------------------------
All start at rest, straight, with the axis in the middle of the ring. Missing inertias are those of the
authors' published example: flywheel diag(0.01, 0.003, 0.003), frustum 0.001 kg and 10⁻⁶, bearing
diag(0.007, 10⁻⁴, 10⁻⁴) kg m². T_F acts all the time. Contacts are closed at g <= 0; the paper's tube of
10⁻⁸ m is not taken. b is half of the frustum's length, as the text has it.

The damper d = 10 of the bearing against rotation and its inertia of 10⁻⁴ have a rate of 10⁵ 1/s; the axle's
fastest bending has ω = 2.1·10⁵ 1/s. The paper's Δt = 5e-6 s is ωΔt = 1.1, where 2 is the limit of the
half-explicit scheme. ExplicitMoreauJeanOSI, whose forces are those of the start of the step, lets undamped
oscillations grow by ½(ωΔt)² in every step, and cannot take this model at any step worth its cost; Moreau-Jean
stands here with θ = ½, implicit in the forces.

5. Run it
---------
Run this file to compare the schemes, with an argument to keep pictures of the orbit and of the contact
force, and an animation of the bent axle, in that folder. comparison.py and animation.py make them; the paper
draws no results of this example. rotor.cpp composes the
same model in C++.

At Δt = 5e-6 s until 0.05 s, on one core,

                                impulsive   time   error of   energy    welds
                                            [s]    the orbit  defect    [m]
    half-explicit               0.50 %      0.37   3.0e-7 m   1.1e-4    9e-10
    half-explicit, predicted    0.50 %      0.34   2.1e-7 m   1.1e-4    9e-10
    half-explicit, stabilised   0.50 %      0.47   3.1e-7 m   1.1e-4    3e-16
    Moreau-Jean, θ = ½                      1.29   3.5e-7 m   1e-14     5e-10

The paper has 1.3 % of impulsive steps, with its tube around g = 0, and 0.32 for the time of a half-explicit
step over one of Moreau-Jean's; here that is 0.29, and 0.2 for the same error of the orbit. In contact both
errors fall with Δt, not with Δt²: it is a matter of a step when an impact comes. Before the first impact the
half-explicit error falls with Δt² once Δt is below 1e-6 s, which resolves the fastest bending that the sudden
torques set off. The half-explicit defect of energy falls with Δt³; that of Moreau-Jean is rounding, since it
counts work with the mean velocity of a step. About half of the time of a half-explicit step goes into M⁻¹W of
the welds.
"""

from __future__ import annotations

import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import saltus.kernel as sk
from numpy.typing import ArrayLike
from saltus._core import (
    AxleParameters,
    CompiledAxle,
    CompiledAxleWeld,
    CompiledJournalContact,
    CompiledMountedBody,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from saltus.io import Trajectory
    from saltus.typing import FloatArray

TIME_STEP = 5e-6  #: of the paper [s]
END = 0.05  #: the drive acts until then [s]
STABILISED = "HalfExplicitTrapezoidalOSI(impulsive_substeps=10,activity=sticky,stabilization=position)"
CONTACT = "journal"  #: name of the contact; the welds are "flywheel weld" and "frustum weld"

EXAGGERATION = 30  # of displacements and clearance in the animation

CAPTION = (
    "Way of the cylinder's centre in the bearing ring, and gap, contact force and impulses over the time. "
    "Driven from rest and pushed aside, the cylinder falls into the ring after 4.5 ms, bounces some dozens "
    "of times, and slides; bending lifts it off at 18 and at 37 ms."
)
WATCH = (
    "The section at the bearing, displacements 30 times as large: the cylinder falls into the ring, "
    "bounces and slides around in it. The ring presses inward, green; impacts are red."
)


@dataclass(frozen=True)
class Parameters:
    """Table 6, and what it leaves out."""

    elements: int = 5  #: N_A
    length: float = 0.59  #: l_A [m]
    radius: float = 12.5e-3  #: r_A [m]
    density: float = 7.85e3  #: ρ_A [kg/m³]
    E: float = 2.1e11  #: Young modulus [N/m²]
    G: float = 0.81e11  #: shear modulus [N/m²]
    mass_damping: float = 60.0  #: d_1A [1/s]
    torsional_damping: float = 1e-3  #: d_2A [kg m²/s]
    mount_stiffness: float = 6e6  #: c_D [N/m]
    mount_damping: float = 10.0  #: d_D [N s/m]
    drive_torque: float = 100.0  #: T_D about x [N m]
    drive_until: float = 0.05  #: [s]
    fault_torque: float = 10.0  #: T_F about −z [N m]
    gravity: float = 9.81  #: γ along −z [m/s²]
    flywheel_at: float = 0.18  #: x_F [m]
    flywheel_mass: float = 4.98  #: m_F [kg]
    flywheel_inertia: tuple[float, float, float] = (0.01, 0.003, 0.003)  #: J_F first [kg m²]
    frustum_mass: float = 1e-3  #: [kg]
    frustum_inertia: float = 1e-6  #: about every axis [kg m²]
    frustum_radius: float = 1e-2  #: r_JF [m]
    frustum_half_length: float = 19e-3  #: b_JF [m]
    bearing_radius: float = 1.01e-2  #: r_JB [m]
    bearing_mass: float = 2.3  #: m_JB [kg]
    bearing_inertia: tuple[float, float, float] = (0.007, 1e-4, 1e-4)  #: [kg m²]
    bearing_stiffness: float = 1e6  #: c_JB [N/m, N m]
    bearing_damping: float = 10.0  #: d_JB [N s/m, N m s]
    friction: float = 0.01  #: μ

    @property
    def clearance(self) -> float:
        """What the frustum can move in the bearing [m]."""
        return self.bearing_radius - self.frustum_radius

    @property
    def freedoms(self) -> int:
        """Of the axle."""
        return 5 * (self.elements + 1)

    @property
    def axle(self) -> AxleParameters:
        """Those of the axle alone, for C++."""
        found = AxleParameters()
        for name, value in asdict(self).items():
            if hasattr(found, name):
                setattr(found, name, value)
        return found


def build(
    parameters: Parameters | None = None, q0: ArrayLike | None = None, v0: ArrayLike | None = None
) -> sk.NonSmoothDynamicalSystem:
    """Compose axle, flywheel, frustum and bearing, in that order.

    Parameters
    ----------
    parameters : those of Table 6 if they are not given
    q0, v0 : (30,) start of the axle, 5 freedoms (α, w, w', u, u') a node; straight and at rest if they are
        not given. Flywheel and frustum follow it, the bearing rests at the origin.

    Raises
    ------
    ValueError
        If a size or a value is wrong.
    """
    p = parameters or Parameters()
    zero = np.zeros(p.freedoms)
    axle = CompiledAxle(zero if q0 is None else q0, zero if v0 is None else v0, p.axle)
    flywheel = attached(axle, p.flywheel_at, p.flywheel_mass, p.flywheel_inertia, p.gravity)
    frustum = attached(axle, 0.0, p.frustum_mass, (p.frustum_inertia,) * 3, p.gravity)
    bearing = CompiledMountedBody(
        [0, 0, 0, 1, 0, 0, 0],
        np.zeros(6),
        mass=p.bearing_mass,
        inertia=p.bearing_inertia,
        stiffness=p.bearing_stiffness,
        damping=p.bearing_damping,
        gravity=p.gravity,
    )
    system = sk.NonSmoothDynamicalSystem([axle, flywheel, frustum, bearing], parameters=asdict(p))
    for name, at, body in (("flywheel", p.flywheel_at, flywheel), ("frustum", 0.0, frustum)):
        weld = CompiledAxleWeld(axle, at)
        system.link(sk.Interaction(weld, sk.EqualityConditionNSL(6), name=f"{name} weld"), axle, body)
    frustum.add_shape(sk.Disc(p.frustum_radius), pose=lambda q: (*across(q, along_of(p)), 0.0))
    bearing.add_shape(ring(p), pose=lambda q: (*across(q, 0.0), 0.0))
    journal = CompiledJournalContact(
        3, disc=p.frustum_radius, circle=p.bearing_radius, along=0.5 * p.frustum_half_length
    )
    law = sk.NewtonImpactFrictionNSL(0.0, 0.0, p.friction, 3)
    contact = sk.Interaction(journal, law, name=CONTACT)
    contact.show_at(lambda q: touching(q, p))
    system.link(contact, frustum, bearing)
    return system


def along_of(p: Parameters) -> float:
    """Where on the frustum's axis the ring cuts it [m]."""
    return 0.5 * p.frustum_half_length


def across(q: FloatArray, along: float) -> FloatArray:
    """Pictures show the section at the ring: place of a body's axis there, (y, z), exaggerated [m]."""
    return np.asarray(EXAGGERATION * (q[1:3] + along * sk.rotation_matrix(q[3:])[1:, 0]))


def ring(p: Parameters) -> sk.Polyline:
    """The ring, with its clearance exaggerated as well."""
    radius, angles = p.frustum_radius + EXAGGERATION * p.clearance, np.linspace(0.0, 2 * np.pi, 97)
    return sk.Polyline(tuple((radius * np.cos(angle), radius * np.sin(angle)) for angle in angles))


def touching(q: FloatArray, p: Parameters) -> tuple[FloatArray, FloatArray]:
    """The point of the frustum that is next to the ring, and where the ring pushes it."""
    centre = across(q[:7], along_of(p))
    outward = centre - across(q[7:], 0.0)
    outward /= np.linalg.norm(outward) or 1.0
    return centre + p.frustum_radius * outward, -outward


def attached(
    axle: CompiledAxle, at: float, mass: float, inertia: tuple[float, float, float], gravity: float
) -> sk.NewtonEulerDS:
    """A body that starts where the axle's section at that station is, and moves with it."""
    q0, v0 = CompiledAxleWeld.held(axle, at)
    return sk.NewtonEulerDS(q0, v0, mass, inertia, force=[0, 0, -mass * gravity])


def run() -> Trajectory:
    """Start of the drive, with the step of the paper."""
    scheme = "HalfExplicitTrapezoidalOSI(impulsive_substeps=10)"
    return sk.TimeStepping(build(), scheme, TIME_STEP).run(END)


def picture(shown: Trajectory) -> Figure:
    """Draw the orbit, and what the contact does."""
    from saltus.examples.rotor import comparison

    return comparison.draw_run(shown)


def main() -> None:
    """Compare the schemes; draw the pictures into a folder if one is named."""
    from saltus.examples.rotor import comparison

    comparison.show(Path(sys.argv[1]) if len(sys.argv) > 1 else None)


if __name__ == "__main__":
    main()
