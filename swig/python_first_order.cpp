#include "python_first_order.hpp"

namespace saltus::python {

void PyFirstOrderDS::f(double t, const In& x, Out f) const {
  if (!f_.find<FirstOrderDS>(this)) f_.missing("f(self, t, x, out)");
  f_.fill(&t, x, nullptr, f.data(), {f.size()});
}

bool PyFirstOrderDS::jacobian(double t, const In& x, OutMatrix J) const {
  if (!jacobian_.find<FirstOrderDS>(this)) return false;
  jacobian_.fill(&t, x, nullptr, J.data(), {J.rows(), J.cols()});
  return true;
}

void PyFirstOrderLinearDS::A(double t, OutMatrix A) const {
  if (!find(A_)) return FirstOrderLinearDS::A(t, A);
  A_.fill_at(t, A.data(), {A.rows(), A.cols()});
}

void PyFirstOrderLinearDS::b(double t, Out b) const {
  if (!find(b_)) return FirstOrderLinearDS::b(t, b);
  b_.fill_at(t, b.data(), {b.size()});
}

void PyFirstOrderRelation::output(double t, const In& x, const In& lambda, Out y) const {
  if (!find(output_)) output_.missing("output(self, t, x, lam, out)");
  output_.fill(&t, x, &lambda, y.data(), {y.size()});
}

void PyFirstOrderRelation::input(double t, const In& x, const In& lambda, Out r) const {
  if (!find(input_)) input_.missing("input(self, t, x, lam, out)");
  input_.fill(&t, x, &lambda, r.data(), {r.size()});
}

bool PyFirstOrderRelation::fill(CachedMethod& method, double t, const In& x, const In& lambda,
                                OutMatrix J) const {
  if (!find(method)) return false;
  method.fill(&t, x, &lambda, J.data(), {J.rows(), J.cols()});
  return true;
}

bool PyFirstOrderRelation::output_dx(double t, const In& x, const In& lambda, OutMatrix C) const {
  return fill(output_dx_, t, x, lambda, C);
}

bool PyFirstOrderRelation::output_dlambda(double t, const In& x, const In& lambda, OutMatrix D) const {
  return fill(output_dlambda_, t, x, lambda, D);
}

bool PyFirstOrderRelation::input_dx(double t, const In& x, const In& lambda, OutMatrix K) const {
  return fill(input_dx_, t, x, lambda, K);
}

bool PyFirstOrderRelation::input_dlambda(double t, const In& x, const In& lambda, OutMatrix B) const {
  return fill(input_dlambda_, t, x, lambda, B);
}

void PyFirstOrderLinearR::C(double t, OutMatrix C) const {
  if (!find(C_)) return FirstOrderLinearR::C(t, C);
  C_.fill_at(t, C.data(), {C.rows(), C.cols()});
}

void PyFirstOrderLinearR::D(double t, OutMatrix D) const {
  if (!find(D_)) return FirstOrderLinearR::D(t, D);
  D_.fill_at(t, D.data(), {D.rows(), D.cols()});
}

void PyFirstOrderLinearR::e(double t, Out e) const {
  if (!find(e_)) return FirstOrderLinearR::e(t, e);
  e_.fill_at(t, e.data(), {e.size()});
}

void PyFirstOrderLinearR::B(double t, OutMatrix B) const {
  if (!find(B_)) return FirstOrderLinearR::B(t, B);
  B_.fill_at(t, B.data(), {B.rows(), B.cols()});
}

}  // namespace saltus::python
