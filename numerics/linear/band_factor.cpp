#include "saltus/numerics/linear/band_factor.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace saltus {
namespace {

// Inverts the pivots. @return the smallest, NaN if one of them or its inverse is not finite
double invert(std::vector<double>& pivots) {
  double smallest = INFINITY, finite = 0.0;
  for (double& pivot : pivots) {
    smallest = std::min(smallest, pivot);
    finite += 0.0 * pivot;
    pivot = 1.0 / pivot;
    finite += 0.0 * pivot;
  }
  return smallest + finite;
}

}  // namespace

int bandwidth(const SparseEntries& A) {
  int width = 0;
  for (int i = 0; i < A.outerSize(); ++i)
    for (SparseEntries::InnerIterator entry(A, i); entry; ++entry)
      width = std::max(width, std::abs(i - static_cast<int>(entry.col())));
  return width;
}

bool TridiagonalFactor::factorise(const SparseEntries& A) {
  const int n = static_cast<int>(A.rows()), middle = n / 2;
  std::vector<double>& pivot = inverse_;
  pivot.assign(n, 0.0);
  ratio_.assign(n, 0.0);
  std::vector<double> below(n, 0.0);  // A(i, i - 1)
  for (int i = 0; i < n; ++i) {
    for (SparseEntries::InnerIterator entry(A, i); entry; ++entry) {
      if (entry.col() == i) pivot[i] = entry.value();
      if (entry.col() == i - 1) below[i] = entry.value();
    }
  }
  for (int i = 0; i < middle; ++i) {
    ratio_[i] = below[i + 1] / pivot[i];
    pivot[i + 1] -= ratio_[i] * below[i + 1];
  }
  for (int i = n - 1; i > middle; --i) {
    ratio_[i] = below[i] / pivot[i];
    pivot[i - 1] -= ratio_[i] * below[i];
  }
  smallest_pivot_ = invert(inverse_);
  return smallest_pivot_ > 0.0;
}

void TridiagonalFactor::solve(double* x) const {
  const int n = static_cast<int>(inverse_.size()), middle = n / 2;
  const int steps = n - 1 - middle;  // from the end to the middle; from the start it is the same or one more
  const double *ratio = ratio_.data(), *inverse = inverse_.data();
  double left = 0.0, right = 0.0;  // what the last row takes from the next one
  for (int i = 0, j = n - 1; i < steps; ++i, --j) {
    x[i] -= left;
    x[j] -= right;
    left = ratio[i] * x[i];
    right = ratio[j] * x[j];
  }
  if (steps < middle) {
    x[steps] -= left;
    left = ratio[steps] * x[steps];
  }
  double above = x[middle] = (x[middle] - left - right) * inverse[middle], below = above;
  if (steps < middle) above = x[steps] = x[steps] * inverse[steps] - ratio[steps] * above;
  for (int i = steps - 1, j = n - steps; i >= 0; --i, ++j) {
    above = x[i] = x[i] * inverse[i] - ratio[i] * above;
    below = x[j] = x[j] * inverse[j] - ratio[j] * below;
  }
}

bool BandFactor::factorise(const SparseEntries& A) {
  n_ = static_cast<int>(A.rows());
  width_ = bandwidth(A);
  lower_.assign(static_cast<std::size_t>(n_) * width_, 0.0);
  inverse_.assign(n_, 0.0);
  scaled_.assign(width_, 0.0);
  for (int i = 0; i < n_; ++i) {
    double* row = lower_.data() + static_cast<std::size_t>(i) * width_;
    for (SparseEntries::InnerIterator entry(A, i); entry && entry.col() <= i; ++entry)
      (entry.col() == i ? inverse_[i] : row[entry.col() - i + width_]) = entry.value();
    eliminate(i);
  }
  smallest_pivot_ = invert(inverse_);
  return smallest_pivot_ > 0.0;
}

// Row i of L and of D from that of A; inverse_ holds the pivots until all are known
void BandFactor::eliminate(int i) {
  const int first = std::max(0, i - width_);
  double* row = lower_.data() + static_cast<std::size_t>(i) * width_;
  for (int j = first; j < i; ++j) {
    const double* above = lower_.data() + static_cast<std::size_t>(j) * width_;
    double sum = row[j - i + width_];
    for (int k = std::max(first, j - width_); k < j; ++k)
      sum -= scaled_[k - i + width_] * above[k - j + width_];
    scaled_[j - i + width_] = sum;
  }
  for (int k = first - i + width_; k < width_; ++k) {
    row[k] = scaled_[k] / inverse_[i - width_ + k];
    inverse_[i] -= scaled_[k] * row[k];
  }
}

// L D y = x, then Lᵀ x = y
void BandFactor::solve(double* x) const {
  const double* row = lower_.data();
  for (int i = 0; i < n_; ++i, row += width_) {
    double value = x[i];
    for (int k = std::max(0, width_ - i); k < width_; ++k) value -= row[k] * x[i - width_ + k];
    x[i] = value;
  }
  for (int i = 0; i < n_; ++i) x[i] *= inverse_[i];
  if (width_ == 0) return;
  for (int i = n_ - 1; i > 0; --i) {
    row = lower_.data() + static_cast<std::size_t>(i) * width_;
    const double value = x[i];
    for (int k = std::max(0, width_ - i); k < width_; ++k) x[i - width_ + k] -= row[k] * value;
  }
}

}  // namespace saltus
