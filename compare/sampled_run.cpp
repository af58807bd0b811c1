#include "saltus/compare/sampled_run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace saltus {
namespace {

constexpr double same_time = 1e-6;        // of a step
constexpr double shortest_timing = 0.01;  // [s]
constexpr int steps_between_looks = 64;   // at the clock
constexpr double longest_silence = 0.1;   // of the progress [s]

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void append(std::vector<double>& column, const Vec& values) {
  column.insert(column.end(), values.data(), values.data() + values.size());
}

std::vector<int> normal_rows(const NonSmoothDynamicalSystem& model) {
  std::vector<int> rows;
  int row = 0;
  for (const auto& link : model.links()) {
    const NonSmoothLaw& law = link.interaction->law();
    if (!law.bilateral) rows.push_back(row);
    row += law.size();
  }
  return rows;
}

Vec row_of(const std::vector<double>& column, long row, long width) {
  return Eigen::Map<const Vec>(column.data() + row * width, width);
}

}  // namespace

Sampler::Sampler(const NonSmoothDynamicalSystem& model, double time_step, const std::vector<double>* times)
    : layout_(model), times_(times), normal_rows_(normal_rows(model)) {
  run_.time_step = time_step;
  run_.impulses.resize(normal_rows_.size());
}

void Sampler::add(long step, const State& state, const Vec& impulse, const StepReport& report) {
  std::swap(before_, now_);
  now_.step = step;
  now_.state = state;
  now_.work = before_.work + report.work_lambda + report.work_impulse;
  now_.kinetic = report.kinetic_energy;
  now_.impulsive = report.impulsive;
  if (step > 0) {
    ++run_.steps;
    run_.impulsive_steps += report.impulsive;
    closed_sum_ += report.closed;
    run_.balance_complete = run_.balance_complete && step == before_.step + 1;
  }
  run_.penetration = std::max(run_.penetration, report.penetration);
  run_.residual = std::max(run_.residual, report.residual);
  for (std::size_t k = 0; k < normal_rows_.size(); ++k)
    if (const double value = impulse[normal_rows_[k]]; value != 0.0)
      run_.impulses[k].push_back({state.t, value});

  const double slack = same_time * run_.time_step;
  if (!times_) return keep(state.t, state.q, state.v, balance(now_), now_.kinetic);
  for (; next_ < times_->size() && (*times_)[next_] <= state.t + slack; ++next_) {
    const double t = (*times_)[next_];
    if (t >= state.t - slack)
      keep(t, state.q, state.v, balance(now_), now_.kinetic);
    else if (before_.step >= 0)
      keep_between(t);
  }
}

void Sampler::keep(double t, const Vec& q, const Vec& v, double balance, double kinetic) {
  run_.t.push_back(t);
  append(run_.q, q);
  append(run_.v, v);
  run_.balance.push_back(balance);
  run_.kinetic.push_back(kinetic);
}

void Sampler::keep_between(double t) {
  const State &a = before_.state, &b = now_.state;
  const double dt = b.t - a.t, s = (t - a.t) / dt;
  Vec q = (1.0 - s) * a.q + s * b.q;
  Vec v = a.v;
  if (!now_.impulsive) {
    v = (1.0 - s) * a.v + s * b.v;
    // Hermite's polynomial: the straight line, and what bends it so that its slopes are q̇
    const Vec slope = (b.q - a.q) / dt;
    Vec start(q.size()), end(q.size());
    position_rates(layout_, a.q, a.v, start);
    position_rates(layout_, b.q, b.v, end);
    q += dt * s * (1.0 - s) * ((1.0 - s) * (start - slope) - s * (end - slope));
  }
  keep(t, q, v, (1.0 - s) * balance(before_) + s * balance(now_),
       (1.0 - s) * before_.kinetic + s * now_.kinetic);
}

double Sampler::balance(const Row& row) const {
  const double potential = potential_energy(layout_, row.state.t, row.state.q);
  return row.kinetic - row.work + (std::isfinite(potential) ? potential : 0.0);
}

SampledRun Sampler::finish(std::string ended) {
  run_.ended = std::move(ended);
  if (run_.steps > 0) run_.closed = closed_sum_ / static_cast<double>(run_.steps);
  return std::move(run_);
}

SampledRun sample_run(const NonSmoothDynamicalSystem& model, const OneStepIntegrator& scheme,
                      double time_step, double until, const std::vector<double>* times,
                      const RunProgress& progress) {
  TimeStepping simulation(model, scheme, time_step);
  Sampler sampler(model, time_step, times);
  sampler.add(0, simulation.state(), simulation.reactions().impulse, simulation.report());
  double shown = 0.0;
  try {
    while (times ? sampler.wants_more() : simulation.reaches(until)) {
      const StepReport& report = simulation.step();
      sampler.add(simulation.steps(), simulation.state(), simulation.reactions().impulse, report);
      if (!progress || simulation.steps() % steps_between_looks != 0) continue;
      if (const double now = seconds_now(); now - shown > longest_silence) {
        progress((simulation.state().t - model.t0()) / (until - model.t0()));
        shown = now;
      }
    }
  } catch (const SimulationError& error) {
    return sampler.finish(error.what());
  }
  return sampler.finish();
}

SampledRun sample_recording(const NonSmoothDynamicalSystem& model, const Recording& recording,
                            double time_step, const std::vector<double>& times) {
  const long rows = recording.rows(), n = model.dimension(), coordinates = model.coordinates();
  long width = 0;
  for (const auto& link : model.links()) width += link.interaction->law().size();
  const auto require = [](const char* what, long wanted, std::size_t got, long all) {
    if (all > 0 && static_cast<long>(got) == wanted * all) return;
    throw std::invalid_argument("the recorded reference must be a run of this model, with " +
                                std::to_string(wanted) + " " + what + ", got " +
                                (all > 0 ? std::to_string(static_cast<long>(got) / all) : "no rows"));
  };
  require("coordinates", coordinates, recording.q.size(), rows);
  require("freedoms", n, recording.v.size(), rows);
  require("rows of contacts", width, recording.impulse.size(), rows);
  Sampler sampler(model, time_step, &times);
  for (long k = 0; k < rows; ++k) {
    StepReport report;
    report.impulsive = recording.impulsive[k] != 0;
    report.closed = static_cast<int>(recording.closed[k]);
    report.residual = recording.residual[k];
    report.penetration = recording.penetration[k];
    report.kinetic_energy = recording.kinetic_energy[k];
    report.work_lambda = recording.work_lambda[k];
    report.work_impulse = recording.work_impulse[k];
    const State state{recording.t[k], row_of(recording.q, k, coordinates), row_of(recording.v, k, n)};
    sampler.add(recording.step[k], state, row_of(recording.impulse, k, width), report);
  }
  return sampler.finish();
}

double seconds_per_step(const NonSmoothDynamicalSystem& model, const OneStepIntegrator& scheme,
                        double time_step, double until) {
  double seconds = 0.0;
  long steps = 0;
  do {
    TimeStepping simulation(model, scheme, time_step);
    const double start = seconds_now();
    try {
      simulation.run(until);
    } catch (const SimulationError&) {  // its steps until then have a cost as well
    }
    seconds += seconds_now() - start;
    steps += simulation.steps();
    if (simulation.steps() == 0) break;
  } while (seconds < shortest_timing);
  return steps > 0 ? seconds / static_cast<double>(steps) : std::nan("");
}

}  // namespace saltus
