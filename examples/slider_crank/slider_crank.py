r"""The impacting slider crank with dry friction, Section 2.1 of the paper.

A crank turns, a rod follows, and a slider at the rod's end moves in a notch that is a little too wide for
it: its four corners hit the walls, bounce, and slide along them with friction. Three angles describe the
motion, :math:`q = (\theta_1, \theta_2, \theta_3)` of crank, rod and slider, each against the horizontal.

1. Dynamics
-----------
The slider's centre is at

    x = l1 cos θ1 + l2 cos θ2,    y = l1 sin θ1 + l2 sin θ2.

With k = (m2/2 + m3) l1 l2, Lagrange's equations M(q) v̇ = h(q, v) of crank (about its bearing), rod and
slider have

    M = [J1 + (m1/4 + m2 + m3) l1²    k cos(θ1 − θ2)              0 ]
        [k cos(θ1 − θ2)               J2 + (m2/4 + m3) l2²        0 ]
        [0                            0                           J3]

    h = [−k sin(θ1 − θ2) ω2² − (m1/2 + m2 + m3) γ l1 cos θ1]
        [ k sin(θ1 − θ2) ω1² − (m2/2 + m3) γ l2 cos θ2     ]
        [ 0                                                ]

2. Contacts
-----------
A corner (ξ, η) of the slider, in the slider's frame, is at

    x_c = x + ξ cos θ3 − η sin θ3,    y_c = y + ξ sin θ3 + η cos θ3,

the walls are at ±(b + c): the upper corners have the gap g = (b + c) − y_c, the lower ones (b + c) + y_c.
Row 0 of Wᵀ is ∂g/∂q, row 1 the tangential velocity ẋ_c. Newton's impact law with ε_N = 0.4, ε_T = 0 and
Coulomb friction with μ = 0.01 act in each corner.

3. Run it
---------
`build()` composes the model; run this file to see the impacts of the first 0.1 s under two integrators.
The classes below are the model in Python. The same formulas in C++ (slider_crank.cpp) are some twenty
times faster; both give the same trajectory.
"""

from __future__ import annotations

from math import cos, pi, sin
from typing import TYPE_CHECKING, Literal

