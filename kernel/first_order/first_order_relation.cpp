#include "saltus/kernel/first_order/first_order_relation.hpp"

#include <stdexcept>
#include <string>

#include "saltus/kernel/first_order/requirements.hpp"

namespace saltus {
namespace {

OutMatrix zeroed(Matrix& A) {
  A.setZero();
  return {A.data(), A.rows(), A.cols()};
}

}  // namespace

FirstOrderRelation::FirstOrderRelation(int size) : size_(size) {
  if (size < 1)
    throw std::invalid_argument("size of a relation must be at least 1, got " + std::to_string(size));
}

void FirstOrderRelation::require_dimension(int) const {}
bool FirstOrderRelation::output_dx(double, const In&, const In&, OutMatrix) const { return false; }
bool FirstOrderRelation::output_dlambda(double, const In&, const In&, OutMatrix) const { return false; }
bool FirstOrderRelation::input_dx(double, const In&, const In&, OutMatrix) const { return false; }
bool FirstOrderRelation::input_dlambda(double, const In&, const In&, OutMatrix) const { return false; }

FirstOrderLinearR::FirstOrderLinearR(Matrix C, Matrix B, Terms terms)
    : FirstOrderRelation(static_cast<int>(C.rows())),
      C_(std::move(C)),
      B_(std::move(B)),
      D_(std::move(terms.D)),
      e_(std::move(terms.e)) {
  require_matrix(C_, C_.rows(), C_.cols(), "C");
  require_matrix(B_, C_.cols(), C_.rows(), "B");
  if (D_) require_matrix(*D_, size(), size(), "D");
  if (e_) require_vector(*e_, size(), "e");
  C_now_ = C_;
  B_now_ = B_;
  D_now_ = Matrix::Zero(size(), size());
}

void FirstOrderLinearR::C(double, OutMatrix C) const { C = C_; }
void FirstOrderLinearR::B(double, OutMatrix B) const { B = B_; }

void FirstOrderLinearR::D(double, OutMatrix D) const {
  if (D_) D = *D_;
}

void FirstOrderLinearR::e(double, Out e) const {
  if (e_) e = *e_;
}

void FirstOrderLinearR::require_dimension(int n) const {
  if (C_.cols() != n)
    throw std::invalid_argument("C must have " + std::to_string(n) +
                                " columns as the systems have states, got " + std::to_string(C_.cols()));
}

void FirstOrderLinearR::output(double t, const In& x, const In& lambda, Out y) const {
  e(t, y);
  if (time_invariant()) {
    y.noalias() += C_.lazyProduct(x);
    if (D_) y.noalias() += D_->lazyProduct(lambda);
    return;
  }
  C(t, zeroed(C_now_));
  D(t, zeroed(D_now_));
  y.noalias() += C_now_.lazyProduct(x);
  y.noalias() += D_now_.lazyProduct(lambda);
}

void FirstOrderLinearR::input(double t, const In&, const In& lambda, Out r) const {
  if (time_invariant()) {
    r.noalias() = B_.lazyProduct(lambda);
    return;
  }
  B(t, zeroed(B_now_));
  r.noalias() = B_now_.lazyProduct(lambda);
}

bool FirstOrderLinearR::output_dx(double t, const In&, const In&, OutMatrix C) const {
  this->C(t, C);
  return true;
}

bool FirstOrderLinearR::output_dlambda(double t, const In&, const In&, OutMatrix D) const {
  this->D(t, D);
  return true;
}

bool FirstOrderLinearR::input_dx(double, const In&, const In&, OutMatrix) const { return true; }

bool FirstOrderLinearR::input_dlambda(double t, const In&, const In&, OutMatrix B) const {
  this->B(t, B);
  return true;
}

}  // namespace saltus
