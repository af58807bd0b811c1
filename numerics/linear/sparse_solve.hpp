#pragma once
#include <vector>

#include "saltus/numerics/linear/klu_factor.hpp"
#include "saltus/numerics/sparse_rows.hpp"

namespace saltus {

/// Solves sparse unsymmetric systems A x = y by KLU. The structure is analysed again where it changes.
class SparseSolve {
 public:
  /// To be filled row by row.
  SparseRows& A() { return A_; }
  std::vector<double>& y() { return y_; }
  /// @return x, valid until the next call; nullptr if A is singular or not finite
  const double* solve();
  /// x of another y, with the A of the last solve(). @return as solve()
  const double* solve_again();
  /// Operations of all factorisations so far: what bounds an iteration where rows tell little.
  double work() const { return factor_.work(); }

 private:
  KluFactor factor_;
  SparseRows A_;
  std::vector<double> y_;
};

}  // namespace saltus
