#pragma once
#include "saltus/numerics/contact_solver.hpp"
#include "saltus/numerics/solvers/active_set.hpp"

namespace saltus {

/// Semismooth Newton method on the prox equations (31)-(35) with r = 1/d, d of certify().
/// In the plane these are piecewise linear: an iteration reads each contact's mode off the arguments
/// of the projections and solves the linear equations of these modes; where contacts depend on each
/// other, in the sense of Gauss-Newton with minimum norm. It ends when the certificate holds, and
/// gives up when the modes repeat without that.
class SemismoothNewton final : public ContactSolver {
 public:
  std::string_view name() const override { return "semismooth-newton"; }
  bool accepts(const ContactProblem& problem) const override { return ActiveSet::accepts(problem); }
  void reserve(int rows) override;
  SolveReport solve(const ContactProblem& problem, double* P) override;
  std::unique_ptr<ContactSolver> clone() const override { return std::make_unique<SemismoothNewton>(); }

 private:
  void read_modes(const ContactProblem& problem, const double* P, std::vector<Mode>& modes) const;

  ActiveSet active_;
  std::vector<Mode> next_;
  PoolVec xi_;
};

}  // namespace saltus