import saltus.kernel as sk
from saltus._core import (
    CompiledSliderCorner,
    CompiledSliderCrank,
    CompiledSliderGuide,
    SliderCrankParameters,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from saltus.io import Trajectory
    from saltus.scene import Place
    from saltus.typing import FloatArray

Guidance = Literal["frictional", "frictionless", "c=0", "equality"]

CAPTION = (
    "Crank, rod and slider in the first turn, and the gaps of the slider's corners: left and right ones hit "
    "the walls together, bounce and slide. Forces λ act only while a corner stays closed, impulses Λ only "
    "at impacts, the grey lines."
)
WATCH = (
    "Which corner hits, and what then? The first impacts are those of both upper corners, which bounce "
    "ever less until they slide along the upper wall; later the lower ones do so. They never stick: "
    "friction is too small."
)


class SliderCrank(sk.LagrangianDS):
    """Crank, rod and slider, q = (θ1, θ2, θ3) [rad]."""

    def __init__(self, q0: list[float], v0: list[float], parameters: SliderCrankParameters) -> None:
        super().__init__(q0, v0)
        p = self.p = parameters
        self.k = (p.m2 / 2 + p.m3) * p.l1 * p.l2

    def mass(self, q: FloatArray, out: FloatArray) -> None:
        """M(q), zero entries are left alone."""
        p = self.p
        out[0, 0] = p.J1 + (p.m1 / 4 + p.m2 + p.m3) * p.l1 * p.l1
        out[0, 1] = out[1, 0] = self.k * cos(q[0] - q[1])
        out[1, 1] = p.J2 + (p.m2 / 4 + p.m3) * p.l2 * p.l2
        out[2, 2] = p.J3

    def forces(self, t: float, q: FloatArray, v: FloatArray, out: FloatArray) -> None:
        """h(q, v): centrifugal terms and gravity."""
        p = self.p
        coupling = self.k * sin(q[0] - q[1])
        out[0] = -coupling * v[1] * v[1] - (p.m1 / 2 + p.m2 + p.m3) * p.gravity * p.l1 * cos(q[0])
        out[1] = coupling * v[0] * v[0] - (p.m2 / 2 + p.m3) * p.gravity * p.l2 * cos(q[1])

    def potential_energy(self, q: FloatArray) -> float:
        """Of gravity [J]."""
        p = self.p
        crank = (p.m1 / 2 + p.m2 + p.m3) * p.l1 * sin(q[0])
        return p.gravity * (crank + (p.m2 / 2 + p.m3) * p.l2 * sin(q[1]))


class SliderCorner(sk.LagrangianScleronomousR):
    """A corner (ξ, η) in the notch: η > 0 meets the upper wall, η < 0 the lower one."""

    def __init__(self, xi: float, eta: float, size: int, parameters: SliderCrankParameters) -> None:
        super().__init__(size)
        self.xi, self.eta, self.p = xi, eta, parameters
        self.sign = -1.0 if eta > 0 else 1.0

    def gap(self, q: FloatArray, out: FloatArray) -> None:
        """Distance to the wall [m]."""
        p = self.p
        y = p.l1 * sin(q[0]) + p.l2 * sin(q[1])
        y_corner = y + self.xi * sin(q[2]) + self.eta * cos(q[2])
        out[0] = (p.b + p.c) + self.sign * y_corner

    def jacobian(self, q: FloatArray, out: FloatArray) -> None:
        """Normal row, and the tangential one if there is friction."""
        p, xi, eta = self.p, self.xi, self.eta
        s3, c3 = sin(q[2]), cos(q[2])
        out[0, 0] = self.sign * p.l1 * cos(q[0])
        out[0, 1] = self.sign * p.l2 * cos(q[1])
        out[0, 2] = self.sign * (xi * c3 - eta * s3)
        if self.size == 2:
            out[1, 0] = -p.l1 * sin(q[0])
            out[1, 1] = -p.l2 * sin(q[1])
            out[1, 2] = -xi * s3 - eta * c3

    def curvature(self, q: FloatArray, v: FloatArray, out: FloatArray) -> None:
        """(dWᵀ/dt) v."""
        p, xi, eta = self.p, self.xi, self.eta
        s3, c3 = sin(q[2]), cos(q[2])
        w1, w2, w3 = v[0] * v[0], v[1] * v[1], v[2] * v[2]
        out[0] = self.sign * (-p.l1 * sin(q[0]) * w1 - p.l2 * sin(q[1]) * w2 - (xi * s3 + eta * c3) * w3)
        if self.size == 2:
            out[1] = -p.l1 * cos(q[0]) * w1 - p.l2 * cos(q[1]) * w2 - (xi * c3 - eta * s3) * w3


class SliderGuide(sk.LagrangianScleronomousR):
    """The slider on a straight guide without clearance: y = 0 and θ3 = 0."""

    def __init__(self, parameters: SliderCrankParameters) -> None:
        super().__init__(2)
        self.p = parameters

    def gap(self, q: FloatArray, out: FloatArray) -> None:
        """Distances from the guide [m, rad]."""
        p = self.p
        out[0] = p.l1 * sin(q[0]) + p.l2 * sin(q[1])
        out[1] = q[2]

    def jacobian(self, q: FloatArray, out: FloatArray) -> None:
        """Gradients of both."""
        p = self.p
        out[0, 0] = p.l1 * cos(q[0])
        out[0, 1] = p.l2 * cos(q[1])
        out[1, 2] = 1.0

    def curvature(self, q: FloatArray, v: FloatArray, out: FloatArray) -> None:
        """(dWᵀ/dt) v."""
        p = self.p
        out[0] = -p.l1 * sin(q[0]) * v[0] * v[0] - p.l2 * sin(q[1]) * v[1] * v[1]


def build(guidance: Guidance = "frictional", *, compiled: bool = True) -> sk.NonSmoothDynamicalSystem:
    """Compose the model with the parameters and initial conditions of Table 1.

    Parameters
    ----------
    guidance : how the slider is led: in the notch with or without friction, in a notch without clearance
        ("c=0", four corners), or by two equality constraints
    compiled : the model in C++, otherwise the classes above
    """
    p = SliderCrankParameters()
    if guidance == "c=0":
        p.c = 0.0
    crank_type = CompiledSliderCrank if compiled else SliderCrank
    crank = crank_type([0.0, 0.0, 0.0], [150.0, -75.0, 0.0], p)
    add_shapes(crank, p)
    parameters = {name: getattr(p, name) for name in vars(SliderCrankParameters) if not name.startswith("_")}
    system = sk.NonSmoothDynamicalSystem([crank], parameters={**parameters, "guidance": guidance})
    for wall in (-p.b - p.c, p.b + p.c):
        system.add_shape(sk.Polyline(((p.l2 - p.l1 - 2 * p.a, wall), (p.l1 + p.l2 + 2 * p.a, wall))))
    if guidance == "equality":
        guide = CompiledSliderGuide(p) if compiled else SliderGuide(p)
        system.link(sk.Interaction(guide, sk.EqualityConditionNSL(2), name="guide"), crank)
        return system
    law: sk.NonSmoothLaw
    if guidance == "frictional":
        law = sk.NewtonImpactFrictionNSL(0.4, 0.0, 0.01, 2)
    else:
        law = sk.NewtonImpactNSL(0.4)
    corner_type = CompiledSliderCorner if compiled else SliderCorner
    for name, xi, eta in [
        ("upper left", -p.a, p.b),
        ("upper right", p.a, p.b),
        ("lower left", -p.a, -p.b),
        ("lower right", p.a, -p.b),
    ]:
        corner = sk.Interaction(corner_type(xi, eta, law.size, p), law, name=name)
        corner.show_at(corner_place(xi, eta, law.size, p))
        system.link(corner, crank)
    return system


def add_shapes(crank: sk.LagrangianDS, p: SliderCrankParameters) -> None:
    """What pictures show: two bars and a block."""

    def joint(q: FloatArray) -> tuple[float, float]:
        return p.l1 * cos(q[0]), p.l1 * sin(q[0])

    def slider(q: FloatArray) -> tuple[float, float, float]:
        x, y = joint(q)
        return x + p.l2 * cos(q[1]), y + p.l2 * sin(q[1]), q[2]

    crank.add_shape(sk.Polyline(((0.0, 0.0), (p.l1, 0.0))), pose=lambda q: (0.0, 0.0, q[0]))
    crank.add_shape(sk.Polyline(((0.0, 0.0), (p.l2, 0.0))), pose=lambda q: (*joint(q), q[1]))
    crank.add_shape(sk.Box(2 * p.a, 2 * p.b), pose=slider)


def corner_place(xi: float, eta: float, size: int, p: SliderCrankParameters) -> Place:
    """Where pictures show a corner, and along what its rows push the slider."""
    normal, tangent = (0.0, -1.0 if eta > 0 else 1.0), (1.0, 0.0)

    def place(q: FloatArray) -> tuple[tuple[float, float], ...]:
        x = p.l1 * cos(q[0]) + p.l2 * cos(q[1]) + xi * cos(q[2]) - eta * sin(q[2])
        y = p.l1 * sin(q[0]) + p.l2 * sin(q[1]) + xi * sin(q[2]) + eta * cos(q[2])
        return ((x, y), normal, tangent)[: 1 + size]

    return place


def run() -> Trajectory:
    """The first 0.1 s with friction."""
    return sk.TimeStepping(build(), "HalfExplicitTrapezoidalOSI", time_step=5e-5).run(0.1)


def picture(shown: Trajectory) -> Figure:
    """Draw the mechanism, gaps, forces and impulses."""
    from saltus import plot
    from saltus.examples.figure import sheet

    turn = (shown.q[:, 0] < 2 * pi).nonzero()[0][-1]
    with sheet(2, 2, (11, 7)) as (figure, (mechanism, gaps, forces, impulses)):
        plot.shapes(mechanism, shown, [int(part * turn) for part in (0.08, 0.24, 0.39, 0.55)])
        for ax, panel in ((gaps, plot.gaps), (forces, plot.forces), (impulses, plot.impulses)):
            panel(ax, shown)
            ax.set_xlabel("time t [s]")
    return figure


def main() -> None:
    """Print each impact of the first 0.1 s, under both integrators."""
    for integrator in (sk.HalfExplicitTrapezoidalOSI(), sk.ExplicitMoreauJeanOSI()):
        trajectory = sk.TimeStepping(build(), integrator, time_step=1e-5).run(until=0.1)
        print(f"{integrator.name}: {trajectory.impulsive.sum()} impulsive steps of {len(trajectory) - 1}")
        if integrator.name == "ExplicitMoreauJeanOSI":
            continue  # every step with a closed contact is impulsive: forces and impacts are not told apart
        for row in trajectory.impulsive.nonzero()[0]:
            hit = [name for name in trajectory.contacts if trajectory[name].impulse[row, 0] > 0]
            impulse = sum(trajectory[name].impulse[row, 0] for name in hit)
            turns = trajectory.q[row, 0] / (2 * pi)
            print(
                f"  t = {trajectory.t[row]:.5f} s, turn {turns:5.3f}: {impulse:.2e} N s on {', '.join(hit)}"
            )


if __name__ == "__main__":
    main()
