#pragma once
#include <memory>
#include <variant>
#include <vector>

#include "saltus/numerics/linear/band_factor.hpp"
#include "saltus/numerics/linear/klu_factor.hpp"

namespace saltus {

/// Factor of a sparse matrix, by the method that fits its structure. The structure of positive
/// definite ones is looked at again only where it changes; solve() allocates nothing.
class SparseFactor {
 public:
  enum class Method {
    none,
    tridiagonal,  ///< symmetric positive definite ones
    band,         ///< likewise, with a band that has few zeros
    cholesky,     ///< likewise, any other: Eigen's simplicial L D Lᵀ, ordered by minimum degree
    lu,           ///< KLU, of what is not symmetric, or not positive definite
  };

  SparseFactor();
  ~SparseFactor();
  SparseFactor(SparseFactor&&) noexcept;
  SparseFactor& operator=(SparseFactor&&) noexcept;

  /// @param A  (n, n), only its lower triangle is read
  /// @return false if A is not positive definite or not finite; the factor must not be used then
  bool factorise_positive(const SparseEntries& A);
  /// @param A  (n, n) of any kind
  /// @return false if A is singular or not finite; the factor must not be used then
  bool factorise(const SparseEntries& A);
  /// x <- A⁻¹ x, x (n)
  void solve(double* x) const;

  Method method() const { return static_cast<Method>(factor_.index()); }
  /// Smallest entry of D after factorise_positive()
  double smallest_pivot() const;

 private:
  class Cholesky;
  void choose(const SparseEntries& A);

  // in the order of Method
  std::variant<std::monostate, TridiagonalFactor, BandFactor, std::unique_ptr<Cholesky>,
               std::unique_ptr<KluFactor>>
      factor_;
  std::vector<int> start_, column_;  // the structure that was chosen for
};

}  // namespace saltus
