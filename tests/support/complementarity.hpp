#pragma once
#include <random>

#include "saltus/numerics/contact_solver.hpp"

namespace saltus::test {

/// How far P is from satisfying the laws, in m/s, written out as signs, products and cones. Nothing of it
/// is taken from the library's certificate: no projections, no natural map.
double violation(const ContactProblem& problem, const std::vector<double>& P);

/// xi = G P + b, summed here.
std::vector<double> relative_velocities(const ContactProblem& problem, const std::vector<double>& P);

/// Largest |b_i| + sum_j |G_ij P_j|: what rounding in xi is relative to.
double terms(const ContactProblem& problem, const std::vector<double>& P);

struct ProblemKind {
  int dependent = 0;          ///< contacts repeated with the same W: G loses rank
  double moved = 0.0;         ///< W(q_c) - W(q_f), relative: G becomes unsymmetric
  double scale_spread = 0.0;  ///< freedoms' masses between 10^-spread and 10^spread
  double space = 0.0;         ///< share of the frictional contacts that are spatial
  double largest_mu = 1.0;
  bool friction = true;
  bool equalities = true;
};

/// Random contacts, 1..5, on 1..6 freedoms: G = W(q_c)ᵀ M⁻¹ W(q_f), b = W(q_c)ᵀ v, as mechanics makes them.
ContactProblem random_problem(std::mt19937& random, const ProblemKind& kind);

/// Turns the tangents of all spatial contacts: R (rows, rows) with R G Rᵀ, R b the same problem.
Matrix tangents_turned_by(double angle, const ContactProblem& problem);

/// The same problem with sparse rows, without the zeros of G.
ContactProblem with_sparse_rows(const ContactProblem& problem);

/// Problems side by side, their contacts taken in turn: one of the first, one of the second, and so on.
ContactProblem side_by_side(const std::vector<ContactProblem>& problems);

/// n unit masses on each other on the ground that fall together, with sparse rows: P_i = (n - i) weight.
ContactProblem column_of_balls(int n, double weight);

/// A problem from literal numbers.
ContactProblem problem_of(const Matrix& G, const Vec& b, std::vector<ContactSet> sets);

}  // namespace saltus::test
