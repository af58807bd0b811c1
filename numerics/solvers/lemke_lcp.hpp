#pragma once
#include <vector>

#include "saltus/numerics/pool.hpp"

namespace saltus {

enum class LcpOutcome {
  solved,           ///< a complementary basis was reached
  ray,              ///< the path ends in a ray: M gives no way on, often because there is no solution
  iteration_limit,  ///< neither within the pivots allowed
};

/// Lemke's method for w = M z + q, 0 <= w, 0 <= z, wᵀz = 0, with the covering vector of ones.
/// Ties of the ratio test are broken lexicographically, so that it does not cycle; the artificial
/// variable z0 leaves whenever it may. Rows and columns are scaled first, both by the same powers of two, so
/// that the entries of M and q are of order one: this keeps semidefinite matrices what they are. The inverse
/// of the basis is updated pivot by pivot and made anew from M at intervals; z comes from a factorisation of
/// the final basis, refined.
class LemkeLcp {
 public:
  void reserve(int n);
  /// Sizes the problem; then fill M() and q().
  void resize(int n);
  PoolMatrix& M() { return M_; }
  PoolVec& q() { return q_; }

  /// Scales M() and q() in place.
  /// @param[out] z (n)
  LcpOutcome solve(double* z, double pivot_tolerance = usual_pivot);
  /// Entries of an entering column below this fraction of its largest are rounding.
  static constexpr double usual_pivot = 1e-11;
  /// Pivots of the last solve().
  int pivots() const { return pivots_; }

 private:
  static constexpr int none = -1;

  int artificial() const { return 2 * n_; }
  int complement(int variable) const { return variable < n_ ? variable + n_ : variable - n_; }
  void scale();
  void start();
  void enter(int variable);
  bool artificial_vanished() const;
  int leaving_row() const;
  bool lexicographically_less(int a, int b) const;
  void pivot(int row, int entering);
  void refactorise();
  void read_solution(double* z);

  int n_ = 0;
  int pivots_ = 0;
  PoolMatrix M_, inverse_;  // inverse of the basis matrix
  PoolVec q_, x_, column_;  // values of the basic variables, entering column in the basis
  PoolVec scale_;           // of each z and w
  double least_pivot_ = usual_pivot;
  std::vector<int> basis_;  // variables: w 0..n-1, z n..2n-1, z0 2n
};

}  // namespace saltus
