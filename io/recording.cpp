#include "saltus/io/recording.hpp"

#include <stdexcept>
#include <string>

namespace saltus {
namespace {

void append(std::vector<double>& column, const Vec& values) {
  column.insert(column.end(), values.data(), values.data() + values.size());
}

}  // namespace

Recording::Recording(long every) : every_(every) {
  if (every < 1) throw std::invalid_argument("record_every must be at least 1, got " + std::to_string(every));
}

bool Recording::wants(long number, const StepReport& report) const {
  return number % every_ == 0 || report.impulsive;
}

void Recording::observe(const StepView& view) {
  t.push_back(view.state.t);
  append(q, view.state.q);
  append(v, view.state.v);
  append(gaps, view.gaps);
  append(velocities, view.velocities);
  append(lambda_plus, view.reactions.lambda_plus);
  append(lambda_minus, view.reactions.lambda_minus);
  append(impulse, view.reactions.impulse);
  residual.push_back(view.report.residual);
  penetration.push_back(view.report.penetration);
  kinetic_energy.push_back(view.report.kinetic_energy);
  potential_energy.push_back(view.potential_energy);
  work_forces.push_back(view.report.work_forces);
  work_lambda.push_back(view.report.work_lambda);
  work_impulse.push_back(view.report.work_impulse);
  step.push_back(view.step);
  closed.push_back(view.report.closed);
  impulsive.push_back(view.report.impulsive ? 1 : 0);
}

}  // namespace saltus
