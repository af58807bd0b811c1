#pragma once
#include "saltus/numerics/solvers/components.hpp"
#include "saltus/numerics/solvers/enumeration.hpp"
#include "saltus/numerics/solvers/interior_point.hpp"
#include "saltus/numerics/solvers/lemke.hpp"
#include "saltus/numerics/solvers/nsgs.hpp"
#include "saltus/numerics/solvers/prox_fixed_point.hpp"
#include "saltus/numerics/solvers/proximal_newton.hpp"
#include "saltus/numerics/solvers/subset_newton.hpp"

namespace saltus {

/// The default: one contact in closed form, several by Newton's method from the warm start. If that ends
/// nowhere, in turn: Newton from P = 0, enumeration and Lemke's method where friction is plane, Newton on
/// subsets of the contacts, the interior-point method, the prox fixed point and Newton from its end,
/// Gauss-Seidel sweeps and Newton alternating. Problems with sparse rows or many are taken apart first: every
/// component with few rows goes that way, those with many to the proximal point method for two iterations,
/// then to the interior-point method, at last to the proximal point method for as long as it takes. The
/// report names the method that answered (the one of the largest component); a failure keeps the P with the
/// smallest residual, and is a ray if Lemke's method ended in one.
class Automatic final : public ContactSolver {
 public:
  std::string_view name() const override { return "auto"; }
  bool accepts(const ContactProblem&) const override { return true; }
  bool takes_sparse() const override { return true; }
  void reserve(int rows) override;
  SolveReport solve(const ContactProblem& problem, double* P) override;
  std::unique_ptr<ContactSolver> clone() const override { return std::make_unique<Automatic>(); }

 private:
  SolveReport solve_dense(const ContactProblem& problem, double* P);
  SolveReport solve_large(const ContactProblem& problem, double* P);
  SolveReport solve_components(const ContactProblem& problem, double* P);
  SolveReport solve_single(const ContactProblem& problem, double* P);

  SemismoothNewton newton_;
  Enumeration enumeration_;
  Lemke lemke_;
  SubsetNewton subsets_;
  ProxFixedPoint prox_{2000};
  Nsgs sweeps_{100};
  ProximalNewton rigid_{2};
  InteriorPoint interior_;
  ProximalNewton proximal_;
  Components components_;
  PoolVec trial_, sweeps_P_, xi_, part_P_;
};

}  // namespace saltus
