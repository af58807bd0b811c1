#pragma once
#include "saltus/numerics/contact_solver.hpp"
#include "saltus/numerics/linear/sparse_solve.hpp"
#include "saltus/numerics/solvers/active_set.hpp"

namespace saltus {

/// For many contacts that depend on each other: the proximal point method. Each of its iterations solves
///   the law of every contact between P and ξ + (d/ρ) (P − P₀),  ξ = G P + b,
/// where P₀ is the P before: contacts with the compliance d/ρ, which no dependence makes singular, and whose
/// solution no longer moves exactly where P solves the problem itself. With y = P₀ − (ρ/d) ξ and P(y) its
/// projections (31)-(32), that is
///   F(y) = (d/ρ) (P₀ − y) − b − G P(y) = 0,
/// which Newton's method with a line search solves; its linear equations, of the contacts that stick or
/// slide, go to KLU. The larger ρ, the fewer iterations are left and the harder each becomes: ρ grows as long
/// as Newton's method succeeds quickly, and shrinks where it does not. At the end the last equations are
/// solved until P stands still: where contacts depend on each other weakly, a small residual does not make P
/// exact. Rockafellar, SIAM J. Control Optim. 14 (1976) 877-898.
class ProximalNewton final : public ContactSolver {
 public:
  /// @param iterations  of Newton's method, together
  explicit ProximalNewton(int iterations = 2000) : iterations_(iterations) {}
  std::string_view name() const override { return "proximal-newton"; }
  bool accepts(const ContactProblem&) const override { return true; }
  bool takes_sparse() const override { return true; }
  void reserve(int rows) override;
  SolveReport solve(const ContactProblem& problem, double* P) override;
  std::unique_ptr<ContactSolver> clone() const override {
    return std::make_unique<ProximalNewton>(iterations_);
  }

 private:
  struct Contact {
    int row;
    int rows;
    double d;         // of certify()
    Mode mode;        // by y
    Slip slip;        // of the mode slip_space
    int unknown = 0;  // its first among those of the linear equations
  };

  bool explore(const ContactProblem& problem, double before, SolveReport& report, double* P);
  void read_contacts(const ContactProblem& problem);
  bool solve_compliant(const ContactProblem& problem, double bound, int& iterations);
  double project(const ContactProblem& problem, const PoolVec& y, PoolVec& P);
  bool improve(const ContactProblem& problem, double& size);
  void read_modes(const ContactProblem& problem);
  bool find_direction(const ContactProblem& problem);
  void refine(const ContactProblem& problem, SolveReport& report, double* P);
  double right_hand_side(const ContactProblem& problem, const Contact& contact, int equation) const;
  void add_equation(const ContactProblem& problem, const Contact& contact, int equation);
  void add_entry(const ContactProblem& problem, int column, double entry);
  void add(int unknown, double value);
  void take_solution(const ContactProblem& problem, const double* unknowns);

  int iterations_;
  double hardness_ = 1.0;  // ρ
  std::vector<Contact> contacts_;
  std::vector<int> contact_of_;  // of each row
  SparseSolve linear_;
  std::vector<double> sums_;  // of the equation at hand, by unknowns
  std::vector<int> columns_;  // which of them it has
  std::vector<int> seen_in_;  // the last equation that had them
  PoolVec start_, P_, y_, trial_P_, trial_y_, full_P_, full_y_, xi_;
};

}  // namespace saltus
