#pragma once
#include <functional>
#include <string>
#include <vector>

#include "saltus/io/recording.hpp"
#include "saltus/kernel/simulation/time_stepping.hpp"

namespace saltus {

/// Λ_N of one contact at the end of one step.
struct Impulse {
  double t;      ///< [s]
  double value;  ///< [N s]
};

/// What is kept of a run to compare it: states at some times, all impulses, and the worst of every step.
struct SampledRun {
  double time_step = 0.0;        ///< Δt [s]
  std::vector<double> t;         ///< (samples) [s]
  std::vector<double> q, v;      ///< (samples, n), v is v⁺
  std::vector<double> balance;   ///< (samples) T + V − Σ (work of λ and Λ) [J], V = 0 where it is not known
  std::vector<double> kinetic;   ///< (samples) T [J]
  bool balance_complete = true;  ///< no step is missing in Σ
  std::vector<std::vector<Impulse>> impulses;  ///< of each unilateral contact, in the order of the model
  long steps = 0;
  long impulsive_steps = 0;
  double closed = 0.0;       ///< mean number of closed contacts
  double penetration = 0.0;  ///< largest −g [m]
  double residual = 0.0;     ///< largest certificate [m/s]
  std::string ended;         ///< why the run ended before its time, empty if it did not
};

/// Takes the rows of a run and keeps what a comparison needs.
///
/// A sample that falls on a row, within 1e-6 Δt, is that row. Between two rows q is the cubic polynomial
/// through both states and v the straight line; if the later row is impulsive its velocity is not that before
/// the jump: then q is the straight line and v that of the earlier row.
class Sampler {
 public:
  /// @param model  of the run
  /// @param times  (samples) ascending [s]; null: every row is a sample
  Sampler(const NonSmoothDynamicalSystem& model, double time_step, const std::vector<double>* times);

  /// @param step     number of the row: if one is missing, the energy balance is not complete
  /// @param impulse  (rows of all contacts) Λ [N s]
  void add(long step, const State& state, const Vec& impulse, const StepReport& report);
  /// Are there samples left?
  bool wants_more() const { return !times_ || next_ < times_->size(); }
  SampledRun finish(std::string ended = "");

 private:
  struct Row {
    long step = -1;
    State state;
    double work = 0.0;  // Σ (work of λ and Λ)
    double kinetic = 0.0;
    bool impulsive = false;
  };

  void keep(double t, const Vec& q, const Vec& v, double balance, double kinetic);
  void keep_between(double t);
  double balance(const Row& row) const;

  Layout layout_;
  const std::vector<double>* times_;
  std::size_t next_ = 0;
  std::vector<int> normal_rows_;  // of the unilateral contacts
  Row before_, now_;
  double closed_sum_ = 0.0;
  SampledRun run_;
};

/// Called with the fraction of a run that is done; what it throws ends everything.
using RunProgress = std::function<void(double fraction)>;

/// Runs until the end, or until all samples are taken.
/// @param times  as in Sampler; null: every row until the end
SampledRun sample_run(const NonSmoothDynamicalSystem& model, const OneStepIntegrator& scheme,
                      double time_step, double until, const std::vector<double>* times,
                      const RunProgress& progress);

/// The same of a run that was recorded before.
/// @throws std::invalid_argument if the recording is not one of this model
SampledRun sample_recording(const NonSmoothDynamicalSystem& model, const Recording& recording,
                            double time_step, const std::vector<double>& times);

/// Seconds that a step takes: whole runs until the end, or until they fail, and as many as take 10 ms.
double seconds_per_step(const NonSmoothDynamicalSystem& model, const OneStepIntegrator& scheme,
                        double time_step, double until);

}  // namespace saltus
