#include "saltus/kernel/first_order/first_order_time_stepping.hpp"

#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "saltus/numerics/text.hpp"

namespace saltus {
namespace {

constexpr long progress_interval = 512;  // steps between two calls

void append(std::vector<double>& column, const Vec& row) {
  column.insert(column.end(), row.data(), row.data() + row.size());
}

std::string reason(const FirstOrderReport& report) {
  switch (report.status) {
    case StepStatus::solver_failed: return "the solver found no λ that satisfies the laws";
    case StepStatus::iteration_failed: return "Newton's iteration does not converge";
    default: return "the state is not finite";
  }
}

SimulationError failure(double t, long step, const FirstOrderReport& report) {
  char text[160];
  std::snprintf(text, sizeof text, "step %ld from t = %.9g s failed: ", step, t);
  std::string message = text + reason(report);
  std::snprintf(text, sizeof text, " (relative residual %.3g after %d iterations)", report.residual,
                report.iterations);
  StepReport summary;
  summary.status = report.status;
  summary.solver_iterations = report.solver_iterations;
  summary.residual = report.residual;
  return {t, step, message + text, summary};
}

}  // namespace

FirstOrderTimeStepping::FirstOrderTimeStepping(const FirstOrderSystem& model, EulerMoreau::Weights scheme,
                                               double time_step, const ContactSolver& solver)
    : model_(model), scheme_(scheme), solver_(solver.clone()), dt_(require_time_step(time_step, model.t0())) {
  solver_->set_tolerance(solver.tolerance());
  const Vec none = Vec::Zero(model_.rows());
  state_ = {model_.t0(), model_.x0(), none, none, Vec::Zero(model_.dimension())};
  scheme_.prepare(model_, *solver_, dt_);
  scheme_.complete(state_);
  check_start();
}

void FirstOrderTimeStepping::check_start() const {
  int at = 0;
  for (std::size_t k = 0; k < model_.systems().size(); ++k) {
    const FirstOrderDS& system = *model_.systems()[k];
    Vec f = Vec::Zero(system.dimension());
    system.f(state_.t, In(state_.x.data() + at, f.size()), Out(f.data(), f.size()));
    if (!f.allFinite())
      throw std::invalid_argument("f of system " + std::to_string(k) +
                                  " at t0 must be finite, got NaN or infinity");
    at += system.dimension();
  }
  int row = 0;
  for (const FirstOrderSystem::Link& link : model_.links()) {
    if (!state_.y.segment(row, link.relation->size()).allFinite())
      throw std::invalid_argument("y of '" + link.name + "' at t0 must be finite, got NaN or infinity");
    row += link.relation->size();
  }
  if (!state_.r.allFinite())
    throw std::invalid_argument("r at t0 must be finite for λ = 0, got NaN or infinity");
}

void FirstOrderTimeStepping::add_observer(std::shared_ptr<FirstOrderObserver> observer) {
  if (!observer) throw std::invalid_argument("add_observer needs an observer, got none");
  if (step_ == 0) observer->observe(0, state_, report_);
  observers_.push_back(std::move(observer));
}

void FirstOrderTimeStepping::run(double until) {
  if (!std::isfinite(until)) throw std::invalid_argument("until must be finite, got " + number(until));
  while (reaches(until, model_.t0(), dt_, step_)) {
    step();
    if (progress_ && step_ % progress_interval == 0) progress_(state_.t);
  }
}

const FirstOrderReport& FirstOrderTimeStepping::step() {
  if (busy_) throw std::logic_error("step was called while a step of this simulation is taken");
  busy_ = true;
  struct Idle {
    bool& busy;
    ~Idle() { busy = false; }
  } idle{busy_};
  const FirstOrderReport report = scheme_.step(model_.t0() + (step_ + 1) * dt_, state_);
  if (report.status != StepStatus::ok) throw failure(state_.t, step_ + 1, report);
  report_ = report;
  ++step_;
  for (const auto& observer : observers_) observer->observe(step_, state_, report_);
  return report_;
}

FirstOrderRecording::FirstOrderRecording(long every) : every_(every) {
  if (every < 1) throw std::invalid_argument("record_every must be at least 1, got " + std::to_string(every));
}

void FirstOrderRecording::observe(long number, const FirstOrderState& state, const FirstOrderReport& report) {
  if (number % every_ != 0) return;
  t.push_back(state.t);
  step.push_back(number);
  append(x, state.x);
  append(r, state.r);
  append(y, state.y);
  append(lambda, state.lambda);
  iterations.push_back(report.iterations);
  residual.push_back(report.residual);
}

}  // namespace saltus
