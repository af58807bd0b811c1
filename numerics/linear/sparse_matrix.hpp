#pragma once
#include <Eigen/SparseCore>
#include <vector>

#include "saltus/numerics/pool.hpp"

namespace saltus {

/// Entries of a sparse matrix, row by row.
using SparseEntries = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// Largest |A - Aᵀ| of a square matrix.
double asymmetry(const SparseEntries& A);
/// Largest |A|, 0 if there are no entries.
double largest_entry(const SparseEntries& A);

/// A square sparse matrix that does not change, and products with it: by diagonals if it has few, as bars and
/// beams do (contiguous loops, several times as fast), else row by row.
class SparseMatrix {
 public:
  SparseMatrix() = default;
  /// @param entries  (n, n); zeros among them are dropped
  explicit SparseMatrix(SparseEntries entries);

  const SparseEntries& entries() const { return entries_; }
  bool by_diagonals() const { return !offsets_.empty(); }
  /// y <- y + factor A x, both (n), not the same
  void add_product(double factor, const double* x, double* y) const;
  /// xᵀ A x, x (n)
  double form(const double* x) const;

 private:
  void take_diagonals();
  void add_rows(int begin, int end, double factor, const double* x, double* y) const;

  SparseEntries entries_;
  std::vector<int> offsets_;    // of the diagonals, column minus row; none: products row by row
  std::vector<double> values_;  // of each diagonal n, that of row i at i
};

}  // namespace saltus
