#pragma once
#include <vector>

#include "saltus/numerics/solvers/semismooth_newton.hpp"

namespace saltus {

/// Newton's method on every subset of the unilateral contacts, the others open, until the certificate of
/// the whole problem holds. Where contacts depend on each other and G is unsymmetric, closed contacts
/// contradict each other slightly and some have to open: which ones, neither Newton's method nor sweeps find
/// out in reasonable time. Subsets with more contacts come first.
class SubsetNewton final : public ContactSolver {
 public:
  std::string_view name() const override { return "subset-newton"; }
  /// Up to 10 unilateral contacts.
  bool accepts(const ContactProblem& problem) const override;
  void reserve(int rows) override;
  SolveReport solve(const ContactProblem& problem, double* P) override;
  std::unique_ptr<ContactSolver> clone() const override { return std::make_unique<SubsetNewton>(); }

 private:
  void choose(const ContactProblem& problem, unsigned opened);
  void restrict_to_chosen(const ContactProblem& problem);

  SemismoothNewton newton_;
  ContactProblem part_;
  std::vector<int> rows_;  // of the chosen contacts
  PoolVec part_P_, trial_, xi_;
};

}  // namespace saltus
