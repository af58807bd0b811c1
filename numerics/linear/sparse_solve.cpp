#include "saltus/numerics/linear/sparse_solve.hpp"

#include <algorithm>
#include <cmath>

namespace saltus {
namespace {

constexpr double nothing = 0.0;  // the solution of no equations: an empty vector may have no address

}  // namespace

const double* SparseSolve::solve() {
  if (A_.rows() == 0) return &nothing;
  factor_.factorise(A_.start, A_.column, A_.value);
  return solve_again();
}

const double* SparseSolve::solve_again() {
  if (y_.empty()) return &nothing;
  if (!factor_.solve(y_.data())) return nullptr;
  const bool finite = std::all_of(y_.begin(), y_.end(), [](double x) { return std::isfinite(x); });
  return finite ? y_.data() : nullptr;
}

}  // namespace saltus
