#include "saltus/io/recording.hpp"

#include <chrono>
#include <stdexcept>
#include <string>
#include <utility>

#include "saltus/numerics/text.hpp"

namespace saltus {
namespace {

void append(std::vector<double>& column, const Vec& values) {
  column.insert(column.end(), values.data(), values.data() + values.size());
}

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
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
  append(force, view.reactions.force);
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
  accepted_steps.push_back(view.report.accepted_steps);
  rejected_steps.push_back(view.report.rejected_steps);
  event_steps.push_back(view.report.event_steps);
  captures.push_back(view.report.captures);
  impulsive.push_back(view.report.impulsive ? 1 : 0);
  if (sink_ && (rows() >= chunk_rows_ || now() - last_ >= chunk_seconds_)) flush();
}

void Recording::stream(Sink sink, long rows, double seconds) {
  if (!sink) throw std::invalid_argument("stream needs a sink, got none");
  if (rows < 1)
    throw std::invalid_argument("rows of a chunk must be at least 1, got " + std::to_string(rows));
  if (!(seconds > 0.0))
    throw std::invalid_argument("seconds between chunks must be positive, got " + number(seconds));
  sink_ = std::move(sink);
  chunk_rows_ = rows;
  chunk_seconds_ = seconds;
  last_ = now();
}

void Recording::flush() {
  if (!sink_ || rows() == 0) return;
  sink_(*this);
  handed_on_ += rows();
  for (const Column& column : run_columns())
    std::visit([this](auto member) { (this->*member).clear(); }, column.values);
  last_ = now();
}

const std::vector<Column>& run_columns() {
  using Width = Column::Width;
  static const std::vector<Column> table = {
      {"t", "s", Width::one, &Recording::t},
      {"step", "1", Width::one, &Recording::step},
      {"q", "m or rad", Width::coordinates, &Recording::q},
      {"v", "m/s or rad/s", Width::freedoms, &Recording::v},
      {"gap", "m", Width::gaps, &Recording::gaps},
      {"velocity", "m/s", Width::rows, &Recording::velocities},
      {"lambda_plus", "N", Width::rows, &Recording::lambda_plus},
      {"lambda_minus", "N", Width::rows, &Recording::lambda_minus},
      {"force", "N", Width::rows, &Recording::force},
      {"impulse", "N s", Width::rows, &Recording::impulse},
      {"impulsive", "1", Width::one, &Recording::impulsive},
      {"closed", "1", Width::one, &Recording::closed},
      {"residual", "m/s", Width::one, &Recording::residual},
      {"penetration", "m", Width::one, &Recording::penetration},
      {"kinetic_energy", "J", Width::one, &Recording::kinetic_energy},
      {"potential_energy", "J", Width::one, &Recording::potential_energy},
      {"work_forces", "J", Width::one, &Recording::work_forces},
      {"work_lambda", "J", Width::one, &Recording::work_lambda},
      {"work_impulse", "J", Width::one, &Recording::work_impulse},
      {"accepted_steps", "1", Width::one, &Recording::accepted_steps},
      {"rejected_steps", "1", Width::one, &Recording::rejected_steps},
      {"event_steps", "1", Width::one, &Recording::event_steps},
      {"captures", "1", Width::one, &Recording::captures},
  };
  return table;
}

}  // namespace saltus
