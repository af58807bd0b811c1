"""Models of Siconos, adopted and run, against the runs of Siconos itself; prints differences as JSON.

Run by the Python that has Siconos: ``python3 adopted.py SITE LIBRARY``, where SITE is the folder of packages
that Saltus is in, and LIBRARY the path of a compiled pendulum_plugin.cpp.
"""

import json
import site
import sys
from pathlib import Path

site.addsitedir(sys.argv[1])  # after the packages of this Python, which come first

import numpy as np
import saltus.kernel
import siconos.kernel as sk
import siconos.numerics as sn
from saltus.siconos import adopt

LIBRARY = Path(sys.argv[2])
kept = []  # objects with overrides must outlive their models


def model_of(until, *systems):
    model = sk.NonSmoothDynamicalSystem(0.0, until)
    for ds in systems:
        model.insertDynamicalSystem(ds)
    return model


def bouncing_ball():
    ball = sk.LagrangianLinearTIDS([1.0, 0.0, 0.0], [0.0, 0.0, 0.0], np.diag([2.0, 2.0, 0.1]))
    ball.setFExtPtr([-2.0 * 9.81, 0.0, 0.0])
    floor = sk.Interaction(sk.NewtonImpactNSL(0.9), sk.LagrangianLinearTIR([[1.0, 0.0, 0.0]], [-0.1]))
    model = model_of(5.0, ball)
    model.link(floor, ball)
    return model, ball, floor, sk.LCP(), 5e-3


class Pendulum(sk.LagrangianDS):
    """With a force that depends on the position and one that depends on the time."""

    def __init__(self):
        super().__init__([1.0], [0.0], [[4.5]])
        self.setFIntPtr([0.0])
        self.setFGyrPtr([0.0])

    def computeFInt(self, time, position, velocity):
        self.fInt()[0] = 2.0 * 9.81 * 1.5 * np.sin(position[0]) - 3.0 * np.cos(2.0 * time)

    def computeFGyr(self, position, velocity):
        self.fGyr()[0] = 0.2 * velocity[0] * abs(velocity[0])


def pendulum():
    ds = Pendulum()
    kept.append(ds)
    wall = sk.Interaction(sk.NewtonImpactNSL(0.8), sk.LagrangianLinearTIR([[1.0]], [0.3]))
    model = model_of(3.0, ds)
    model.link(wall, ds)
    return model, ds, wall, sk.LCP(), 1e-3


def friction_oscillator():
    block = sk.LagrangianLinearTIDS(
        [1.0, 0.0], [0.0, 0.0], np.eye(2), np.diag([25.0, 0.0]), np.diag([0.1, 0.0])
    )
    block.setFExtPtr([0.0, -10.0])
    law = sk.NewtonImpactFrictionNSL(0.0, 0.0, 0.15, 2)
    floor = sk.Interaction(law, sk.LagrangianLinearTIR([[0.0, 1.0], [1.0, 0.0]]))
    model = model_of(3.0, block)
    model.link(floor, block)
    problem = sk.FrictionContact(2, sn.SICONOS_FRICTION_2D_NSGS)
    problem.numericsSolverOptions().iparam[sn.SICONOS_IPARAM_MAX_ITER] = 1000
    problem.numericsSolverOptions().dparam[sn.SICONOS_DPARAM_TOL] = 1e-14
    return model, block, floor, problem, 1e-3


def two_oscillators():
    """Two systems that hit each other, one of them without external forces, one diagonal."""
    first = sk.LagrangianLinearTIDS(
        [0.3, 0.0], [0.0, 2.0], [[2.0, 0.5], [0.5, 1.0]], np.diag([40.0, 30.0]), np.eye(2)
    )
    second = sk.LagrangianLinearDiagonalDS([1.0], [-1.0], [20.0])
    law = sk.NewtonImpactNSL(0.5)
    contact = sk.Interaction(law, sk.LagrangianLinearTIR([[1.0, 0.0, -1.0]], [-0.1]))
    model = model_of(3.0, second, first)
    model.link(contact, second, first)
    return model, first, contact, sk.LCP(), 1e-3


def compiled_pendulum():
    """Forces and the distance from a circle are functions of a plugin."""
    ds = sk.LagrangianDS([1.0, 0.2], [0.0, 0.5], [[2.0, 0.3], [0.3, 1.0]])
    library = str(LIBRARY)
    ds.setComputeFIntFunction(library, "internal_force")
    ds.setComputeFExtFunction(library, "external_force")
    relation = sk.LagrangianScleronomousR(
        f"{LIBRARY.with_suffix('')}:distance", f"{LIBRARY.with_suffix('')}:gradient"
    )
    contact = sk.Interaction(sk.NewtonImpactNSL(0.5), relation)
    model = model_of(2.0, ds)
    model.link(contact, ds)
    return model, ds, contact, sk.LCP(), 1e-3


