#include "saltus/numerics/linear/sparse_solve.hpp"

#include <klu.h>

#include <algorithm>
#include <cmath>

namespace saltus {
namespace {

constexpr double nothing = 0.0;  // the solution of no equations: an empty vector may have no address

}  // namespace

struct SparseSolve::Klu {
  klu_common common{};
  klu_symbolic* symbolic = nullptr;
  klu_numeric* numeric = nullptr;

  Klu() { klu_defaults(&common); }
  ~Klu() {
    klu_free_numeric(&numeric, &common);
    klu_free_symbolic(&symbolic, &common);
  }
  Klu(const Klu&) = delete;
  Klu& operator=(const Klu&) = delete;
};

SparseSolve::SparseSolve() : klu_(std::make_unique<Klu>()) {}
SparseSolve::~SparseSolve() = default;

// What is rows to us is columns to KLU: it factorises Aᵀ and solves the transposed system.
const double* SparseSolve::solve() {
  const int n = A_.rows();
  if (n == 0) return &nothing;
  klu_common* common = &klu_->common;
  if (A_.start != start_ || A_.column != column_) {
    klu_free_symbolic(&klu_->symbolic, common);
    start_ = A_.start;
    column_ = A_.column;
    klu_->symbolic = klu_analyze(n, start_.data(), column_.data(), common);
  }
  if (!klu_->symbolic) return nullptr;
  klu_free_numeric(&klu_->numeric, common);
  klu_->numeric = klu_factor(start_.data(), column_.data(), A_.value.data(), klu_->symbolic, common);
  if (klu_->numeric && klu_flops(klu_->symbolic, klu_->numeric, common)) work_ += common->flops;
  return solve_again();
}

const double* SparseSolve::solve_again() {
  const int n = static_cast<int>(y_.size());
  if (n == 0) return &nothing;
  klu_common* common = &klu_->common;
  if (!klu_->numeric || !klu_tsolve(klu_->symbolic, klu_->numeric, n, 1, y_.data(), common)) return nullptr;
  const bool finite = std::all_of(y_.begin(), y_.end(), [](double x) { return std::isfinite(x); });
  return finite ? y_.data() : nullptr;
}

}  // namespace saltus
