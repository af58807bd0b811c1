"""Scripts derive from the classes and keep attributes of their own, whose names may be those of methods."""

import numpy as np
import pytest
import saltus.siconos.kernel as sk

SYSTEM = "mass q v K C z M p start link native held driven varies overrides live dimension fExt velocity"
RELATION = "native link follow overrides jachq C h H e size live"
INTERACTION = "native live first_order dimension number links systems"


def bounce(system=(), relation=(), interaction=(), model=()):
    """Height of a ball after a bounce; the objects have these attributes."""

    def add(instance, names):
        for name in names:
            setattr(instance, name, 5.0)
        return instance

    class Ball(sk.LagrangianDS):
        def __init__(self):
            super().__init__([0.1], [0.0], [[2.0]])
            add(self, system)

        def computeFExt(self, time):
            self.setFExtPtr(np.array([-20.0]))

    class Floor(sk.LagrangianScleronomousR):
        def __init__(self):
            super().__init__()
            add(self, relation)

        def computeh(self, q, z, y):
            y[0] = q[0]

        def computeJachq(self, q, z):
            self.setJachqPtr(np.array([[1.0]]))

    ball = Ball()
    floor = add(sk.Interaction(sk.NewtonImpactNSL(0.5), Floor()), interaction)
    nsds = add(sk.NonSmoothDynamicalSystem(0, 0.2), model)
    nsds.insertDynamicalSystem(ball)
    nsds.link(floor, ball)
    steps = sk.TimeDiscretisation(0, 1e-2)
    simulation = sk.TimeStepping(nsds, steps, sk.MoreauJeanOSI(0.5), sk.LCP())
    simulation.run()
    return simulation.trajectory.q[-1, 0]


@pytest.mark.parametrize("name", SYSTEM.split())
def test_a_system_can_have_any_attribute(name):
    assert bounce(system=[name]) == bounce()


@pytest.mark.parametrize("name", RELATION.split())
def test_a_relation_can_have_any_attribute(name):
    assert bounce(relation=[name]) == bounce()


@pytest.mark.parametrize("name", INTERACTION.split())
def test_interactions_and_models_can_have_any_attribute(name):
    assert bounce(interaction=[name], model=[name]) == bounce()
