#include "saltus/kernel/integrators/impact_refinement.hpp"

#include <algorithm>
#include <stdexcept>

#include "saltus/kernel/assembly/layout.hpp"

namespace saltus {

ImpactRefinement::ImpactRefinement(std::unique_ptr<OneStepIntegrator> scheme, int parts)
    : scheme_(std::move(scheme)), parts_(parts) {
  if (parts_ < 2)
    throw std::invalid_argument("a step with an impact is taken again in at least 2 parts, got " +
                                std::to_string(parts_));
}

void ImpactRefinement::prepare(const NonSmoothDynamicalSystem& model, ContactSolver& solver) {
  scheme_->prepare(model, solver);
  const Layout layout(model);
  state_before_ = {model.t0(), model.q0(), model.v0()};
  state_before_.held.reserve(layout.contacts.size());
  for (Reactions* reactions : {&reactions_before_, &sums_}) reactions->set_zero(layout.rows);
}

StepReport ImpactRefinement::step(double dt, State& state, Reactions& reactions) {
  state_before_ = state;
  reactions_before_ = reactions;
  const StepReport whole = scheme_->step(dt, state, reactions);
  if (whole.status != StepStatus::ok || !whole.impulsive) return whole;
  state = state_before_;
  reactions = reactions_before_;
  const auto restore = [&] {
    state = state_before_;
    reactions = reactions_before_;
  };
  try {
    const StepReport report = parts(dt / parts_, state, reactions);
    if (report.status != StepStatus::ok) restore();
    return report;
  } catch (...) {  // a model that throws
    restore();
    throw;
  }
}

StepReport ImpactRefinement::parts(double dt, State& state, Reactions& reactions) {
  StepReport total;
  sums_.set_zero(static_cast<int>(reactions.impulse.size()));
  for (int part = 0; part < parts_; ++part) {
    StepReport report = scheme_->step(dt, state, reactions);
    report.impulsive = report.impulsive || total.impulsive;
    report.solver_iterations += total.solver_iterations;
    report.residual = std::max(report.residual, total.residual);
    report.work_forces += total.work_forces;
    report.work_lambda += total.work_lambda;
    report.work_impulse += total.work_impulse;
    total = report;
    if (total.status != StepStatus::ok) return total;
    if (part == 0) sums_.lambda_plus = reactions.lambda_plus;
    sums_.force += reactions.force;
    sums_.impulse += reactions.impulse;
  }
  reactions.lambda_plus = sums_.lambda_plus;
  reactions.force = sums_.force / parts_;
  reactions.impulse = sums_.impulse;
  return total;
}

}  // namespace saltus
