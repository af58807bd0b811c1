#include "saltus/kernel/first_order/euler_moreau.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "saltus/numerics/text.hpp"

namespace saltus {
namespace {

constexpr int most_iterations = 50;

void require_weight(double value, const char* what) {
  if (!(value >= 0.0 && value <= 1.0))
    throw std::invalid_argument(std::string(what) + " must be in [0, 1], got " + number(value));
}

}  // namespace

EulerMoreau::EulerMoreau(Weights weights)
    : weights_(weights),
      weight_r_(weights.gamma_for_relation ? 1.0 : weights.gamma),
      weight_x_(weights.gamma_for_relation ? weights.gamma : 1.0) {
  require_weight(weights.theta, "theta");
  require_weight(weights.gamma, "gamma");
  if (weights.hold && (weights.theta != 0.0 || weights.gamma != 1.0 || weights.gamma_for_relation))
    throw std::invalid_argument("a zero-order hold has theta = 0 and gamma = 1, got " +
                                number(weights.theta) + " and " + number(weights.gamma));
}

void EulerMoreau::prepare(const FirstOrderSystem& model, ContactSolver& solver, double time_step) {
  equations_ = std::make_unique<CoupledEquations>(model);
  if (weights_.hold) equations_->hold(time_step);
  dt_ = time_step;
  law_.prepare(equations_->laws(), solver);
  tolerance_ = solver.tolerance();
  made_ = false;
  started_ = false;
  const int n = equations_->dimension(), rows = equations_->rows();
  derivatives_ = equations_->derivatives();
  W_ = Matrix::Identity(n, n);
  lu_.compute(W_);
  input_ = Matrix::Zero(n, rows);
  G_ = Matrix::Zero(rows, rows);
  for (Vec* vector : {&f_start_, &f_, &constant_, &residual_, &correction_, &x_, &x_law_, &r_})
    vector->setZero(n);
  for (Vec* vector : {&lambda_, &change_, &y_, &q_}) vector->setZero(rows);
}

void EulerMoreau::complete(FirstOrderState& state) {
  equations_->output(state.t, state.x, state.lambda, state.y);
  equations_->input(state.t, state.x, state.lambda, state.r);
}

// What the step starts from: terms of the motion that are known
void EulerMoreau::start(const FirstOrderState& state) {
  if (!started_) equations_->f(state.t, state.x, f_start_);
  started_ = true;
  constant_.noalias() = equations_->M().lazyProduct(state.x);
  constant_ += dt_ * (1.0 - weights_.theta) * f_start_ + dt_ * (1.0 - weight_r_) * state.r;
  x_ = state.x;
  lambda_ = state.lambda;
}

// What is left of the equation of motion at (x_, λ_), and y there. @return false if it is not finite
bool EulerMoreau::evaluate(double t_end, const Vec& x_start) {
  equations_->f(t_end, x_, f_);
  equations_->input(t_end, x_, lambda_, r_);
  x_law_ = weight_x_ * x_ + (1.0 - weight_x_) * x_start;
  equations_->output(t_end, x_law_, lambda_, y_);
  residual_.noalias() = equations_->M().lazyProduct(x_);
  residual_ -= dt_ * weights_.theta * f_ + dt_ * weight_r_ * r_ + constant_;
  return all_finite(residual_) && all_finite(y_);
}

// W, Ψ and G at (x_, λ_); constant ones only once. @return false if W is singular
bool EulerMoreau::linearise(double t_end) {
  if (equations_->time_invariant() && made_) return true;
  CoupledEquations::Derivatives& d = derivatives_;
  equations_->evaluate(t_end, x_, x_law_, lambda_, d);
  W_ = equations_->M() - dt_ * (weights_.theta * d.J + weight_r_ * d.K);
  lu_.compute(W_);
  if (equations_->rows() > 0) input_ = lu_.solve(d.B);
  input_ *= dt_ * weight_r_;
  G_.noalias() = weight_x_ * d.C.lazyProduct(input_);
  G_ += d.D;
  if (!W_.allFinite() || !input_.allFinite() || !G_.allFinite() ||
      lu_.matrixLU().diagonal().cwiseAbs().minCoeff() == 0.0)
    return false;
  law_.set_matrix(G_);
  made_ = true;
  return true;
}

// Newton's step: the motion and the relation linearised, the law as it is. @return false if the law's problem
// is not solved
bool EulerMoreau::correct(FirstOrderReport& report) {
  correction_.noalias() = lu_.solve(residual_);
  q_ = y_;
  q_.noalias() -= weight_x_ * derivatives_.C.lazyProduct(correction_);
  q_.noalias() -= G_.lazyProduct(lambda_);
  change_ = -lambda_;
  const SolveReport solved = law_.solve(q_, lambda_);
  report.solver_iterations += solved.iterations;
  ++report.iterations;
  change_ += lambda_;
  x_ -= correction_;
  x_.noalias() += input_.lazyProduct(change_);
  const Certificate& certificate = solved.certificate;
  report.residual = certificate.scale > 0.0 ? certificate.residual / certificate.scale : certificate.residual;
  return solved.status == SolveStatus::solved;
}

// Of the motion and the law, each relative to its terms; W stands for those that cancel in f.
double EulerMoreau::residual() const {
  const int n = equations_->dimension();
  double worst = 0.0;
  for (int i = 0; i < n; ++i) {
    double size = std::abs(constant_[i]) + std::abs(dt_ * weight_r_ * r_[i]);
    for (int j = 0; j < n; ++j) size += std::abs(W_(i, j) * x_[j]);
    if (residual_[i] != 0.0) worst = std::max(worst, std::abs(residual_[i]) / size);
  }
  return std::max(worst, law_.residual(q_, lambda_, y_));
}

void EulerMoreau::accept(double t_end, FirstOrderState& state) {
  if (weight_x_ != 1.0) equations_->output(t_end, x_, lambda_, y_);
  state.t = t_end;
  state.x.swap(x_);
  state.y.swap(y_);
  state.lambda.swap(lambda_);
  state.r.swap(r_);
  f_start_.swap(f_);
}

FirstOrderReport EulerMoreau::step(double t_end, FirstOrderState& state) {
  FirstOrderReport report;
  start(state);
  while (true) {
    if (!evaluate(t_end, state.x)) report.status = StepStatus::not_finite;
    if (report.status != StepStatus::ok) return report;
    if (report.iterations > 0) {
      report.residual = residual();
      if (report.residual <= tolerance_) break;
    }
    if (report.iterations == most_iterations || !linearise(t_end))
      report.status = StepStatus::iteration_failed;
    else if (!correct(report))
      report.status = StepStatus::solver_failed;
    if (report.status != StepStatus::ok) return report;
  }
  accept(t_end, state);
  return report;
}

}  // namespace saltus
