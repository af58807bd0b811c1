#pragma once
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "saltus/kernel/assembly/configuration.hpp"
#include "saltus/kernel/simulation/observer.hpp"
#include "saltus/numerics/observed_solver.hpp"

namespace saltus {

/// A step that could not be taken. The run up to it is kept, in the simulation and its observers.
class SimulationError : public std::runtime_error {
 public:
  /// @param about  the contact that the status is about, or empty
  SimulationError(double time, long step, const std::string& about, std::vector<std::string> contacts,
                  const StepReport& report);
  /// @param message  the whole of it
  SimulationError(double time, long step, const std::string& message, const StepReport& report);
  double time() const { return time_; }  ///< start of the step that failed [s]
  long step() const { return step_; }    ///< its number
  const std::vector<std::string>& contacts() const { return contacts_; }  ///< closed at its start
  const StepReport& report() const { return report_; }

 private:
  double time_;
  long step_;
  std::vector<std::string> contacts_;
  StepReport report_;
};

/// All that a run needs to go on with the same bits.
struct Checkpoint {
  long step = 0;
  State state;
  Reactions reactions;
  StepReport report;
  std::vector<double> memory;  ///< of the integrator
};

/// @throws std::invalid_argument unless Δt is positive, finite and changes t0
double require_time_step(double time_step, double t0);
/// Is the step after `steps` others one with t_k <= until (1 + 1e-12)? The tolerance is at most Δt/1000.
bool reaches(double until, double t0, double time_step, long steps);

/// Event-capturing simulation with fixed steps: t_k = t0 + k Δt.
class TimeStepping {
 public:
  /// @param model      copied: interactions linked later are not seen
  /// @param time_step  Δt > 0 [s]
  /// @throws std::invalid_argument if Δt is not positive and finite, the integrator or the solver cannot
  ///         take the model, or the model is not finite at t0
  TimeStepping(const NonSmoothDynamicalSystem& model, const OneStepIntegrator& integrator, double time_step,
               const ContactSolver& solver);
  /// With the solver "auto".
  TimeStepping(const NonSmoothDynamicalSystem& model, const OneStepIntegrator& integrator, double time_step);

  /// Shows row 0 now, if no step was taken yet, and every row from now on.
  /// @throws std::invalid_argument if there is no observer, std::logic_error from within a step
  void add_observer(std::shared_ptr<Observer> observer);
  /// Shows every contact problem that a step solves, from now on; an empty function ends it.
  void watch_problems(ObservedSolver::Watcher watcher) { solver_.watch(std::move(watcher)); }
  /// Called every 0.1 s or less with the time; what it throws ends the run between two steps.
  void set_progress(std::function<void(double)> progress) { progress_ = std::move(progress); }

  /// Takes all steps with t_k <= until (1 + 1e-12), never a shortened one.
  /// The tolerance is at most Δt/1000.
  /// @throws SimulationError if a step fails, std::invalid_argument if until is not finite, std::logic_error
  ///         from within a step
  void run(double until);
  /// Takes one step. @throws as run()
  const StepReport& step();
  /// Would run(until) take a further step?
  bool reaches(double until) const;

  Checkpoint checkpoint() const;
  /// Goes on from there, with the same model, integrator, solver and Δt. Observers are not shown the row.
  /// @throws std::invalid_argument if sizes are not those of the model, or a value is not finite,
  ///         std::logic_error from within a step
  void restore(const Checkpoint& checkpoint);

  const NonSmoothDynamicalSystem& model() const { return model_; }
  const OneStepIntegrator& integrator() const { return *integrator_; }
  const ContactSolver& solver() const { return solver_.solver(); }
  double time_step() const { return dt_; }
  long steps() const { return step_; }
  const State& state() const { return state_; }
  const Reactions& reactions() const { return reactions_; }
  const StepReport& report() const { return report_; }

 private:
  class Busy;  // forbids a step, or a change of the observers, from within a step

  void check_start();
  void check_force_elements();
  void show(Observer& observer);
  void look();
  [[noreturn]] void fail(const StepReport& report);

  NonSmoothDynamicalSystem model_;
  std::unique_ptr<OneStepIntegrator> integrator_;
  ObservedSolver solver_;
  double dt_;
  long step_ = 0;
  bool busy_ = false;
  State state_;
  Reactions reactions_;
  StepReport report_;
  std::vector<std::shared_ptr<Observer>> observers_;
  std::function<void(double)> progress_;
  std::shared_ptr<const Layout> layout_;
  Configuration view_;  // where gaps and velocities of recorded rows are evaluated
  Vec velocities_;
  double potential_energy_ = 0.0;
};

}  // namespace saltus
