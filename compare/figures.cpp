#include "saltus/compare/figures.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "saltus/compare/impacts.hpp"
#include "saltus/numerics/text.hpp"

namespace saltus {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double same_time = 1e-6;                                    // of a step
constexpr double least_range = 1e-3;                                  // of a component, of the largest range
using Table = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic>;  // (n, common times)

struct Interval {
  double from, to;  // [s]
};

// Rows of both runs at the same times
struct Common {
  std::vector<long> run, reference;
};

Common common_rows(const SampledRun& run, const SampledRun& reference, double start) {
  Common rows;
  const double slack = same_time * std::min(run.time_step, reference.time_step);
  std::size_t j = 0;
  for (std::size_t i = 0; i < run.t.size(); ++i) {
    while (j < reference.t.size() && reference.t[j] < run.t[i] - slack) ++j;
    if (j == reference.t.size()) break;
    if (reference.t[j] > run.t[i] + slack || run.t[i] <= start + slack) continue;
    rows.run.push_back(static_cast<long>(i));
    rows.reference.push_back(static_cast<long>(j));
  }
  return rows;
}

Table columns(const std::vector<double>& values, const std::vector<long>& rows, int n) {
  Table table(n, static_cast<long>(rows.size()));
  for (std::size_t k = 0; k < rows.size(); ++k)
    table.col(static_cast<long>(k)) = Eigen::Map<const Vec>(values.data() + rows[k] * n, n);
  return table;
}

// Largest scaled difference; NaN if there is nothing to compare
double scaled_error(const Table& differences, const Table& reference) {
  if (reference.cols() == 0) return nan;
  Vec range = reference.rowwise().maxCoeff() - reference.rowwise().minCoeff();
  const double largest = range.maxCoeff();
  range = range.cwiseMax(largest > 0.0 ? least_range * largest : 1.0);
  return (differences.array().abs().colwise() / range.array()).maxCoeff();
}

// The square root of the largest eigenvalue of the smaller one of D Dᵀ and Dᵀ D
double spectral_norm(const Table& d) {
  const Table gram = d.rows() <= d.cols() ? Table(d * d.transpose()) : Table(d.transpose() * d);
  const Eigen::SelfAdjointEigenSolver<Table> solver(gram, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues().maxCoeff()));
}

double largest_impulse(const std::vector<std::vector<Impact>>& contacts) {
  double largest = 0.0;
  for (const auto& impacts : contacts)
    for (const Impact& impact : impacts) largest = std::max(largest, std::abs(impact.impulse));
  return largest;
}

// Fills in the figures of the impacts. @return where the velocities of either run jump
std::vector<Interval> compare_impacts(const SampledRun& run, const SampledRun& reference, double end,
                                      double start, Figures& figures) {
  const double step = std::max(run.time_step, reference.time_step);
  const double near = resolution_steps * step;
  const double window = std::max(window_steps * step, window_fraction * (end - start));
  const auto impacts_of = [&](const SampledRun& one) {
    std::vector<std::vector<Impact>> contacts;
    for (const auto& impulses : one.impulses) contacts.push_back(find_impacts(impulses, near));
    for (auto& impacts : contacts)
      std::erase_if(impacts, [&](const Impact& impact) { return impact.t > end + same_time * step; });
    return contacts;
  };
  const auto own = impacts_of(run), theirs = impacts_of(reference);
  double largest = largest_impulse(theirs);
  if (largest == 0.0) largest = largest_impulse(own);
  const auto counts = [&](const Impact& impact) {
    return std::abs(impact.impulse) >= small_impact * largest;
  };

  std::vector<Interval> jumps;
  for (std::size_t c = 0; c < own.size(); ++c) {
    const ImpactMatch match = match_impacts(own[c], theirs[c], window);
    for (const auto& [a, b] : match.pairs) {
      jumps.push_back({std::min(a.t, b.t) - near, std::max(a.t, b.t) + near});
      figures.impacts += counts(a);
      figures.reference_impacts += counts(b);
      if (!counts(a) && !counts(b)) continue;
      figures.impact_time_error = std::max(figures.impact_time_error, std::abs(a.t - b.t));
      figures.impulse_error = std::max(figures.impulse_error, std::abs(a.impulse - b.impulse) / largest);
    }
    for (const auto* alone : {&match.extra, &match.missing})
      for (const Impact& impact : *alone) {
        jumps.push_back({impact.t - near, impact.t + near});
        if (!counts(impact)) continue;
        ++(alone == &match.extra ? figures.impacts : figures.reference_impacts);
        if (impact.t > end - window) continue;  // its partner may be behind the end
        ++figures.unmatched;
        figures.impulse_error = std::max(figures.impulse_error, std::abs(impact.impulse) / largest);
      }
  }
  std::sort(jumps.begin(), jumps.end(), [](const Interval& a, const Interval& b) { return a.from < b.from; });
  return jumps;
}

