#include "saltus/compare/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <stdexcept>

#include "saltus/numerics/text.hpp"

namespace saltus {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double clearly_finer = 10.0;  // a reference: its step, and its error
constexpr double default_refinement = 100.0;
constexpr double rounding_level = 1e-12;  // of scaled errors: there is no order below

using Failure = std::invalid_argument;

void require_positive(double value, const std::string& what) {
  if (!(value > 0.0) || !std::isfinite(value))
    throw Failure(what + " must be positive and finite, got " + number(value));
}

void require_limits(const CompareSettings& settings, std::size_t steps) {
  const Limits& limits = settings.limits;
  const std::pair<const char*, const std::optional<double>*> all[] = {
      {"max-error", &limits.max_error},
      {"max-energy-drift", &limits.max_energy_drift},
      {"max-impulse-error", &limits.max_impulse_error},
      {"max-penetration", &limits.max_penetration},
      {"max-slowdown", &limits.max_slowdown},
      {"min-order", &limits.min_order}};
  for (const auto& [name, limit] : all)
    if (*limit) require_positive(**limit, name);
  if (limits.max_slowdown && (!settings.baseline || settings.timings < 1))
    throw Failure("max-slowdown needs a baseline and timings, got none");
  if (limits.min_order && steps < 2)
    throw Failure("min-order needs at least two time steps, got " + std::to_string(steps));
}

// From coarse to fine, each once
std::vector<double> ordered_steps(const NonSmoothDynamicalSystem& model, const CompareSettings& settings) {
  std::set<double, std::greater<>> steps;
  for (double step : settings.time_steps) {
    require_positive(step, "a time step");
    steps.insert(step);
  }
  if (steps.empty()) throw Failure("a comparison needs a time step, got none");
  if (!(model.t0() + *steps.begin() <= settings.until) || !std::isfinite(settings.until))
    throw Failure("until must be at least one step after t0 = " + number(model.t0()) +
                  " s, with Δt = " + number(*steps.begin()) + " s, got " + number(settings.until) + " s");
  return {steps.begin(), steps.end()};
}

std::vector<Candidate> all_candidates(const CompareSettings& settings) {
  std::vector<Candidate> all;
  if (settings.baseline) all.push_back(*settings.baseline);
  std::set<std::string> names;
  for (const Candidate& candidate : settings.integrators) {
    if (!names.insert(candidate.name).second)
      throw Failure("integrators to compare must differ, got '" + candidate.name + "' twice");
    all.push_back(candidate);
  }
  for (const Candidate& candidate : all)
    if (!candidate.scheme) throw Failure("an integrator to compare is missing: '" + candidate.name + "'");
  if (settings.integrators.empty()) throw Failure("a comparison needs an integrator, got none");
  return all;
}

class Comparer {
 public:
  Comparer(const NonSmoothDynamicalSystem& model, const CompareSettings& settings)
      : model_(model),
        settings_(settings),
        candidates_(all_candidates(settings)),
        steps_(ordered_steps(model, settings)) {
    require_limits(settings, steps_.size());
    for (const Candidate& candidate : candidates_)  // refusals of the model, before anything long
      TimeStepping(model, *candidate.scheme, steps_.front());
  }

  Comparison result() {
    run_all();
    take_reference();
    fill_rows();
    if (settings_.timings > 0) take_times();
    take_orders();
    warn();
    check_limits();
    return std::move(result_);
  }

 private:
  SampledRun sample(const std::string& label, const OneStepIntegrator& scheme, double dt,
                    const std::vector<double>* times) const {
    const std::string text = label + ", Δt = " + number(dt) + " s";
    const auto show = [&](double fraction) { settings_.progress(text, fraction); };
    if (settings_.progress) show(0.0);
    return sample_run(model_, scheme, dt, settings_.until, times,
                      settings_.progress ? RunProgress(show) : RunProgress());
  }