def moving_floor():
    """A relation that depends on the time, of the plugin."""
    ds = sk.LagrangianLinearTIDS([1.0, 0.0], [0.0, 0.5], np.diag([2.0, 1.0]))
    ds.setFExtPtr([-2.0 * 9.81, 0.0])
    functions = [f"{LIBRARY.with_suffix('')}:height{which}" for which in ("", "_gradient", "_rate")]
    floor = sk.Interaction(sk.NewtonImpactNSL(0.7), sk.LagrangianRheonomousR(*functions))
    model = model_of(3.0, ds)
    model.link(floor, ds)
    return model, ds, floor, sk.LCP(), 1e-3


def compare(build):
    model, ds, interaction, problem, dt = build()
    native = adopt(model)
    run = saltus.kernel.TimeStepping(native, saltus.kernel.MoreauJeanOSI(0.5), dt).run(model.finalT())
    systems = model.dynamicalSystemsVector()
    place = [one.number() for one in systems].index(ds.number())
    first = sum(one.dimension() for one in systems[:place])
    contact = run[f"interaction {interaction.number()}"]
    columns = slice(first, first + ds.dimension())
    ours = np.column_stack([run.q[1:, columns], run.v[1:, columns], contact.impulse[1:]])

    simulation = sk.TimeStepping(model, sk.TimeDiscretisation(0.0, dt), sk.MoreauJeanOSI(0.5), problem)
    simulation.setNewtonTolerance(1e-14)
    rows = []
    while simulation.hasNextEvent():
        simulation.computeOneStep()
        rows.append(np.concatenate([ds.q(), ds.velocity(), interaction.lambda_(1)]))
        simulation.nextStep()
    theirs = np.array(rows)
    assert ours.shape == theirs.shape
    scale = np.abs(theirs).max(axis=0)
    impacts = np.count_nonzero(theirs[:, 2 * ds.dimension()])
    return {
        "difference": (np.abs(ours - theirs) / np.where(scale > 0.0, scale, 1.0)).max(),
        "impacts": impacts,
    }


def kinetic_energy_of_a_compiled_mass():
    """At t0, its difference from ½ v·M(q)v: schemes of both take a varying M at different positions."""
    ds = sk.LagrangianDS([1.0, 0.2], [0.4, 0.5])
    ds.setComputeMassFunction(str(LIBRARY), "mass")
    run = saltus.kernel.TimeStepping(adopt(model_of(1.0, ds)), saltus.kernel.MoreauJeanOSI(0.5), 1e-3).run(
        0.0
    )
    M = np.array([[2.0 + 0.5 * np.sin(0.2), 0.3], [0.3, 2.0]])
    return float(run.kinetic_energy[0] - 0.5 * np.array([0.4, 0.5]) @ M @ [0.4, 0.5])


class Wall(sk.LagrangianScleronomousR):
    def computeh(self, q, z, y):
        y[0] = q[0] - 0.1

    def computeJachq(self, q, z):
        self.jachq()[0, 0] = 1.0


def effect_of_overriding_a_relation():
    """What a relation in Python changes, compared with the same one that is linear."""
    ends = []
    for relation in (Wall(), sk.LagrangianLinearTIR([[1.0]], [-0.1])):
        kept.append(relation)
        ball = sk.LagrangianLinearTIDS([1.0], [0.0], [[2.0]])
        ball.setFExtPtr([-20.0])
        model = model_of(2.0, ball)
        model.link(sk.Interaction(sk.NewtonImpactNSL(0.9), relation), ball)
        ends.append(saltus.kernel.TimeStepping(adopt(model), "HalfExplicitTrapezoidalOSI", 1e-3).run(2.0))
    assert np.count_nonzero(ends[0].impulsive) >= 2
    return float(np.abs(ends[0].q - ends[1].q).max())


def refusal(*systems, link=None):
    try:
        model = model_of(1.0, *systems)
        if link:
            model.link(link, systems[0])
        adopt(model)
    except TypeError as error:
        return str(error)
    return "nothing was refused"


body = sk.NewtonEulerDS([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0], np.zeros(6), 1.0, np.eye(3))
ball = sk.LagrangianLinearTIDS([1.0], [0.0], [[1.0]])
relay = sk.Interaction(sk.RelayNSL(1), sk.LagrangianLinearTIR([[1.0]]))
try:
    adopt(ball)
except TypeError as error:
    no_model = str(error)
builders = (bouncing_ball, pendulum, friction_oscillator, two_oscillators, compiled_pendulum, moving_floor)
results = {
    "runs": {build.__name__: compare(build) for build in builders},
    "kinetic energy": kinetic_energy_of_a_compiled_mass(),
    "relation": effect_of_overriding_a_relation(),
    "refusals": [refusal(body), refusal(ball, link=relay), no_model],
}
print(json.dumps(results))
