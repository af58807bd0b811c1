#include "saltus/numerics/linear/klu_factor.hpp"

#include <klu.h>

#include <algorithm>

namespace saltus {

struct KluFactor::Klu {
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

KluFactor::KluFactor(double diagonal) : klu_(std::make_unique<Klu>()) { klu_->common.tol = diagonal; }
KluFactor::~KluFactor() = default;

// What is rows to us is columns to KLU: it factorises Aᵀ and solves the transposed system.
bool KluFactor::factorise(std::span<const int> start, std::span<const int> column,
                          std::span<const double> value) {
  klu_common* common = &klu_->common;
  if (!std::ranges::equal(start, start_) || !std::ranges::equal(column, column_)) {
    klu_free_symbolic(&klu_->symbolic, common);
    start_.assign(start.begin(), start.end());
    column_.assign(column.begin(), column.end());
    klu_->symbolic = klu_analyze(static_cast<int>(start_.size()) - 1, start_.data(), column_.data(), common);
  }
  klu_free_numeric(&klu_->numeric, common);
  if (!klu_->symbolic) return false;
  auto* values = const_cast<double*>(value.data());  // KLU only reads them
  klu_->numeric = klu_factor(start_.data(), column_.data(), values, klu_->symbolic, common);
  if (!klu_->numeric) return false;
  if (klu_flops(klu_->symbolic, klu_->numeric, common)) work_ += common->flops;
  return true;
}

bool KluFactor::factorise_again(std::span<const double> value) {
  if (!klu_->numeric) return false;
  klu_common* common = &klu_->common;
  auto* values = const_cast<double*>(value.data());
  if (!klu_refactor(start_.data(), column_.data(), values, klu_->symbolic, klu_->numeric, common) ||
      common->status != KLU_OK)
    return false;
  if (klu_flops(klu_->symbolic, klu_->numeric, common)) work_ += common->flops;
  return true;
}

bool KluFactor::solve(double* x) const {
  const int n = static_cast<int>(start_.size()) - 1;
  return klu_->numeric && klu_tsolve(klu_->symbolic, klu_->numeric, n, 1, x, &klu_->common);
}

}  // namespace saltus