  void run_all() {
    for (const Candidate& candidate : candidates_)
      for (double dt : steps_) {
        const SampledRun& run = runs_.emplace_back(sample(candidate.name, *candidate.scheme, dt, nullptr));
        CompareRow& row = result_.rows.emplace_back();
        row.integrator = candidate.name;
        row.baseline = settings_.baseline && &candidate == &candidates_.front();
        row.time_step = dt;
        row.steps = run.steps;
        row.impulsive_steps = run.impulsive_steps;
        row.closed = run.closed;
        row.penetration = run.penetration;
        row.residual = run.residual;
        row.ended = run.ended;
        row.us_per_step = row.slowdown = nan;
      }
  }

  void take_reference() {
    std::vector<double> times;
    for (const SampledRun& run : runs_) times.insert(times.end(), run.t.begin(), run.t.end());
    std::sort(times.begin(), times.end());
    times.erase(std::unique(times.begin(), times.end()), times.end());

    if (const auto* recorded = std::get_if<RecordedReference>(&settings_.reference)) {
      require_positive(recorded->time_step, "the time step of the reference");
      result_.reference = recorded->name;
      result_.reference_step = recorded->time_step;
      reference_ = sample_recording(model_, *recorded->recording, recorded->time_step, times);
      return;
    }
    const ReferenceRun made =
        std::holds_alternative<ReferenceRun>(settings_.reference)
            ? std::get<ReferenceRun>(settings_.reference)
            : ReferenceRun{candidate("HalfExplicitTrapezoidalOSI"), steps_.back() / default_refinement};
    require_positive(made.time_step, "the time step of the reference");
    result_.reference = made.candidate.name;
    result_.reference_step = made.time_step;
    const OneStepIntegrator& scheme = *made.candidate.scheme;
    reference_ = sample("reference, " + made.candidate.name, scheme, made.time_step, &times);
    const SampledRun coarser = sample("reference, doubled step", scheme, 2.0 * made.time_step, &times);
    result_.reference_doubling = compare_runs(coarser, reference_, model_.t0());
  }

  void fill_rows() {
    for (std::size_t k = 0; k < runs_.size(); ++k)
      result_.rows[k].figures = compare_runs(runs_[k], reference_, model_.t0());
  }

  void take_times() {
    const std::size_t count = result_.rows.size();
    std::vector<std::vector<double>> times(count);
    for (int repeat = 0; repeat < settings_.timings; ++repeat)
      for (std::size_t k = 0; k < count; ++k) {
        const auto& scheme = *candidates_[k / steps_.size()].scheme;
        if (settings_.progress)
          settings_.progress("timing", static_cast<double>(repeat * count + k) / (settings_.timings * count));
        times[k].push_back(seconds_per_step(model_, scheme, steps_[k % steps_.size()], settings_.until));
      }
    for (std::size_t k = 0; k < count; ++k) {
      const auto middle = times[k].begin() + settings_.timings / 2;
      std::nth_element(times[k].begin(), middle, times[k].end());
      result_.rows[k].us_per_step = 1e6 * *middle;
      if (settings_.baseline)
        result_.rows[k].slowdown = result_.rows[k].us_per_step / result_.rows[k % steps_.size()].us_per_step;
    }
  }

  static bool tells_order(const CompareRow& row) {
    return row.ended.empty() && row.figures.error_q > rounding_level;
  }

  void take_orders() {
    for (std::size_t first = 0; first < result_.rows.size(); first += steps_.size()) {
      double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
      for (std::size_t k = first; k < first + steps_.size(); ++k) {
        CompareRow& row = result_.rows[k];
        const double log_dt = std::log(row.time_step), log_error = std::log(row.figures.normalised);
        row.order = nan;
        if (!tells_order(row)) continue;
        if (const CompareRow& before = result_.rows[k - (k > first)]; k > first && tells_order(before))
          row.order =
              (std::log(before.figures.normalised) - log_error) / (std::log(before.time_step) - log_dt);
        n += 1.0;
        x += log_dt;
        y += log_error;
        xx += log_dt * log_dt;
        xy += log_dt * log_error;
      }
      const double slope = n > 1.0 ? (n * xy - x * y) / (n * xx - x * x) : nan;
      result_.orders.emplace_back(result_.rows[first].integrator, slope);
    }
  }

