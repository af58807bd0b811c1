#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "saltus/compare/figures.hpp"
#include "saltus/kernel/integrators/registry.hpp"

namespace saltus {

/// An integrator, and what tables call it.
struct Candidate {
  std::string name;
  std::shared_ptr<const OneStepIntegrator> scheme;
};

/// @param name  in the registry, or "library:Class" of a plugin
/// @throws std::invalid_argument as make_integrator()
Candidate candidate(const std::string& name, const Options& options = {});

/// A run that is made for the purpose.
struct ReferenceRun {
  Candidate candidate;
  double time_step;  ///< [s]
};

/// A run that was recorded before.
struct RecordedReference {
  std::string name;
  double time_step;  ///< [s]
  std::shared_ptr<const Recording> recording;
};

/// Without a choice: HalfExplicitTrapezoidalOSI with a hundredth of the finest step.
using Reference = std::variant<std::monostate, ReferenceRun, RecordedReference>;

/// What a run must keep, where it is set. That it reaches its end is always asked for.
struct Limits {
  std::optional<double> max_error;          ///< of error_q and of error_v
  std::optional<double> max_energy_drift;   ///< of energy_drift
  std::optional<double> max_impulse_error;  ///< of impulse_error
  std::optional<double> max_penetration;    ///< [m]
  std::optional<double> max_slowdown;       ///< time of a step over that of the baseline
  std::optional<double> min_order;          ///< of the slope over all time steps
};

using CompareProgress = std::function<void(const std::string& label, double fraction)>;

struct CompareSettings {
  std::vector<Candidate> integrators;
  std::optional<Candidate>
      baseline;                    ///< runs as well, and keeps limits only if it is one of integrators, too
  std::vector<double> time_steps;  ///< [s]
  double until = 0.0;              ///< [s]
  Reference reference;
  Limits limits;
  int timings = 5;  ///< runs whose median is the time of a step; the integrators take turns. 0: no timing
  CompareProgress progress;
};

/// One integrator with one time step.
struct CompareRow {
  std::string integrator;
  bool baseline = false;
  double time_step = 0.0;  ///< [s]
  Figures figures;
  double order = 0.0;  ///< from `normalised` of this Δt and the coarser one before, NaN if there is none
  long steps = 0;
  long impulsive_steps = 0;
  double closed = 0.0;       ///< mean number of closed contacts
  double penetration = 0.0;  ///< [m]
  double residual = 0.0;     ///< [m/s]
  double us_per_step = 0.0;  ///< [µs], NaN without timing
  double slowdown = 0.0;     ///< NaN without timing or baseline
  std::string ended;         ///< why the run ended early, or empty
};

/// A limit that does not hold.
struct Breach {
  std::string integrator;
  double time_step;   ///< [s], 0 for an order
  std::string limit;  ///< "max-error", ..., "min-order"; "until" for a run that ended early
  double value;
  double allowed;  ///< NaN for "until"
  std::string message;
};

struct Comparison {
  std::vector<CompareRow> rows;  ///< by integrator, the baseline first, then from coarse to fine
  /// Least-squares slope of `normalised` over all time steps, by integrator; NaN if it cannot be told
  std::vector<std::pair<std::string, double>> orders;
  std::string reference;
  double reference_step = 0.0;                ///< [s]
  std::optional<Figures> reference_doubling;  ///< how far it moves if its step is doubled; none if recorded
  std::vector<std::string> warnings;
  std::vector<Breach> breaches;

  bool ok() const { return breaches.empty(); }
};

/// Runs every integrator with every time step, and compares with the reference at the times of the run's
/// steps.
/// @throws std::invalid_argument if settings make no sense, or an integrator cannot take the model
Comparison compare(const NonSmoothDynamicalSystem& model, const CompareSettings& settings);

/// Table, warnings and broken limits as plain text.
std::string to_text(const Comparison& comparison);

}  // namespace saltus
