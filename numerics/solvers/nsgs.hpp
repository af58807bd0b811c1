#pragma once
#include "saltus/numerics/contact_solver.hpp"

namespace saltus {

/// Nonsmooth Gauss-Seidel: sweeps over the contacts, each solved exactly while the others rest.
/// Slow but hard to derail: the start for Newton's method where its own path ends nowhere.
class Nsgs final : public ContactSolver {
 public:
  explicit Nsgs(int sweeps = 10000) : sweeps_(sweeps) {}
  std::string_view name() const override { return "nsgs"; }
  /// Plane friction.
  bool accepts(const ContactProblem& problem) const override;
  void reserve(int rows) override { xi_.reserve(rows); }
  SolveReport solve(const ContactProblem& problem, double* P) override;
  std::unique_ptr<ContactSolver> clone() const override { return std::make_unique<Nsgs>(sweeps_); }

 private:
  int sweeps_;
  PoolVec xi_;
};

/// The law of one contact alone: P with xi = G P + c.
/// @param G    (rows, rows) the contact's diagonal block, row i at G + i*stride
/// @param c    (rows) [m/s]
/// @param[out] P (rows) [N s]
/// @return false if no P satisfies the law; P is untouched then
bool solve_one_contact(const ContactSet& set, const double* G, int stride, const double* c, double* P);

}  // namespace saltus
