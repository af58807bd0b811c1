#pragma once
#include <vector>

#include "saltus/numerics/contact_solver.hpp"
#include "saltus/numerics/linear/dense_solve.hpp"
#include "saltus/numerics/solvers/lemke_lcp.hpp"

namespace saltus {

/// Lemke's method on contact problems. Equalities are eliminated; where their block is singular and that
/// solves nothing, they are split instead,
///   z = (P⁺, P⁻),  w = (ξ, −ξ),  P = P⁺ − P⁻.
/// A plane Coulomb contact becomes the
/// linear complementarity problem
///   z = (P_N, σ⁺, ξ⁻),  w = (ξ_N, ξ⁺, σ⁻),  P_T = σ⁺ − μ P_N,  ξ_T = ξ⁺ − ξ⁻,  σ⁻ = 2 μ P_N − σ⁺,
/// which is exact.
class Lemke final : public ContactSolver {
 public:
  std::string_view name() const override { return "lemke"; }
  /// Plane friction.
  bool accepts(const ContactProblem& problem) const override;
  void reserve(int rows) override;
  SolveReport solve(const ContactProblem& problem, double* P) override;
  std::unique_ptr<ContactSolver> clone() const override { return std::make_unique<Lemke>(); }

 private:
  LcpOutcome attempt(const ContactProblem& problem, double least_pivot, double* P);
  void eliminate_equalities(const ContactProblem& problem);
  void choose_unknowns(const ContactProblem& problem);
  void fill(const ContactProblem& problem);
  void read(const ContactProblem& problem, double* P);

  LemkeLcp lcp_;
  bool split_ = false;            // the equalities, which are among the rest then
  bool dependent_ = false;        // the block of the equalities is singular
  std::vector<int> free_, rest_;  // rows of equalities, and all others
  Matrix elimination_;            // (free, rest): P_free = particular + elimination P_rest
  Vec particular_;
  Matrix G_;  // (rest, rest) after elimination
  Vec b_;
  Matrix T_;  // (rest, unknowns): P_rest = T z
  PoolVec z_, xi_, trial_;
};

}  // namespace saltus
