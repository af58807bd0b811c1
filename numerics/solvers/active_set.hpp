#pragma once
#include <vector>

#include "saltus/numerics/contact_problem.hpp"
#include "saltus/numerics/linear/dense_solve.hpp"

namespace saltus {

/// What one contact does in a guess of the solution. Given the modes of all contacts, the laws of
/// plane contact are linear equations: this is what Newton's method and enumeration share.
enum class Mode : unsigned char {
  open,        ///< P = 0
  closed,      ///< xi = 0 in all rows: Equality, NonNegative, Coulomb sticking
  slip_plus,   ///< Coulomb: xi_N = 0, P_T = +mu P_N
  slip_minus,  ///< Coulomb: xi_N = 0, P_T = -mu P_N
};

/// Solves the linear equations that belong to a choice of modes.
class ActiveSet {
 public:
  /// Only plane friction: in space the direction of slip is an unknown of its own.
  static bool accepts(const ContactProblem& problem);

  void reserve(int rows);
  /// The modes, one a contact, to be chosen before solve().
  std::vector<Mode>& modes() { return modes_; }
  /// P that satisfies the equations of modes(); where contacts depend on each other, the nearest to the P
  /// that comes in, so that a P which is almost right stays so.
  /// @param[in,out] P (rows) [N s]
  void solve(const ContactProblem& problem, double* P);

 private:
  // Column u of the reduced system is column `row` of G plus `slip` times the tangential one.
  struct Unknown {
    int row;
    double slip;
  };

  std::vector<Mode> modes_;
  std::vector<Unknown> unknowns_;
  DenseSolve linear_;
};

}  // namespace saltus
