#pragma once
#include <memory>
#include <span>
#include <vector>

namespace saltus {

/// LU factors of a sparse unsymmetric matrix by KLU. The structure is analysed again where it changes.
class KluFactor {
 public:
  /// @param diagonal  a pivot stays on the diagonal if it is no smaller than this part of its column
  explicit KluFactor(double diagonal = 1e-3);
  ~KluFactor();
  KluFactor(const KluFactor&) = delete;
  KluFactor& operator=(const KluFactor&) = delete;

  /// @param start, column, value  the matrix row by row, as in SparseRows
  /// @return false if it is singular; the factors must not be used then
  bool factorise(std::span<const int> start, std::span<const int> column, std::span<const double> value);
  /// Other values in the same structure, with the pivots of the last factorise(): a third of the work, where
  /// they still serve. @return as factorise()
  bool factorise_again(std::span<const double> value);
  /// x <- A⁻¹ x, x (n). @return false if there are no factors
  bool solve(double* x) const;
  /// Operations of all factorisations so far
  double work() const { return work_; }

 private:
  struct Klu;
  std::unique_ptr<Klu> klu_;
  std::vector<int> start_, column_;  // the structure that was analysed
  double work_ = 0.0;
};

}  // namespace saltus