  void warn() {
    std::vector<std::string>& warnings = result_.warnings;
    if (!reference_.ended.empty()) warnings.push_back("the reference ended early: its " + reference_.ended);
    const double finest = steps_.back();
    if (result_.reference_step * clearly_finer > finest * (1.0 + 1e-9))
      warnings.push_back("the reference is not clearly finer than the runs: its Δt = " +
                         number(result_.reference_step) + " s is not a tenth of " + number(finest) + " s");
    const auto& doubling = result_.reference_doubling;
    for (std::size_t k = 0; k < runs_.size(); ++k) {
      const CompareRow& row = result_.rows[k];
      const std::string who = row.integrator + " at Δt = " + number(row.time_step) + " s";
      if (row.baseline && !row.ended.empty())
        warnings.push_back("the baseline ended early: its " + row.ended);
      if (reference_.ended.empty() && row.figures.end < runs_[k].t.back() - 0.5 * row.time_step)
        warnings.push_back(who + " is compared until " + number(row.figures.end) +
                           " s: there the reference ends");
      if (doubling && row.figures.error_q > rounding_level &&
          !(doubling->error_q * clearly_finer <= row.figures.error_q))
        warnings.push_back("the reference is not clearly better than " + who +
                           ": with its step doubled it moves by " + number(doubling->error_q) +
                           ", the error is " + number(row.figures.error_q));
    }
    if (!reference_.balance_complete)
      warnings.push_back("the energy drift cannot be told: the recorded reference lacks steps");
  }

  void check(const CompareRow& row, const char* limit, double value, const std::optional<double>& allowed) {
    if (!allowed || value <= *allowed) return;
    breach(row, limit, value, *allowed,
           std::isnan(value) ? "cannot be told" : number(value) + " is more than " + number(*allowed));
  }

  void breach(const CompareRow& row, const char* limit, double value, double allowed,
              const std::string& what) {
    result_.breaches.push_back(
        {row.integrator, row.time_step, limit, value, allowed,
         row.integrator + ", Δt = " + number(row.time_step) + " s: " + limit + ", " + what});
  }

  void check_limits() {
    const Limits& limits = settings_.limits;
    for (const CompareRow& row : result_.rows) {
      if (row.baseline) continue;
      if (!row.ended.empty()) breach(row, "until", row.figures.end, nan, row.ended);
      const Figures& figures = row.figures;
      if (figures.common_times == 0) continue;
      check(row, "max-error", std::fmax(figures.error_q, figures.error_v), limits.max_error);
      check(row, "max-energy-drift", figures.energy_drift, limits.max_energy_drift);
      check(row, "max-impulse-error", figures.impulse_error, limits.max_impulse_error);
      check(row, "max-penetration", row.penetration, limits.max_penetration);
      check(row, "max-slowdown", row.slowdown, limits.max_slowdown);
    }
    if (!limits.min_order) return;
    for (std::size_t k = settings_.baseline ? 1 : 0; k < result_.orders.size(); ++k) {
      const auto& [name, order] = result_.orders[k];
      if (!(order < *limits.min_order)) continue;  // NaN: errors at the level of rounding
      result_.breaches.push_back(
          {name, 0.0, "min-order", order, *limits.min_order,
           name + ": min-order, " + number(order) + " is less than " + number(*limits.min_order)});
    }
  }

  const NonSmoothDynamicalSystem& model_;
  const CompareSettings& settings_;
  std::vector<Candidate> candidates_;
  std::vector<double> steps_;     // from coarse to fine
  std::vector<SampledRun> runs_;  // in the order of the rows
  SampledRun reference_;
  Comparison result_;
};

}  // namespace

Candidate candidate(const std::string& name, const Options& options) {
  return {name, std::shared_ptr<const OneStepIntegrator>(make_integrator(name, options))};
}

Comparison compare(const NonSmoothDynamicalSystem& model, const CompareSettings& settings) {
  return Comparer(model, settings).result();
}

}  // namespace saltus
