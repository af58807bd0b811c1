"""The slider crank: Tables 2 and 3, and the two languages against each other."""

import numpy as np
import pytest
import saltus.kernel as sk
from saltus.examples.slider_crank import convergence
from saltus.examples.slider_crank.slider_crank import build


def silent(label, fraction):
    pass


@pytest.fixture(scope="module")
def table2():
    return {(row.scheme, row.variant, row.dt): row for row in convergence.table2(silent)}


@pytest.fixture(scope="module")
def table3():
    return {(row.scheme, row.dt): row for row in convergence.table3(silent)}


@pytest.mark.parametrize(
    ("scheme", "variant", "dt", "error"),
    [
        ("HalfExplicitTrapezoidalOSI", "c=0", 1e-3, 0.493),
        ("HalfExplicitTrapezoidalOSI", "c=0", 1e-4, 0.0259),
        ("HalfExplicitTrapezoidalOSI", "c=0", 1e-5, 0.000832),
        ("ExplicitMoreauJeanOSI", "c=0", 1e-3, 0.673),
        ("ExplicitMoreauJeanOSI", "c=0", 1e-4, 0.212),
        ("ExplicitMoreauJeanOSI", "c=0", 1e-5, 0.0654),
        ("HalfExplicitTrapezoidalOSI", "equality", 1e-3, 0.527),
        ("HalfExplicitTrapezoidalOSI", "equality", 1e-4, 0.0263),
        ("HalfExplicitTrapezoidalOSI", "equality", 1e-5, 0.000861),
    ],
)
def test_table_2(table2, scheme, variant, dt, error):
    assert table2[scheme, variant, dt].error == pytest.approx(error, rel=0.02)


@pytest.mark.parametrize(
    ("scheme", "dt", "error"),
    [
        ("HalfExplicitTrapezoidalOSI", 1e-3, 0.472),
        ("HalfExplicitTrapezoidalOSI", 1e-4, 0.01747),
        ("HalfExplicitTrapezoidalOSI", 1e-5, 0.003304),
        ("ExplicitMoreauJeanOSI", 1e-4, 0.153),
        ("ExplicitMoreauJeanOSI", 1e-5, 0.0454),
    ],
)
def test_table_3(table3, scheme, dt, error):
    assert table3[scheme, dt].error == pytest.approx(error, rel=0.02)


@pytest.mark.parametrize("variant", ["c=0", "equality"])
def test_order_2_on_bilateral_constraints(table2, variant):
    fine = table2["HalfExplicitTrapezoidalOSI", variant, 1e-5]
    assert fine.order == pytest.approx(2.0, abs=0.05)


def test_pointwise_order_2_below_1e_4():
    """At the end of the run, not in a norm over it."""
    exact = convergence.bilateral_reference(np.array([convergence.END]))[0]
    errors = []
    for dt in (1e-4, 5e-5, 2.5e-5, 1.25e-5):
        q = sk.TimeStepping(build("equality"), "HalfExplicitTrapezoidalOSI", dt).run(convergence.END).q[-1]
        errors.append(np.abs(q - exact).max())
    slopes = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (slopes > 1.9).all(), slopes


def test_references_agree_with_each_other():
    """Half-explicit with equalities converges to the minimal coordinates."""
    exact = convergence.bilateral_reference(np.array([0.05, convergence.END]))
    q = sk.TimeStepping(build("equality"), "HalfExplicitTrapezoidalOSI", 1e-6).run(convergence.END).q
    np.testing.assert_allclose(q[[50000, 100000]], exact, atol=1e-7)


@pytest.mark.parametrize("integrator", ["HalfExplicitTrapezoidalOSI", "ExplicitMoreauJeanOSI"])
@pytest.mark.parametrize("guidance", ["frictional", "frictionless", "c=0", "equality"])
def test_both_languages_give_the_same_trajectory(integrator, guidance):
    compiled = sk.TimeStepping(build(guidance), integrator, 1e-4).run(0.1)
    python = sk.TimeStepping(build(guidance, compiled=False), integrator, 1e-4).run(0.1)
    np.testing.assert_allclose(python.q, compiled.q, rtol=0, atol=1e-12)
    np.testing.assert_allclose(python.v, compiled.v, rtol=0, atol=1e-12 * 150)
    np.testing.assert_array_equal(python.impulsive, compiled.impulsive)


@pytest.mark.parametrize("compiled", [True, False])
@pytest.mark.parametrize("guidance", ["frictional", "equality"])
def test_check_finds_nothing(guidance, compiled):
    assert build(guidance, compiled=compiled).check().ok


def test_energy_and_symmetry():
    trajectory = sk.TimeStepping(build(), "HalfExplicitTrapezoidalOSI", 1e-5).run(0.1)
    assert trajectory.energy[0] == pytest.approx(7.49554875, abs=5e-9)
    assert np.abs(trajectory.q[:, 2]).max() < 1e-9
    change = np.diff(trajectory.kinetic_energy)
    work = (trajectory.work_forces + trajectory.work_lambda + trajectory.work_impulse)[1:]
    assert np.abs(change - work).max() < 1e-6
    assert (trajectory.work_impulse[trajectory.impulsive] < 0).all()


def test_paper_values_are_the_printed_ones():
    table2, table3 = convergence.paper_values("table2"), convergence.paper_values("table3")
    assert [table2["HalfExplicitTrapezoidalOSI"][dt] for dt in ("0.001", "0.0001", "0.00001")] == [
        0.42,
        0.024,
        8.4e-4,
    ]
    assert [table3["ExplicitMoreauJeanOSI"][dt] for dt in ("0.001", "0.0001", "0.00001")] == [
        0.71,
        0.15,
        0.045,
    ]
