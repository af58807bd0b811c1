#pragma once
#include <vector>

#include "saltus/numerics/linear/sparse_matrix.hpp"

namespace saltus {

/// Largest distance of an entry from the diagonal.
int bandwidth(const SparseEntries& A);

/// Factor of a symmetric positive definite tridiagonal matrix, eliminated from both ends to the middle: the
/// two recurrences do not wait for each other, which halves the time of a solution.
class TridiagonalFactor {
 public:
  /// @param A  (n, n), only its lower triangle is read
  /// @return false if A is not positive definite or not finite; the factor must not be used then
  bool factorise(const SparseEntries& A);
  /// x <- A⁻¹ x, x (n)
  void solve(double* x) const;
  /// Smallest entry of D [that of A]
  double smallest_pivot() const { return smallest_pivot_; }

 private:
  std::vector<double> inverse_;  // of D
  std::vector<double> ratio_;    // off-diagonal entry over pivot, of each row but the middle one
  double smallest_pivot_ = 0.0;
};

/// L D Lᵀ of a symmetric positive definite matrix with a narrow band, likewise.
class BandFactor {
 public:
  bool factorise(const SparseEntries& A);
  void solve(double* x) const;
  double smallest_pivot() const { return smallest_pivot_; }

 private:
  void eliminate(int row);

  int n_ = 0;
  int width_ = 0;
  std::vector<double> lower_;    // of row i of L the entries i - width...i - 1
  std::vector<double> inverse_;  // of D
  std::vector<double> scaled_;   // a row of L D
  double smallest_pivot_ = 0.0;
};

}  // namespace saltus
