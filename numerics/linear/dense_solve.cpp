#include "saltus/numerics/linear/dense_solve.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace saltus {
namespace {

// A pivot below this fraction of the largest entry of its column at the start counts as zero:
// far above rounding, far below the conditioning of any mechanism that a double can follow.
constexpr double singular = 1e-11;

// Up to this size the decomposition lives on the stack, beyond it on the heap.
constexpr int small = 24;

// A = Q T P with pivoting, then T = (R 0) Z: written out because Eigen's decomposition of that name
// allocates in its solution.
template <int Max>
void nearest(const PoolMatrix& A, const PoolVec& y, const PoolVec& start, PoolVec& x) {
  using M = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, Max, Max>;
  using V = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, Max, 1>;
  Eigen::ColPivHouseholderQR<M> qr;
  qr.setThreshold(singular);
  qr.compute(A.view());
  const auto rank = qr.rank();
  V c = y.view();
  c.noalias() -= A.view() * start.view();
  c.applyOnTheLeft(qr.householderQ().adjoint());
  M wide = qr.matrixR().topRows(rank).template triangularView<Eigen::Upper>();
  const Eigen::HouseholderQR<M> rows(wide.transpose());
  V z = V::Zero(y.size());
  z.head(rank) =
      rows.matrixQR().topRows(rank).template triangularView<Eigen::Upper>().transpose().solve(c.head(rank));
  z.applyOnTheLeft(rows.householderQ());
  V step = qr.colsPermutation() * z;
  x.view() = start.view() + step;
}

}  // namespace

void DenseSolve::reserve(int size) {
  A_.reserve(size, size);
  lu_.reserve(size, size);
  y_.reserve(size);
  x_.reserve(size);
  start_.reserve(size);
}

void DenseSolve::resize(int size) {
  A_.resize(size, size);
  y_.resize(size);
  start_.resize(size);
}

const double* DenseSolve::solve() {
  const int n = y_.size();
  x_.resize(n);
  if (!eliminate()) {
    if (n <= small)
      nearest<small>(A_, y_, start_, x_);
    else
      nearest<Eigen::Dynamic>(A_, y_, start_, x_);
  }
  return x_.data();
}

// Plain elimination: at the sizes of contact problems it is several times faster than a blocked one.
bool DenseSolve::eliminate() {
  const int n = y_.size();
  lu_.resize(n, n);
  std::copy_n(A_.row(0), static_cast<std::size_t>(n) * n, lu_.row(0));
  std::copy_n(y_.data(), n, x_.data());
  for (int k = 0; k < n; ++k) {
    double column = 0.0;
    for (int i = 0; i < n; ++i) column = std::max(column, std::abs(A_(i, k)));
    int pivot = k;
    for (int i = k + 1; i < n; ++i)
      if (std::abs(lu_(i, k)) > std::abs(lu_(pivot, k))) pivot = i;
    if (!(std::abs(lu_(pivot, k)) > singular * column)) return false;
    if (pivot != k) {
      std::swap_ranges(lu_.row(k), lu_.row(k) + n, lu_.row(pivot));
      std::swap(x_[k], x_[pivot]);
    }
    const double inverse = 1.0 / lu_(k, k);
    for (int i = k + 1; i < n; ++i) {
      const double factor = lu_(i, k) * inverse;
      if (factor == 0.0) continue;
      for (int j = k + 1; j < n; ++j) lu_(i, j) -= factor * lu_(k, j);
      x_[i] -= factor * x_[k];
    }
  }
  for (int i = n - 1; i >= 0; --i) {
    for (int j = i + 1; j < n; ++j) x_[i] -= lu_(i, j) * x_[j];
    x_[i] /= lu_(i, i);
  }
  return true;
}

}  // namespace saltus
