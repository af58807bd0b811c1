#pragma once
#include "saltus/numerics/contact_solver.hpp"
#include "saltus/numerics/solvers/active_set.hpp"

namespace saltus {

/// Tries every combination of modes (2 for NonNegative, 4 for plane Coulomb) until the certificate
/// holds: exact, and exponential. Combinations with more closed contacts come first, so that contacts
/// that depend on each other share their load.
class Enumeration final : public ContactSolver {
 public:
  std::string_view name() const override { return "enumeration"; }
  /// Up to 2^16 combinations of plane contacts.
  bool accepts(const ContactProblem& problem) const override;
  void reserve(int rows) override;
  SolveReport solve(const ContactProblem& problem, double* P) override;
  std::unique_ptr<ContactSolver> clone() const override { return std::make_unique<Enumeration>(); }

 private:
  ActiveSet active_;
  PoolVec xi_, trial_;
};

}  // namespace saltus
