#pragma once
#include "saltus/numerics/contact_solver.hpp"
#include "saltus/numerics/linear/sparse_solve.hpp"

namespace saltus {

/// Semismooth Newton method with a line search, on equations Φ(P, ξ) = 0, ξ = G P + b, one a row, that are
/// equivalent to the laws. With forces as velocities, p = d P and d of certify(), they are
///   Map::fischer_burmeister   φ(p, ξ) = p + ξ - √(p² + ξ²)                NonNegative
///   Map::natural              φ(p, ξ) = min(p, ξ), which is (31)          NonNegative, normal rows of
///   Coulomb
///                             p_T - proj_{C_T(μ p_N)}(p_T - ξ_T), (32)    its tangential rows
/// and ξ for Equality. φ² is smooth, the square of the natural map is not: the first is the method for
/// complementarity, the second takes every set.
///
/// An iteration solves J s = -Φ, J = A G + B an element of the generalised Jacobian, by KLU, and goes along s
/// until ½|Φ|² has decreased as Armijo asks. Where J is singular or s no good, G in J is made regular step by
/// step, G + ν diag(d); where that does not help either, P goes down the gradient Jᵀ Φ. If that leads nowhere
/// it gives up: at a minimum of |Φ| that is no solution, or at a kink. De Luca, Facchinei, Kanzow, Math.
/// Program. 75 (1996) 407-439 and Comput. Optim. Appl. 16 (2000) 173-205; Alart, Curnier, Comput. Methods
/// Appl. Mech. Eng. 92 (1991) 353-375.
class GlobalisedNewton final : public ContactSolver {
 public:
  enum class Map { natural, fischer_burmeister };

  explicit GlobalisedNewton(Map map) : map_(map) {}
  /// "damped-newton" or "fischer-burmeister".
  std::string_view name() const override;
  /// Map::fischer_burmeister takes no friction.
  bool accepts(const ContactProblem& problem) const override;
  bool takes_sparse() const override { return true; }
  void reserve(int rows) override;
  SolveReport solve(const ContactProblem& problem, double* P) override;
  std::unique_ptr<ContactSolver> clone() const override { return std::make_unique<GlobalisedNewton>(map_); }

 private:
  void measure(const ContactProblem& problem);
  double merit(const ContactProblem& problem, const PoolVec& P);
  bool improve(const ContactProblem& problem);
  void fill_jacobian(const ContactProblem& problem, double regularisation);
  void add(int column, double value);
  void end_row();
  void find_gradient(const ContactProblem& problem);
  bool take_newtons_direction();
  void take_steepest_direction();
  bool search(const ContactProblem& problem, int most_halvings);

  Map map_;
  double size_ = 1.0;   // of the velocities [m/s]: Φ, merit and directions are over it
  double merit_ = 0.0;  // ½|Φ|² at P_
  PoolVec d_;           // of each row
  PoolVec P_, trial_, xi_, Phi_, direction_, gradient_;
  SparseSolve linear_;        // J
  std::vector<double> sums_;  // of the row at hand, by columns
  std::vector<int> columns_;  // which of them it has
  std::vector<int> seen_in_;  // the last row that had them
};

}  // namespace saltus
