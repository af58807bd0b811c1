#pragma once
#include "saltus/numerics/contact_solver.hpp"

namespace saltus {

/// Solves every contact exactly while the others rest, one after the other. @param[in,out] P (rows)
void sweep(const ContactProblem& problem, double* P);

/// Nonsmooth Gauss-Seidel: sweeps over the contacts, each solved exactly while the others rest.
/// Slow but hard to derail: the start for Newton's method where its own path ends nowhere.
class Nsgs final : public ContactSolver {
 public:
  explicit Nsgs(int sweeps = 10000) : sweeps_(sweeps) {}
  std::string_view name() const override { return "nsgs"; }
  bool accepts(const ContactProblem&) const override { return true; }
  bool takes_sparse() const override { return true; }
  void reserve(int rows) override { xi_.reserve(rows); }
  SolveReport solve(const ContactProblem& problem, double* P) override;
  std::unique_ptr<ContactSolver> clone() const override { return std::make_unique<Nsgs>(sweeps_); }

 private:
  int sweeps_;
  PoolVec xi_;
};

}  // namespace saltus
