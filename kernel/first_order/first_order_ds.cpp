#include "saltus/kernel/first_order/first_order_ds.hpp"

#include <stdexcept>

#include "saltus/kernel/first_order/requirements.hpp"

namespace saltus {

FirstOrderDS::FirstOrderDS(Vec x0, std::optional<Matrix> M) : x0_(std::move(x0)), M_(std::move(M)) {
  const auto n = x0_.size();
  if (n == 0) throw std::invalid_argument("x0 must have at least one entry, got none");
  require_vector(x0_, n, "x0");
  if (M_) require_matrix(*M_, n, n, "M");
}

bool FirstOrderDS::jacobian(double, const In&, OutMatrix) const { return false; }

FirstOrderLinearDS::FirstOrderLinearDS(Vec x0, Terms terms)
    : FirstOrderDS(std::move(x0), std::move(terms.M)), A_(std::move(terms.A)), b_(std::move(terms.b)) {
  const int n = dimension();
  if (A_) require_matrix(*A_, n, n, "A");
  if (b_) require_vector(*b_, n, "b");
  now_ = Matrix::Zero(n, n);
}

void FirstOrderLinearDS::A(double, OutMatrix A) const {
  if (A_) A = *A_;
}

void FirstOrderLinearDS::b(double, Out b) const {
  if (b_) b = *b_;
}

void FirstOrderLinearDS::f(double t, const In& x, Out f) const {
  b(t, f);
  if (!time_invariant()) {
    now_.setZero();
    A(t, {now_.data(), now_.rows(), now_.cols()});
    f.noalias() += now_.lazyProduct(x);
  } else if (A_) {
    f.noalias() += A_->lazyProduct(x);
  }
}

bool FirstOrderLinearDS::jacobian(double t, const In&, OutMatrix J) const {
  A(t, J);
  return true;
}

}  // namespace saltus
