"""An integrator in Python: Moreau-Jean time-stepping around the explicit trapezoidal rule.

The forces are averaged over the step, the contacts that are closed at its end get impulses:

    v₁ = v + Δt M(q)⁻¹ h(t, q, v),        q⁺ = q + ½Δt (v + v₁),
    v⁻ = v + ½Δt (M(q)⁻¹ h(t, q, v) + M(q⁺)⁻¹ h(t⁺, q⁺, v₁)),        v⁺ = v⁻ + M(q⁺)⁻¹ W(q⁺) Λ,

with Newton's law (6)-(7) between Wᵀv⁺ + ε Wᵀv⁻ and Λ. Second order where nothing touches; every contact force
is an impulse, as in all Moreau-Jean schemes, so that the order falls to one where something does.

    saltus bench --integrator saltus.examples.extending.trapezoidal_moreau:TrapezoidalMoreauOSI
    saltus conformance saltus.examples.extending.trapezoidal_moreau:TrapezoidalMoreauOSI
"""

from __future__ import annotations

import numpy as np
import saltus.kernel as sk
from saltus.numerics import ContactSolver


class TrapezoidalMoreauOSI(sk.OneStepIntegrator):
    """Moreau-Jean around the explicit trapezoidal rule, written in Python."""

    properties = {"order_free": 2}

    def prepare(self, system: sk.NonSmoothDynamicalSystem, solver: ContactSolver) -> None:
        """Make the parts of a step."""
        if system.coordinates != system.dimension:
            raise ValueError("TrapezoidalMoreauOSI takes systems with q̇ = v only")
        self.start, self.end = sk.Configuration(system), sk.Configuration(system)
        self.contacts = sk.ContactStage(system, solver)

    def step(self, dt: float, state: sk.State, reactions: sk.Reactions) -> sk.StepReport:
        """Take one step."""
        report = sk.StepReport()
        q, v = state.q, state.v
        if not np.array_equal(self.start.q, q):
            self.start.move_to(q, state.t)
        a = self.start.solve_mass(self.start.forces(state.t, v))
        v1 = v + dt * a
        self.end.move_to(q + 0.5 * dt * (v + v1), state.t + dt)
        a1 = self.end.solve_mass(self.end.forces(state.t + dt, v1))
        before = v + 0.5 * dt * (a + a1)

        closed = self.end.closed
        hit = self.contacts.solve(
            closed,
            self.end,
            self.end,
            before,
            before=self.end.velocities(before),
            warm_start=reactions.impulse,
        )
        after = before + hit.velocity

        state.t, state.q, state.v = state.t + dt, self.end.q, after
        reactions.impulse = hit.impulse
        report.impulsive = bool(hit.impulse.any())
        report.closed = len(closed)
        report.residual, report.solver_iterations = hit.residual, hit.iterations
        report.penetration = self.end.penetration
        report.kinetic_energy = self.end.kinetic_energy(after)
        report.work_forces = self.end.kinetic_energy(before) - self.start.kinetic_energy(v)
        report.work_impulse = report.kinetic_energy - self.end.kinetic_energy(before)
        self.start, self.end = self.end, self.start
        return report
