#pragma once
#include <memory>
#include <vector>

#include "saltus/numerics/sparse_rows.hpp"

namespace saltus {

/// Solves sparse unsymmetric systems A x = y by KLU. The structure is analysed again where it changes.
class SparseSolve {
 public:
  SparseSolve();
  ~SparseSolve();
  SparseSolve(const SparseSolve&) = delete;
  SparseSolve& operator=(const SparseSolve&) = delete;

  /// To be filled row by row.
  SparseRows& A() { return A_; }
  std::vector<double>& y() { return y_; }
  /// @return x, valid until the next call; nullptr if A is singular or not finite
  const double* solve();
  /// x of another y, with the A of the last solve(). @return as solve()
  const double* solve_again();
  /// Operations of all factorisations so far: what bounds an iteration where rows tell little.
  double work() const { return work_; }

 private:
  struct Klu;
  std::unique_ptr<Klu> klu_;
  SparseRows A_;
  std::vector<double> y_;
  std::vector<int> start_, column_;  // the structure that was analysed
  double work_ = 0.0;
};

}  // namespace saltus