// Those of the common rows that are in no interval
Common away_from(const std::vector<Interval>& jumps, const Common& rows, const SampledRun& run) {
  Common away;
  std::size_t next = 0;
  double until = -std::numeric_limits<double>::infinity();
  const double slack = same_time * run.time_step;
  for (std::size_t k = 0; k < rows.run.size(); ++k) {
    const double t = run.t[rows.run[k]];
    for (; next < jumps.size() && jumps[next].from <= t + slack; ++next)
      until = std::max(until, jumps[next].to);
    if (t <= until + slack) continue;
    away.run.push_back(rows.run[k]);
    away.reference.push_back(rows.reference[k]);
  }
  return away;
}

double energy_drift(const SampledRun& run, const SampledRun& reference, const Common& rows) {
  if (!run.balance_complete || !reference.balance_complete) return nan;
  double drift = 0.0, kinetic = 0.0;
  for (std::size_t k = 0; k < rows.run.size(); ++k) {
    const double own = run.balance[rows.run[k]] - run.balance.front();
    const double theirs = reference.balance[rows.reference[k]] - reference.balance.front();
    drift = std::max(drift, std::abs(own - theirs));
    kinetic = std::max(kinetic, reference.kinetic[rows.reference[k]]);
  }
  return drift / (kinetic > 0.0 ? kinetic : 1.0);
}

// Of a run that took no step
Figures untold() {
  Figures figures;
  for (double Figures::* figure :
       {&Figures::error_q, &Figures::error_v, &Figures::spectral, &Figures::normalised,
        &Figures::energy_drift, &Figures::impact_time_error, &Figures::impulse_error})
    figures.*figure = nan;
  return figures;
}

}  // namespace

Figures compare_runs(const SampledRun& run, const SampledRun& reference, double start) {
  const Common rows = common_rows(run, reference, start);
  if (rows.run.empty() && !run.ended.empty()) return untold();
  if (rows.run.empty())
    throw std::invalid_argument(
        "a run and its reference must have times in common, got a reference with Δt = " +
        number(reference.time_step) + " s for Δt = " + number(run.time_step) + " s" +
        (reference.ended.empty() ? "" : " whose " + reference.ended));
  Figures figures;
  figures.common_times = static_cast<long>(rows.run.size());
  figures.end = run.t[rows.run.back()];
  const auto coordinates = static_cast<int>(reference.q.size() / reference.t.size());
  const auto freedoms = static_cast<int>(reference.v.size() / reference.t.size());
  const Table q = columns(reference.q, rows.reference, coordinates);
  const Table difference = columns(run.q, rows.run, coordinates) - q;
  figures.error_q = scaled_error(difference, q);
  figures.spectral = spectral_norm(difference);
  figures.normalised = figures.spectral / std::sqrt(static_cast<double>(figures.common_times));
  figures.energy_drift = energy_drift(run, reference, rows);

  const auto jumps = compare_impacts(run, reference, figures.end, start, figures);
  const Common away = away_from(jumps, rows, run);
  const Table v = columns(reference.v, away.reference, freedoms);
  figures.error_v = scaled_error(columns(run.v, away.run, freedoms) - v, v);
  return figures;
}

}  // namespace saltus
