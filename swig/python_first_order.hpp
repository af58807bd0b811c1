#pragma once
// First-order models written in Python.
#include "python_models.hpp"
#include "saltus/kernel/first_order/first_order_ds.hpp"
#include "saltus/kernel/first_order/first_order_relation.hpp"

namespace saltus::python {

class PyFirstOrderDS final : public FirstOrderDS, public py::trampoline_self_life_support {
 public:
  using FirstOrderDS::FirstOrderDS;
  void f(double t, const In& x, Out f) const override;
  bool jacobian(double t, const In& x, OutMatrix J) const override;

 private:
  mutable CachedMethod f_{"f"}, jacobian_{"jacobian"};
};

class PyFirstOrderLinearDS final : public FirstOrderLinearDS, public py::trampoline_self_life_support {
 public:
  using FirstOrderLinearDS::FirstOrderLinearDS;
  void A(double t, OutMatrix A) const override;
  void b(double t, Out b) const override;
  bool time_invariant() const override { return !find(A_); }

 private:
  bool find(CachedMethod& method) const { return method.find<FirstOrderLinearDS>(this); }

  mutable CachedMethod A_{"A"}, b_{"b"};
};

class PyFirstOrderRelation final : public FirstOrderRelation, public py::trampoline_self_life_support {
 public:
  using FirstOrderRelation::FirstOrderRelation;
  void output(double t, const In& x, const In& lambda, Out y) const override;
  void input(double t, const In& x, const In& lambda, Out r) const override;
  bool output_dx(double t, const In& x, const In& lambda, OutMatrix C) const override;
  bool output_dlambda(double t, const In& x, const In& lambda, OutMatrix D) const override;
  bool input_dx(double t, const In& x, const In& lambda, OutMatrix K) const override;
  bool input_dlambda(double t, const In& x, const In& lambda, OutMatrix B) const override;

 private:
  bool find(CachedMethod& method) const { return method.find<FirstOrderRelation>(this); }
  bool fill(CachedMethod& method, double t, const In& x, const In& lambda, OutMatrix J) const;

  mutable CachedMethod output_{"output"}, input_{"input"}, output_dx_{"output_dx"},
      output_dlambda_{"output_dlambda"}, input_dx_{"input_dx"}, input_dlambda_{"input_dlambda"};
};

class PyFirstOrderLinearR final : public FirstOrderLinearR, public py::trampoline_self_life_support {
 public:
  using FirstOrderLinearR::FirstOrderLinearR;
  void C(double t, OutMatrix C) const override;
  void D(double t, OutMatrix D) const override;
  void e(double t, Out e) const override;
  void B(double t, OutMatrix B) const override;
  bool time_invariant() const override { return !find(C_) && !find(D_) && !find(B_); }

 private:
  bool find(CachedMethod& method) const { return method.find<FirstOrderLinearR>(this); }

  mutable CachedMethod C_{"C"}, D_{"D"}, e_{"e"}, B_{"B"};
};

}  // namespace saltus::python
