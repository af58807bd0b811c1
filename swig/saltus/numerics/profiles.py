"""Performance profiles: solvers compared on a collection of problems."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf, isfinite


def performance_profile(times: Mapping[str, Sequence[float]]) -> dict[str, list[tuple[float, float]]]:
    """How often a solver is within a factor τ of the fastest one.

        ρ_s(τ) = |{p : t_ps / min_s t_ps <= τ}| / n_p

    A problem that a solver does not solve has the ratio infinity. It counts in n_p, also if none solves it:
    so ρ_s(τ) for large τ is the fraction that s solves, and ρ_s(1) the fraction on which it is the fastest.

    Parameters
    ----------
    times : solver → (n_p,) times, > 0, infinity where it does not solve the problem

    Returns
    -------
    dict
        Solver → the steps (τ, ρ_s(τ)) of its curve, both ascending; ρ_s is 0 before the first one. Without
        any if it solves nothing.

    Raises
    ------
    ValueError
        If the solvers have different numbers of times, or a time is not positive.

    References
    ----------
    E. D. Dolan, J. J. Moré: Benchmarking optimization software with performance profiles, Mathematical
    Programming 91 (2002) 201-213.
    """
    counts = {name: len(values) for name, values in times.items()}
    if len(set(counts.values())) > 1:
        raise ValueError(f"every solver must have a time for each problem, got {counts}")
    for name, values in times.items():
        if not all(value > 0 for value in values):
            raise ValueError(f"times must be positive, got {min(values)} of '{name}'")
    fastest = [min(column) for column in zip(*times.values(), strict=True)]
    return {
        name: _steps([t / best if isfinite(t) else inf for t, best in zip(values, fastest, strict=True)])
        for name, values in times.items()
    }


def _steps(ratios: Sequence[float]) -> list[tuple[float, float]]:
    solved = sorted(ratio for ratio in ratios if isfinite(ratio))
    last = {ratio: count for count, ratio in enumerate(solved, start=1)}  # of equal ones the last counts
    return [(ratio, count / len(ratios)) for ratio, count in last.items()]
