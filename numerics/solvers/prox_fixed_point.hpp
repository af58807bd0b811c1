#pragma once
#include <vector>

#include "saltus/numerics/contact_solver.hpp"

namespace saltus {

/// Fixed point of the prox equations (31)-(35), (69)-(72): in Gauss-Seidel sweeps over the contacts
///   P_N <- proj_{>=0}(P_N - r_N xi_N),  P_T <- proj_{C_T(mu P_N)}(P_T - r_T xi_T).
/// Steps: r_N = omega/|G_NN|, r_T = omega/|G_TT| with the largest sum of a row as norm, omega = 1 at the
/// start. Every 40 sweeps the residual is looked at: omega is halved where it has grown, and the sweeps go on
/// from the best P; where it has not, omega goes back towards 1 by a factor 1.2. It needs no factorisation
/// and no regular G, and converges linearly.
class ProxFixedPoint final : public ContactSolver {
 public:
  explicit ProxFixedPoint(int sweeps = 10000) : sweeps_(sweeps) {}
  std::string_view name() const override { return "prox-fixed-point"; }
  bool accepts(const ContactProblem&) const override { return true; }
  void reserve(int rows) override;
  SolveReport solve(const ContactProblem& problem, double* P) override;
  std::unique_ptr<ContactSolver> clone() const override { return std::make_unique<ProxFixedPoint>(sweeps_); }

 private:
  struct Scale {
    double normal, tangential;  // [1/kg]
  };

  void measure(const ContactProblem& problem);
  void sweep(const ContactProblem& problem, double omega, double* P) const;

  int sweeps_;
  std::vector<Scale> scales_;  // one a contact
  PoolVec xi_, best_;
};

}  // namespace saltus
