"""Linear systems with matrices of scipy.sparse: the same motion as with arrays, whatever the format."""

import resource
from typing import Any

import numpy as np
import pytest
import saltus.kernel as sk
import scipy.sparse as sp

E, S, RHO, SPEED = 210e9, 1e-4, 7800.0, 0.1


def bar_matrices(elements: int) -> tuple[Any, Any]:
    """Consistent mass and stiffness of a bar of 1 m, in coordinates: an element's entries are summed up."""
    k = np.arange(elements)
    rows = np.concatenate([k, k, k + 1, k + 1])
    cols = np.concatenate([k, k + 1, k, k + 1])

    def assembled(diagonal: float, beside: float) -> Any:
        values = np.repeat([diagonal, beside, beside, diagonal], elements)
        return sp.coo_array((values, (rows, cols)), shape=(elements + 1, elements + 1))

    sixth = RHO * S / elements / 6
    return assembled(2 * sixth, sixth), assembled(E * S * elements, -E * S * elements)


def bar(mass: Any, stiffness: Any, damping: Any = None, gap: float = 2e-6) -> sk.NonSmoothDynamicalSystem:
    n = mass.shape[0]
    system = sk.LagrangianLinearTIDS(np.zeros(n), np.full(n, -SPEED), mass, stiffness, damping)
    model = sk.NonSmoothDynamicalSystem([system])
    relation = sk.LagrangianLinearTIR(np.eye(1, n), [gap])
    model.link(sk.Interaction(relation, sk.NewtonImpactNSL(0.0), name="wall"), system)
    return model


@pytest.mark.parametrize("form", ["csr", "csc", "coo", "lil", "dia", "dok", "bsr"])
@pytest.mark.parametrize("scheme", [sk.HalfExplicitTrapezoidalOSI(), sk.MoreauJeanOSI(theta=0.5)])
def test_every_format_moves_as_arrays_do(form: str, scheme: sk.OneStepIntegrator) -> None:
    mass, stiffness = bar_matrices(8)
    damping = 1e-7 * stiffness
    runs = [
        sk.TimeStepping(bar(*matrices), scheme, time_step=2e-6).run(until=4e-4)
        for matrices in (
            [A.toarray() for A in (mass, stiffness, damping)],
            [A.asformat(form) for A in (mass, stiffness, damping)],
            [sp.csr_matrix(A) for A in (mass, stiffness, damping)],
        )
    ]
    for run in runs[1:]:
        assert np.abs(run.q - runs[0].q).max() <= 1e-12 * np.abs(runs[0].q).max()
        assert np.abs(run.v - runs[0].v).max() <= 1e-12 * np.abs(runs[0].v).max()
    assert runs[0].impulsive.any()


def test_duplicates_are_summed_up_and_the_matrix_is_left_alone() -> None:
    # An oscillator of 2 kg and 8 N/m whose entries come in two parts, in a csr with unsorted duplicates.
    mass = sp.coo_array(([1.5, 0.5, 1.0], ([0, 0, 1], [0, 0, 1])), shape=(2, 2))
    stiffness = sp.csr_array(([3.0, 0.0, 5.0, 1.0], [0, 1, 0, 1], [0, 3, 4]), shape=(2, 2))
    system = sk.LagrangianLinearTIDS([1.0, 0.0], [0.0, 0.0], mass, stiffness)
    run = sk.TimeStepping(
        sk.NonSmoothDynamicalSystem([system]), sk.HalfExplicitTrapezoidalOSI(), time_step=1e-3
    ).run(until=np.pi / 4)
    assert abs(run.q[-1, 0] - np.cos(2 * run.t[-1])) < 1e-5
    assert mass.nnz == 3
    assert stiffness.nnz == 4


def test_integers_are_numbers() -> None:
    system = sk.LagrangianLinearTIDS(
        [1, 0], [0, 0], sp.eye_array(2, dtype=int), 4 * sp.eye_array(2, dtype=np.int32)
    )
    run = sk.TimeStepping(
        sk.NonSmoothDynamicalSystem([system]), sk.HalfExplicitTrapezoidalOSI(), time_step=1e-3
    ).run(until=1)
    assert abs(run.q[-1, 0] - np.cos(2.0)) < 1e-5


def indefinite() -> Any:
    return sp.csr_array([[1.0, 2.0], [2.0, 1.0]])


@pytest.mark.parametrize(
    ("terms", "message"),
    [
        ({"mass": sp.eye_array(3)}, r"mass must be \(2, 2\) as q0 has 2 entries, got \(3, 3\)"),
        ({"mass": sp.eye_array(2, 3)}, r"mass must be \(2, 2\).*got \(2, 3\)"),
        ({"mass": sp.csr_array([[1.0, 0.5], [0.0, 1.0]])}, "mass must be symmetric.*0.5"),
        ({"mass": indefinite()}, "mass must be positive definite.*-3"),
        ({"mass": sp.csr_array((2, 2))}, "mass must be positive definite.* 0"),
        ({"mass": sp.diags_array([1.0, np.nan])}, "mass must be finite"),
        ({"mass": sp.eye_array(2, dtype=complex)}, "mass must be an array of real numbers, got complex128"),
        ({"stiffness": sp.eye_array(3)}, r"stiffness must be \(2, 2\).*got \(3, 3\)"),
        ({"stiffness": sp.eye_array(2, dtype=complex)}, "stiffness must be .* real numbers, got complex128"),
        ({"damping": sp.diags_array([1.0, np.inf])}, "damping must be finite"),
        ({"damping": sp.eye_array(2), "stiffness": np.eye(3)}, r"stiffness must be \(2, 2\).*got \(3, 3\)"),
        ({"damping": sp.eye_array(2), "stiffness": [1, 2]}, "stiffness must have two axes"),
    ],
)
def test_bad_matrices_are_refused(terms: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        sk.LagrangianLinearTIDS([0, 0], [0, 0], **{"mass": sp.eye_array(2), **terms})


def test_a_large_bar_takes_little_memory_and_its_step_is_judged() -> None:
    elements = 20_000
    mass, stiffness = bar_matrices(elements)
    omega = np.sqrt(12 * E / RHO) * elements
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    model = bar(mass, stiffness, gap=1e-9)
    with pytest.warns(sk.StabilityWarning, match="too large"):
        sk.TimeStepping(model, sk.HalfExplicitTrapezoidalOSI(), time_step=2.5 / omega)
    dt = 1.0 / omega
    run = sk.TimeStepping(model, sk.MoreauJeanOSI(theta=0.5), time_step=dt, record_every=10).run(
        until=30 * dt
    )
    assert run.v[-1, 0] > -0.5 * SPEED
    assert run.v[-1, -1] == pytest.approx(-SPEED, rel=1e-12)
    assert model.check().ok
    assert (
        resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 300e3
    )  # [kB]; a dense matrix is 3.2e6
