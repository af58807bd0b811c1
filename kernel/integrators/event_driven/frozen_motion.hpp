#pragma once
#include <vector>

#include "saltus/kernel/integrators/contact_stage.hpp"
#include "saltus/kernel/integrators/event_driven/mode_equations.hpp"
#include "saltus/kernel/integrators/event_driven/runge_kutta.hpp"

namespace saltus {

/// The motion with frozen modes, an ordinary differential equation:
///   q̇ = Y(q) v,   M v̇ = h + W λ,   with γ̇ = 0 in the rows that the modes hold.
/// y is (q, v, ∫λ dt of all rows, work of h and of ½ vᵀṀv, work of λ).
class FrozenMotion final : public Ode {
 public:
  FrozenMotion(std::shared_ptr<const Layout> layout, ContactStage& contacts);

  int size() const { return layout_->coordinates + layout_->n + layout_->rows + 2; }
  int controlled() const { return layout_->coordinates + layout_->n; }
  /// All contacts, open ones as well. After a change of modes: choose().
  std::vector<ContactState>& contacts() { return states_; }
  const ContactState& contact(int k) const { return states_[k]; }
  /// Takes the closed ones of the contacts.
  void choose();
  const std::vector<int>& closed() const { return closed_; }

  bool rate(double t, const double* y, double* rate) override;
  bool project(double t, double* y) override;

  /// Everything at a state. @return false if it is not finite: status() says what
  bool evaluate(double t, const Vec& q, const Vec& v);
  /// As evaluate(), but without λ: a is M⁻¹h.
  bool evaluate_free(double t, const Vec& q, const Vec& v);
  /// γ̇ of the closed contacts at the acceleration, into gamma_dot()
  void accelerate_contacts(double t, const Vec& v);
  StepStatus status() const { return status_; }
  void clear_status() { status_ = StepStatus::ok; }
  /// Contacts slide from now on as they did at the last evaluate().
  void turn();

  Configuration& here() { return here_; }
  const Vec& acceleration() const { return a_; }
  const Vec& lambda() const { return lambda_; }
  const Vec& gamma_dot() const { return gamma_dot_; }
  ModeEquations& equations() { return equations_; }

  /// What is positive as long as a contact keeps its mode, two values of each, after evaluate() with v:
  ///   open: g, closed: λ_N; sliding: speed, negative beyond a stop, sticking: μ λ_N − |λ_T|.
  /// @param[out] values  (2 × contacts)
  void measure(const Vec& v, std::vector<double>& values);
  /// How far measure() is wrong by rounding, at the last evaluate(), in a motion over some time.
  /// @param span  [s] @param[out] noise as there
  void measure_noise(double t, const Vec& v, double span, std::vector<double>& noise);
  /// What counts as no gap. @param speed  of the terms of γ [m/s]
  double noise_of_gap(int contact, double t, double speed);
  /// Sum of the sizes of what makes γ of a contact: a velocity of zero is what is left of it. [m/s]
  double speed_of_terms(int contact, const Vec& v, double span);

 private:
  bool fail(StepStatus status);
  bool take_positions(double t, Vec& q);
  void add_curvature_by_differences(int contact, double t, const Vec& v);
  double inertia_power(double t, const Vec& v);
  template <class Sample>
  void differentiate(double t, Sample sample);
  double slide(int contact, const Vec& v);

  std::shared_ptr<const Layout> layout_;
  ContactStage& contacts_;
  Configuration here_, nearby_;
  ModeEquations equations_;
  std::vector<ContactState> states_;
  std::vector<int> closed_;
  Vec q_, v_, rate_, h_, a_, lambda_, gamma_dot_, change_, q_nearby_;
  std::vector<double> gamma_;  // of one contact
  StepStatus status_ = StepStatus::ok;
};

}  // namespace saltus
