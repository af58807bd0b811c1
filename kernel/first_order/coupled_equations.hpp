#pragma once
#include <vector>

#include "saltus/kernel/first_order/first_order_system.hpp"

namespace saltus {

/// The functions of a whole model as one: f, y = h, r = g and their derivatives. What is not defined by the
/// model is found by differences.
class CoupledEquations {
 public:
  explicit CoupledEquations(const FirstOrderSystem& model);

  int dimension() const { return static_cast<int>(M_.rows()); }
  int rows() const { return static_cast<int>(laws_.lower.size()); }
  /// Puts Δt Γ⁻¹ in the place of M, with Γ = ∫ exp(M⁻¹A s) ds M⁻¹ over a step: as Γ A = exp(M⁻¹A Δt) − 1,
  ///   Δt Γ⁻¹ (x⁺ − x) = Δt (A x + b + r)
  /// is then exact for b and r that are constant over the step.
  /// @throws std::invalid_argument if ∂f/∂x of a system is not constant, or M or Γ is singular
  void hold(double time_step);
  /// (n, n) M of all systems
  const Matrix& M() const { return M_; }
  /// Of all relations.
  const BoxLaws& laws() const { return laws_; }
  /// Is every derivative constant?
  bool time_invariant() const { return time_invariant_; }

  /// All sizes fit: x, f, r (n), lambda, y (rows).
  void f(double t, const Vec& x, Vec& f);
  void output(double t, const Vec& x, const Vec& lambda, Vec& y);
  void input(double t, const Vec& x, const Vec& lambda, Vec& r);

  struct Derivatives {
    Matrix J;  ///< (n, n) ∂f/∂x
    Matrix C;  ///< (rows, n) ∂h/∂x
    Matrix D;  ///< (rows, rows) ∂h/∂λ
    Matrix K;  ///< (n, n) ∂g/∂x
    Matrix B;  ///< (n, rows) ∂g/∂λ
  };
  /// Sized by the model.
  Derivatives derivatives() const;
  /// @param x         where f and g are taken
  /// @param x_output  where h is taken
  void evaluate(double t, const Vec& x, const Vec& x_output, const Vec& lambda, Derivatives& all);

 private:
  struct Part {  // of x
    int offset, n;
  };
  struct Slot {
    const FirstOrderRelation* relation;
    int row, rows;
    Part parts[2];  // the second one is empty where there is one system
    int n() const { return parts[0].n + parts[1].n; }
  };

  void gather(const Slot& slot, const Vec& x);
  void system_jacobian(double t, int system, const Vec& x, Matrix& J);
  void output_jacobians(double t, const Slot& slot, Derivatives& all);
  void input_jacobians(double t, const Slot& slot, Derivatives& all);
  OutMatrix block(int height, int width);
  template <class Function>
  void by_differences(Function function, Vec& argument, int arguments, int height);

  FirstOrderSystem model_;
  std::vector<Part> systems_;
  std::vector<Slot> slots_;
  Matrix M_;
  BoxLaws laws_;
  bool time_invariant_ = true;
  // Of one system or relation: arguments, values, and a Jacobian.
  Vec x_, lambda_, value_, moved_;
  PoolMatrix block_;
};

}  // namespace saltus
