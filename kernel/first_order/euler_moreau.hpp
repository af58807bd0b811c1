#pragma once
#include <Eigen/LU>
#include <memory>

#include "saltus/kernel/first_order/coupled_equations.hpp"
#include "saltus/kernel/integrators/one_step_integrator.hpp"

namespace saltus {

/// What a run of a first-order model carries from step to step.
struct FirstOrderState {
  double t = 0.0;  ///< [s]
  Vec x;           ///< (n)
  Vec y;           ///< (rows) h(t, x, λ)
  Vec lambda;      ///< (rows)
  Vec r;           ///< (n) g(t, x, λ)
};

/// What one step says about itself.
struct FirstOrderReport {
  StepStatus status = StepStatus::ok;
  int iterations = 0;         ///< of Newton's method, each with one complementarity problem
  int solver_iterations = 0;  ///< of all these
  /// Largest residual at the end, of the equations of motion and of the laws, each relative to the terms that
  /// cancel in it; recomputed from the model.
  double residual = 0.0;
};

/// The scheme of Euler and Moreau with the weights θ and γ:
///   M (x⁺ − x) = Δt (θ f(t⁺, x⁺) + (1−θ) f(t, x)) + Δt (γ r⁺ + (1−γ) r),
///   y⁺ = h(t⁺, x⁺, λ⁺),  r⁺ = g(t⁺, x⁺, λ⁺),  the law between y⁺ and λ⁺.
/// Where γ is that of the relation, r⁺ has the weight 1 and the law holds between λ⁺ and
///   h(t⁺, γ x⁺ + (1−γ) x, λ⁺).
/// A zero-order hold is the same with θ = 0, γ = 1 and another M: see CoupledEquations::hold().
/// Acary, Brogliato, Numerical Methods for Nonsmooth Dynamical Systems, Springer 2008, chapters 9 and 14.
class EulerMoreau {
 public:
  struct Weights {
    double theta = 1.0;
    double gamma = 1.0;
    bool gamma_for_relation = false;
    bool hold = false;
  };

  /// @throws std::invalid_argument if a weight is outside [0, 1], or a hold has others than θ = 0, γ = 1
  explicit EulerMoreau(Weights weights);
  const Weights& weights() const { return weights_; }

  /// Sizes every workspace: step() then allocates nothing. The solver must outlive it.
  /// @throws std::invalid_argument as BoxProblem::prepare() and CoupledEquations::hold()
  void prepare(const FirstOrderSystem& model, ContactSolver& solver, double time_step);
  /// y and r of an initial state.
  void complete(FirstOrderState& state);
  /// One step to t_end, by Newton's method on everything but the law. If the report's status is not ok, the
  /// state is as before. f at the start is that of the end of the step before, if there was one.
  FirstOrderReport step(double t_end, FirstOrderState& state);

 private:
  void start(const FirstOrderState& state);
  bool evaluate(double t_end, const Vec& x_start);
  bool linearise(double t_end);
  bool correct(FirstOrderReport& report);
  double residual() const;
  void accept(double t_end, FirstOrderState& state);

  Weights weights_;
  double weight_r_, weight_x_;  // of r⁺ in the motion, of x⁺ in the relation
  std::unique_ptr<CoupledEquations> equations_;
  BoxProblem law_;
  double tolerance_ = 0.0;
  double dt_ = 0.0;
  bool made_ = false;     // the matrices, if they are constant
  bool started_ = false;  // f_start_ is known

  CoupledEquations::Derivatives derivatives_;
  Matrix W_, input_, G_;  // M − Δt (θJ + γK); Ψ = W⁻¹ Δt γ B; D + C Ψ
  Eigen::PartialPivLU<Matrix> lu_;
  Vec f_start_, f_, constant_, residual_, correction_;
  Vec x_, x_law_, lambda_, change_, y_, r_, q_;
};

}  // namespace saltus
