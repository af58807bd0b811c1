#pragma once
#include "saltus/numerics/solvers/enumeration.hpp"
#include "saltus/numerics/solvers/lemke.hpp"
#include "saltus/numerics/solvers/nsgs.hpp"
#include "saltus/numerics/solvers/semismooth_newton.hpp"

namespace saltus {

/// The default: Newton from the warm start; if that ends nowhere, Newton from P = 0, enumeration where
/// the problem is small enough, Lemke's method where friction is plane, and Newton in turn with Gauss-Seidel sweeps. The report names
/// the method that answered; a failure keeps the P with the smallest residual.
class Automatic final : public ContactSolver {
 public:
  std::string_view name() const override { return "auto"; }
  bool accepts(const ContactProblem&) const override { return true; }
  void reserve(int rows) override;
  SolveReport solve(const ContactProblem& problem, double* P) override;
  std::unique_ptr<ContactSolver> clone() const override { return std::make_unique<Automatic>(); }

 private:
  SolveReport solve_single(const ContactProblem& problem, double* P);

  SemismoothNewton newton_;
  Enumeration enumeration_;
  Lemke lemke_;
  Nsgs sweeps_{100};
  PoolVec trial_, sweeps_P_, xi_;
};

}  // namespace saltus
