#pragma once
#include "saltus/kernel/assembly/configuration.hpp"
#include "saltus/kernel/integrators/one_step_integrator.hpp"

namespace saltus {

/// Everything about one row of a run. Row 0 is the initial state with zero reactions, row k the step
/// that ends at t. Views are valid during the call only.
struct StepView {
  long step;
  const State& state;
  const Vec& gaps;        ///< of all contacts (gaps) [m]
  const Vec& velocities;  ///< γ = Wᵀv⁺ of all contacts (rows) [m/s]
  const Reactions& reactions;
  const StepReport& report;
  double potential_energy;       ///< [J], NaN if a system does not know its own
  Configuration& configuration;  ///< at the state; evaluates force directions when they are asked for
};

/// Looks at the steps of a run. Recorders are observers.
class Observer {
 public:
  virtual ~Observer() = default;
  /// Is this row of interest? Gaps and velocities are evaluated only then.
  virtual bool wants(long /*step*/, const StepReport& /*report*/) const { return true; }
  virtual void observe(const StepView& view) = 0;
};

}  // namespace saltus
