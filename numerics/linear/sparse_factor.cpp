#include "saltus/numerics/linear/sparse_factor.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace saltus {
namespace {

// Sums of the same entries in another order differ by this at most, relative to the largest.
constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();
// A band may hold as many entries as this times those of the lower triangle: no factor has fewer than these,
// and contiguous loops over zeros take less time than indices.
constexpr double most_fill = 4.0;

std::span<const int> starts(const SparseEntries& A) {
  return {A.outerIndexPtr(), static_cast<std::size_t>(A.rows()) + 1};
}
std::span<const int> columns(const SparseEntries& A) {
  return {A.innerIndexPtr(), static_cast<std::size_t>(A.nonZeros())};
}
std::span<const double> values(const SparseEntries& A) {
  return {A.valuePtr(), static_cast<std::size_t>(A.nonZeros())};
}

}  // namespace

// Eigen's solve() allocates: its parts are taken one by one.
class SparseFactor::Cholesky {
 public:
  explicit Cholesky(const SparseEntries& A) : x_(A.rows()) { factor_.analyzePattern(Columns(A)); }
  bool factorise(const SparseEntries& A) {
    factor_.factorize(Columns(A));
    inverse_ = factor_.vectorD().cwiseInverse();
    return factor_.info() == Eigen::Success && factor_.vectorD().minCoeff() > 0.0 &&
           factor_.vectorD().allFinite() && inverse_.allFinite();
  }
  void solve(double* x) const {
    Out values(x, x_.size());
    x_.noalias() = factor_.permutationP() * values;
    factor_.matrixL().solveInPlace(x_);
    x_.array() *= inverse_.array();
    factor_.matrixU().solveInPlace(x_);
    values.noalias() = factor_.permutationPinv() * x_;
  }
  double smallest_pivot() const { return factor_.vectorD().minCoeff(); }

 private:
  using Columns = Eigen::SparseMatrix<double>;
  Eigen::SimplicialLDLT<Columns, Eigen::Lower> factor_;
  Vec inverse_;    // of D
  mutable Vec x_;  // in the order of the factor
};

SparseFactor::SparseFactor() = default;
SparseFactor::~SparseFactor() = default;
SparseFactor::SparseFactor(SparseFactor&&) noexcept = default;
SparseFactor& SparseFactor::operator=(SparseFactor&&) noexcept = default;

// For a positive definite matrix
void SparseFactor::choose(const SparseEntries& A) {
  const bool known = std::ranges::equal(starts(A), start_) && std::ranges::equal(columns(A), column_);
  if (known && method() != Method::none && method() != Method::lu) return;
  start_.assign(starts(A).begin(), starts(A).end());
  column_.assign(columns(A).begin(), columns(A).end());
  const double n = static_cast<double>(A.rows());
  const double lower = 0.5 * (n + static_cast<double>(A.nonZeros()));
  const int width = bandwidth(A);
  if (width == 1)
    factor_.emplace<TridiagonalFactor>();
  else if (n * (width + 1) <= most_fill * lower)
    factor_.emplace<BandFactor>();
  else
    factor_ = std::make_unique<Cholesky>(A);
}

bool SparseFactor::factorise_positive(const SparseEntries& A) {
  choose(A);
  if (auto* factor = std::get_if<TridiagonalFactor>(&factor_)) return factor->factorise(A);
  if (auto* factor = std::get_if<BandFactor>(&factor_)) return factor->factorise(A);
  return std::get<std::unique_ptr<Cholesky>>(factor_)->factorise(A);
}

bool SparseFactor::factorise(const SparseEntries& A) {
  for (const double value : values(A))
    if (!std::isfinite(value)) return false;
  if (asymmetry(A) <= rounding * largest_entry(A) && factorise_positive(A)) return true;
  if (method() != Method::lu) factor_ = std::make_unique<KluFactor>();
  return std::get<std::unique_ptr<KluFactor>>(factor_)->factorise(starts(A), columns(A), values(A));
}

void SparseFactor::solve(double* x) const {
  if (const auto* factor = std::get_if<TridiagonalFactor>(&factor_)) return factor->solve(x);
  if (const auto* factor = std::get_if<BandFactor>(&factor_)) return factor->solve(x);
  if (const auto* factor = std::get_if<std::unique_ptr<Cholesky>>(&factor_)) return (*factor)->solve(x);
  std::get<std::unique_ptr<KluFactor>>(factor_)->solve(x);
}

double SparseFactor::smallest_pivot() const {
  if (const auto* factor = std::get_if<TridiagonalFactor>(&factor_)) return factor->smallest_pivot();
  if (const auto* factor = std::get_if<BandFactor>(&factor_)) return factor->smallest_pivot();
  return std::get<std::unique_ptr<Cholesky>>(factor_)->smallest_pivot();
}

}  // namespace saltus
