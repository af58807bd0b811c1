#pragma once
#include <vector>

#include "saltus/numerics/pool.hpp"

namespace saltus {

/// Solves small dense systems A x = y, unsymmetric and possibly singular, without allocation
/// while the system is regular: LU with partial pivoting; where a pivot vanishes, the least-squares
/// solution nearest to a start (a Gauss-Newton step) by a complete orthogonal decomposition.
class DenseSolve {
 public:
  void reserve(int size);
  /// Sizes the system; then fill A() and y().
  void resize(int size);
  PoolMatrix& A() { return A_; }
  PoolVec& y() { return y_; }
  /// The start: of the solutions of a singular system the nearest to it is taken. Zero gives minimum norm.
  PoolVec& start() { return start_; }
  /// @return the solution (size), valid until the next call
  const double* solve();

 private:
  bool eliminate();

  PoolMatrix A_, lu_;
  PoolVec y_, x_, start_;
};

}  // namespace saltus
