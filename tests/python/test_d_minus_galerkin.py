"""DMinusGalerkinOSI from Python: options, properties, energy, and where its iteration ends."""

from math import hypot

import numpy as np
import pytest
import saltus.kernel as sk
from saltus import registry
from saltus.conformance.measure import slope, spectral_radius
from saltus.conformance.models import GRAVITY, pendulum, top

MEMBERS = {
    "DMinusGalerkinOSI(stages=1)": 2,
    "DMinusGalerkinOSI": 4,
    "DMinusGalerkinOSI(stages=3)": 6,
    "DMinusGalerkinOSI(stages=3,points=chebyshev)": 4,
}


def test_stages_are_given_as_whole_numbers():
    scheme = sk.DMinusGalerkinOSI(stages=3, points="chebyshev")
    assert scheme.options == {"stages": 3.0, "points": "chebyshev", "activity": "start"}
    assert sk.DMinusGalerkinOSI(np.int64(3)).options["stages"] == 3
    for wrong in (0, 4, 1.5):
        with pytest.raises(ValueError, match=r"DMinusGalerkinOSI: stages must be 1, 2 or 3"):
            sk.DMinusGalerkinOSI(stages=wrong)
    with pytest.raises(ValueError, match="lobatto, chebyshev"):
        sk.DMinusGalerkinOSI(points="gauss")


@pytest.mark.parametrize("spec", MEMBERS)
def test_properties_are_those_of_the_options(spec):
    claims = registry.properties(spec)
    assert [claims[f"order_{what}"] for what in ("free", "bilateral", "sliding")] == [MEMBERS[spec]] * 3
    assert claims["forces_at_rest"]
    assert not claims["implicit"]


@pytest.mark.parametrize("spec", MEMBERS)
def test_energy_is_kept_with_the_order_of_the_member(spec):
    errors, counts = [], {2: (40, 80), 4: (10, 20), 6: (4, 8)}[MEMBERS[spec]]
    for count in counts:
        run = sk.TimeStepping(pendulum(), spec, 0.5 / count).run(0.5)
        energy = 0.5 * np.sum(run.v**2, axis=1) + GRAVITY * run.q[:, 1]
        errors.append(abs(energy[-1] - energy[0]))
    assert slope(1 / np.array(counts), np.array(errors)) > MEMBERS[spec] - 0.5


def test_a_top_keeps_its_quaternion_and_its_joint():
    run = sk.TimeStepping(top(), sk.DMinusGalerkinOSI(stages=3), 4e-3).run(2.0)
    assert np.abs(np.linalg.norm(run.q[:, 3:7], axis=1) - 1).max() < 1e-14
    assert np.abs(run["tip"].gap).max() < 1e-7


def test_beyond_the_iteration_a_step_fails_and_says_so():
    stiff = sk.NonSmoothDynamicalSystem([sk.LagrangianLinearTIDS([1.0], [0.0], [[1.0]], [[1e8]])])
    simulation = sk.TimeStepping(stiff, sk.DMinusGalerkinOSI(), 1e-3)
    with pytest.raises(sk.SimulationError, match="does not converge"):
        simulation.run(1.0)
    assert simulation.q[0] == 1.0


def test_the_iteration_converges_beyond_the_limit_of_stability():
    for stages, largest in ((2, 4.2), (3, 5.2)):
        assert spectral_radius(sk.DMinusGalerkinOSI(stages=stages), largest) > 1.0


def test_a_pendulum_stays_on_its_circle():
    run = sk.TimeStepping(pendulum(), sk.DMinusGalerkinOSI(stages=3), 0.02).run(20.0)
    assert hypot(*run.q[-1]) == pytest.approx(0.8, abs=1e-9)
