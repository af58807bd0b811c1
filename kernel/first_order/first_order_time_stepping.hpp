#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "saltus/kernel/first_order/euler_moreau.hpp"
#include "saltus/kernel/simulation/time_stepping.hpp"

namespace saltus {

/// Looks at the steps of a run of a first-order model; 0 is the initial state, with λ = 0.
class FirstOrderObserver {
 public:
  virtual ~FirstOrderObserver() = default;
  virtual void observe(long step, const FirstOrderState& state, const FirstOrderReport& report) = 0;
};

/// Simulation of a first-order model with fixed steps: t_k = t0 + k Δt.
class FirstOrderTimeStepping {
 public:
  /// @param model      copied: relations linked later are not seen
  /// @param time_step  Δt > 0 [s]
  /// @param solver     of the complementarity problems, and their tolerance, which ends Newton's method as
  /// well
  /// @throws std::invalid_argument if Δt is not positive and finite, the solver cannot take the model, or f,
  /// y
  ///         or r is not finite at t0
  FirstOrderTimeStepping(const FirstOrderSystem& model, EulerMoreau::Weights scheme, double time_step,
                         const ContactSolver& solver);

  /// Shows row 0 now, if no step was taken yet, and every row from now on.
  /// @throws std::invalid_argument if there is no observer
  void add_observer(std::shared_ptr<FirstOrderObserver> observer);
  /// Called every few hundred steps with the time; what it throws ends the run between two steps.
  void set_progress(std::function<void(double)> progress) { progress_ = std::move(progress); }
  /// Takes all steps with t_k <= until (1 + 1e-12), never a shortened one.
  /// @throws SimulationError if a step fails, std::invalid_argument if until is not finite
  void run(double until);
  /// Takes one step. @throws as run(); std::logic_error from within a step
  const FirstOrderReport& step();

  const FirstOrderSystem& model() const { return model_; }
  const EulerMoreau::Weights& scheme() const { return scheme_.weights(); }
  double time_step() const { return dt_; }
  long steps() const { return step_; }
  const FirstOrderState& state() const { return state_; }
  const FirstOrderReport& report() const { return report_; }

 private:
  void check_start() const;

  FirstOrderSystem model_;
  EulerMoreau scheme_;
  std::unique_ptr<ContactSolver> solver_;
  double dt_;
  long step_ = 0;
  bool busy_ = false;
  FirstOrderState state_;
  FirstOrderReport report_;
  std::vector<std::shared_ptr<FirstOrderObserver>> observers_;
  std::function<void(double)> progress_;
};

/// A run in memory, column by column; every column holds its rows one after the other.
class FirstOrderRecording final : public FirstOrderObserver {
 public:
  /// Keeps row 0 and every n-th row. @throws std::invalid_argument if every < 1
  explicit FirstOrderRecording(long every = 1);
  void observe(long step, const FirstOrderState& state, const FirstOrderReport& report) override;
  long rows() const { return static_cast<long>(t.size()); }

  std::vector<double> t;               ///< (rows) [s]
  std::vector<double> x, r;            ///< (rows, n)
  std::vector<double> y, lambda;       ///< (rows, entries)
  std::vector<double> residual;        ///< (rows)
  std::vector<long> step, iterations;  ///< (rows)

 private:
  long every_;
};

}  // namespace saltus
