#pragma once
#include <optional>

#include "saltus/numerics/contact_problem.hpp"

namespace saltus {

/// Is a solution P the only one with its velocities ξ = G P + b? A table on four legs has one motion, but no
/// one distribution of its weight. That there are solutions with other velocities is not asked.
///
/// P + δ is another one where G δ = 0 and δ, small enough, leaves the laws satisfied. δ may go
/// - both ways in contacts that press, P_N > 0: all rows where they stick, (1, -μ ξ_T/|ξ_T|) where they slide
/// - one way in contacts that touch without force, ξ_N = P_N = 0: the same directions
/// - on the edge of the cone without sliding: both ways along (1, μ P_T/|P_T|), and one way inwards
///
/// If G times all of these directions has full rank, P is the only solution; if that of those that go both
/// ways has not, it is not; in between a nonnegative combination decides, a linear complementarity problem.
/// Ranks are those of a pivoted QR decomposition of G D, scaled by 1/√(d_i d_j), with pivots above 1e-10 of
/// the largest. Zero is what is below 1e-9 of the terms in G P + b, or a hundred times its
/// residual.
///
/// @param P (rows) [N s], a solution
/// @return nothing where that is not known: a contact in space decides that rests without a force or on the
///         edge of its cone, there are more than 500 directions, or rows times directions are beyond 5e5
std::optional<bool> is_only_solution(const ContactProblem& problem, const double* P);

}  // namespace saltus
