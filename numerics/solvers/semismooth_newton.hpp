#pragma once
#include "saltus/numerics/contact_solver.hpp"
#include "saltus/numerics/solvers/active_set.hpp"

namespace saltus {

/// Semismooth Newton method on the prox equations (31)-(35) with r = 1/d, d of certify().
/// An iteration reads each contact's mode off the arguments of the projections and solves the linear
/// equations of these modes; where contacts depend on each other, in the sense of Gauss-Newton with minimum
/// norm. In the plane the prox equations are piecewise linear: it gives up when the modes repeat and the
/// certificate does not hold. In space the projection on the disc is curved: Newton's iteration of Alart and
/// Curnier, quadratic near a solution.
class SemismoothNewton final : public ContactSolver {
 public:
  std::string_view name() const override { return "semismooth-newton"; }
  bool accepts(const ContactProblem&) const override { return true; }
  void reserve(int rows) override;
  SolveReport solve(const ContactProblem& problem, double* P) override;
  std::unique_ptr<ContactSolver> clone() const override { return std::make_unique<SemismoothNewton>(); }

 private:
  void read_modes(const ContactProblem& problem, const double* P);

  ActiveSet active_;
  std::vector<Mode> next_;
  PoolVec xi_;
};

}  // namespace saltus
