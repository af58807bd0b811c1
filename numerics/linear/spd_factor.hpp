#pragma once
#include "saltus/numerics/pool.hpp"

namespace saltus {

/// Factor of a symmetric positive definite matrix, M = L Lᵀ, or its diagonal if it has no other entries.
class SpdFactor {
 public:
  /// Sizes the storage for (n, n): factorise() then allocates nothing for small n.
  void reserve(int n);
  /// @param M  (n, n), only its lower triangle is read
  /// @return false if M is not positive definite or not finite; the factor must not be used then
  bool factorise(const InMatrix& M);
  /// Stores only the diagonal of a matrix that has no other entries; otherwise as factorise().
  bool factorise_constant(const InMatrix& M);
  /// x <- M⁻¹ x, x (n)
  void solve(double* x) const {
    if (diagonal_)
      for (int i = 0; i < n_; ++i) x[i] *= values_[i];
    else
      substitute(x);
  }

 private:
  void substitute(double* x) const;

  int n_ = 0;
  bool diagonal_ = false;
  std::vector<double> values_;  // L column by column with inverted diagonal, or the inverse of the diagonal
};

}  // namespace saltus
