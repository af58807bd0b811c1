r"""The elastic bar that hits an obstacle, Section 6.1 of the paper.

A bar flies along its axis against a rigid obstacle. A wave of pressure runs to its free end and back, then
the bar leaves. The exact solution is known, and it jumps: a touchstone of what finite elements and a scheme
make of waves.

1. The continuous bar
---------------------
The displacement q(x, t) of a bar of length L, section S, density ρ and Young modulus E obeys the wave
equation with the speed c0 = √(E/ρ). From the first contact on, with the speed v0,

    the obstacle presses with τ = E S v0/c0, constant, for the time T = 2 L/c0 of the wave's way and back;

then the whole bar moves away with v0. No energy is lost, and there is no impulse: of what stops at once,
the mass is zero.

2. Finite elements
------------------
N rods of length l = L/N with two nodes each have

    M = ρ S l/6 [2 1],    K = E S/l [ 1 −1],
                [1 2]               [−1  1]

the sums of which are tridiagonal, M q̈ + C q̇ + K q = W λ. With `scipy.sparse` they cost what their entries
cost. The first node has the gap g = gap + q_1, W = (1, 0, …, 0)ᵀ, and the impact law with ε = 0.

A node has a mass: the contact takes its velocity by an impulse Λ = v0/(WᵀM⁻¹W), which for N ≫ 1 is
v0 ρ S l/√12, and half of v0 Λ of the energy, a share of 1/(√12 N). Both vanish as the mesh is refined, and
the scheme on velocity level tells them apart from the force λ, which stays.

3. What the mesh adds
---------------------
A velocity that jumps cannot travel through elements unspoilt. With M and K as above short waves run ahead of
the jump, those three elements long √2 times as fast as c0, and near its limit the scheme makes the shortest
faster still. So λ follows τ in the first half of the contact, and rings in the second, before the jump is
back. A little
damping C = δK takes the ringing away. The paper's δ is 10³/E = 4.762e-9 s; what stands there, 10⁻³/E =
4.761e-6 s, are two numbers that do not agree with each other. The first would do nothing, the second is
beyond what an explicit scheme takes.

The scheme is explicit in K: Δt < 2/ω = l/(√3 c0), which is 1.11e-7 s for N = 1000.

4. Run it
---------
Run this file to see forces and times beside the exact ones, with and without damping. The paper starts at
a gap of 5e-5 m, which is 5000 steps of v0 Δt exactly, so that rounding would decide in which step the bar
arrives; half a step more decides it. elastic_bar.cpp is the same in C++, bare_loop.cpp the same scheme
written by hand for this one model.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from math import pi, sqrt
from typing import TYPE_CHECKING

import numpy as np
import saltus.kernel as sk
from scipy import sparse

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from saltus.io import Trajectory

TIME_STEP = 1e-7  #: of the paper [s]
END = 1.5e-3  #: [s]
DAMPING = 1e3 / 2.1e11  #: δ of the damped bar [s]
CONTACT = "obstacle"  #: name of the contact

EXAGGERATION = 500  # of what pictures show of the displacements
SECTIONS = 26  # that they show at most

CAPTION = (
    "Velocity of every section of the bar over the time: the front of the wave runs from the obstacle to "
    "the free end and back, then the bar flies off. Meanwhile the obstacle presses with the force of the "
    "continuous bar, the dashed line, about which the mesh of 50 elements rings."
)
WATCH = (
    "Sections of the bar, displacements 500 times as large: the first one meets the obstacle, a wave of "
    "compression runs through the bar and back, and when it is there again the bar leaves. The force acts "
    "all of that time."
)


@dataclass(frozen=True)
class Parameters:
    """Table 5, with E in N/m²; the gap is half a step's way more than the paper's."""

    L: float = 1.0  #: length [m]
    S: float = 1e-4 * pi  #: section [m²]
    rho: float = 7800.0  #: ρ, density [kg/m³]
    E: float = 2.1e11  #: Young modulus [N/m²]
    v0: float = 0.1  #: speed towards the obstacle [m/s]
    gap: float = 5.0005e-5  #: to the obstacle at the start [m]

    @property
    def wave_speed(self) -> float:
        """c0 = √(E/ρ) [m/s]."""
        return sqrt(self.E / self.rho)

    @property
    def contact_time(self) -> float:
        """T = 2 L/c0 of the continuous bar [s]."""
        return 2 * self.L / self.wave_speed

    @property
    def contact_force(self) -> float:
        """τ = E S v0/c0 of the continuous bar [N]."""
        return self.E * self.S * self.v0 / self.wave_speed

    @property
    def energy(self) -> float:
        """½ ρ S L v0² [J]."""
        return 0.5 * self.rho * self.S * self.L * self.v0**2

    def impulse(self, elements: int) -> float:
        """Λ = v0 ρ S l/√12 of so many elements [N s]."""
        return self.v0 * self.rho * self.S * self.L / elements / sqrt(12)


def assemble(elements: int, diagonal: float, beside: float) -> sparse.csr_array:
    """Sum of [diagonal beside; beside diagonal] over the elements, each on its two nodes."""
    first = np.arange(elements)
    rows = np.concatenate([first, first, first + 1, first + 1])
    columns = np.concatenate([first, first + 1, first, first + 1])
    values = np.repeat([diagonal, beside, beside, diagonal], elements)
    entries = sparse.coo_array((values, (rows, columns)), shape=(elements + 1, elements + 1))
    return sparse.csr_array(entries)  # entries at the same place are summed up


def build(
    elements: int = 50, damping: float = 0.0, parameters: Parameters | None = None
) -> sk.NonSmoothDynamicalSystem:
    """Compose the bar and its obstacle.

    Parameters
    ----------
    elements : N > 0
    damping : δ >= 0 of C = δK [s]
    parameters : those of Table 5 if they are not given

    Raises
    ------
    ValueError
        If elements or damping are something else.
    """
    if elements < 1:
        raise ValueError(f"elements must be at least 1, got {elements}")
    if not 0.0 <= damping < float("inf"):
        raise ValueError(f"damping must be finite and at least 0, got {damping}")
    p = parameters or Parameters()
    l = p.L / elements  # noqa: E741
    nodes = elements + 1
    mass = assemble(elements, p.rho * p.S * l / 3, p.rho * p.S * l / 6)
    stiffness = assemble(elements, p.E * p.S / l, -p.E * p.S / l)
    bar = sk.LagrangianLinearTIDS(
        np.zeros(nodes), np.full(nodes, -p.v0), mass, stiffness, damping * stiffness if damping else None
    )
    system = sk.NonSmoothDynamicalSystem(
        [bar], parameters={**asdict(p), "elements": elements, "damping": damping}
    )
    first_node = sk.LagrangianLinearTIR(np.eye(1, nodes), [p.gap])
    contact = sk.Interaction(first_node, sk.NewtonImpactNSL(0.0), name=CONTACT)
    contact.show_at(lambda q: ((EXAGGERATION * q[0], 0.0), (1.0, 0.0)))
    system.link(contact, bar)
    for node in np.unique(np.linspace(0, elements, SECTIONS).round().astype(int)):
        bar.add_shape(sk.Polyline(((0.0, -0.05 * p.L), (0.0, 0.05 * p.L))), pose=section(node, node * l))
    obstacle = -EXAGGERATION * p.gap
    system.add_shape(sk.Polyline(((obstacle, -0.08 * p.L), (obstacle, 0.08 * p.L))))
    return system


def section(node: int, place: float) -> sk.Pose:
    """Where the section at a node is drawn."""
    return lambda q: (place + EXAGGERATION * q[node], 0.0, 0.0)


def run() -> Trajectory:
    """The impact of 50 elements without damping, until shortly after the bar has left."""
    return sk.TimeStepping(build(), "HalfExplicitTrapezoidalOSI", TIME_STEP, record_every=10).run(1.2e-3)


def picture(shown: Trajectory) -> Figure:
    """Draw the wave, and the force on the obstacle."""
    from saltus.examples.figure import sheet

    p, t = Parameters(), 1e3 * shown.t
    with sheet(2, 1, (8, 6), sharex=True) as (figure, (wave, force)):
        places = np.linspace(0.0, p.L, shown.v.shape[1])
        colors = wave.pcolormesh(
            t, places, shown.v.T, cmap="RdBu_r", vmin=-1.5 * p.v0, vmax=1.5 * p.v0, rasterized=True
        )
        figure.colorbar(colors, ax=wave, label="velocity [m/s]")
        wave.grid(visible=False)
        wave.set_ylabel("place along the bar x [m]")
        force.plot(t, shown[CONTACT].force[:, 0], linewidth=0.8)
        start = t[shown.impulsive][0]
        force.hlines(p.contact_force, start, start + 1e3 * p.contact_time, color="black", linestyle="--")
        force.set_ylabel("force λ [N]")
        force.set_xlabel("time t [ms]")
    return figure


def main() -> None:
    """Print what the obstacle feels, beside what the continuous bar would press."""
    p = Parameters()
    print(f"continuous bar: {p.contact_force:.1f} N for {p.contact_time:.4e} s")
    for elements, damping in ((50, 0.0), (200, 0.0), (200, DAMPING)):
        simulation = sk.TimeStepping(
            build(elements, damping), sk.HalfExplicitTrapezoidalOSI(), TIME_STEP, solver="lemke"
        )
        run = simulation.run(END)
        contact = run[CONTACT]
        pressed = contact.force[:, 0] > 0
        impact = run.t[run.impulsive][0]
        first_half = pressed & (run.t <= impact + p.contact_time / 2)
        print(
            f"{elements} elements, δ = {damping:.3g} s: impulse {contact.impulse.max():.3e} N s, then "
            f"{contact.force[first_half].mean():.1f} ± {contact.force[first_half].std():.0f} N in the first "
            f"half, at most {contact.force.max():.0f} N, for {run.t[pressed][-1] - impact:.4e} s"
        )


if __name__ == "__main__":
    main()
