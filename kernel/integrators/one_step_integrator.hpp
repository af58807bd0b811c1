#pragma once
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "saltus/kernel/model/nonsmooth_dynamical_system.hpp"
#include "saltus/numerics/contact_solver.hpp"

namespace saltus {

/// What a run carries from step to step.
struct State {
  double t = 0.0;  ///< [s]
  Vec q;           ///< (n)
  Vec v;           ///< (n) right limit v⁺
  /// (contacts) not zero: held closed by a scheme that remembers contacts, though the gap may have drifted
  /// open. Empty before such a scheme has taken a step.
  std::vector<unsigned char> held = {};
};

/// Contact forces and impulses of one step, at full size: rows of contacts that are open are zero.
struct Reactions {
  Vec lambda_plus;   ///< (rows) λ⁺ at the start of the step [N]
  Vec lambda_minus;  ///< (rows) λ⁻ at its end [N]
  Vec force;         ///< (rows) their mean over the step, by the scheme's quadrature [N]
  Vec impulse;       ///< (rows) Λ at its end [N s]

  void set_zero(int rows);
};

enum class StepStatus {
  ok,
  solver_failed,               ///< no impulses that satisfy the laws were found
  mass_not_positive_definite,  ///< M(q) cannot be factorised
  iteration_failed,            ///< Newton's iteration of an implicit scheme does not converge
  gap_not_finite,              ///< NaN or infinity in a gap: it can be neither open nor closed
  too_many_steps,              ///< a scheme that chooses its steps makes no headway
  accumulation,                ///< impacts of a contact accumulate in one instant: there is no next event
  not_finite,                  ///< NaN or infinity in velocities: the motion diverges
};

/// A sentence without full stop.
std::string_view to_string(StepStatus status);

/// What one step says about itself.
struct StepReport {
  StepStatus status = StepStatus::ok;
  int contact = -1;             ///< that the status is about, if it is about one
  bool impulsive = false;       ///< the impact law was applied; Moreau-Jean: an impulse acted
  int closed = 0;               ///< closed contacts at the end of the step, bilateral ones included
  int solver_iterations = 0;    ///< over all contact problems of the step
  double residual = 0.0;        ///< largest certificate of the step [m/s]
  double penetration = 0.0;     ///< largest -g of the unilateral contacts at the end [m]
  double kinetic_energy = 0.0;  ///< at the end [J]
  double work_forces = 0.0;     ///< of h by the scheme's quadrature, ½ vᵀṀv by the trapezoidal rule [J]
  double work_lambda = 0.0;     ///< of λ by the scheme's quadrature [J]
  double work_impulse = 0.0;    ///< of Λ: exactly the jump of the kinetic energy [J]
  // Of schemes that choose steps of their own within this one; 0 of others.
  int accepted_steps = 0;  ///< steps taken
  int rejected_steps = 0;  ///< those taken again because their error was too large
  int event_steps = 0;     ///< those ended at a closing contact, or another event, that was located
  int captures = 0;        ///< contacts closed plastically, because their bounces have become too short
};

/// What happened at a time within a step that was located: an impact, a contact that opens, sticks or slips.
struct LocatedEvent {
  double t = 0.0;                     ///< [s]
  Vec q;                              ///< (coordinates)
  Vec v_before, v;                    ///< (n) v⁻ and v⁺
  Vec gaps;                           ///< (gaps)
  Vec velocities_before, velocities;  ///< (rows) γ⁻ and γ⁺
  Vec impulse, generalised_impulse;   ///< (rows) Λ and (n) WΛ [N s]
  Vec force, generalised_force;       ///< (rows) λ⁺ and (n) Wλ⁺ [N]
};

/// A one-step scheme: takes a state from t to t + dt.
class OneStepIntegrator {
 public:
  virtual ~OneStepIntegrator() = default;
  /// Name in the registry.
  virtual std::string name() const = 0;
  /// Sizes every workspace: step() then allocates nothing. The model and the solver must outlive it.
  /// @throws std::invalid_argument if the scheme cannot integrate the model, saying why
  virtual void prepare(const NonSmoothDynamicalSystem& model, ContactSolver& solver) = 0;
  /// One step; only after prepare(), with a state and reactions of the model's sizes. If the report's status
  /// is not ok, state and reactions are as before.
  /// @param reactions  in: of the step before, or zero (warm start); out: of this one
  virtual StepReport step(double dt, State& state, Reactions& reactions) = 0;
  /// The events of the last step in the order of time, of a scheme that locates them.
  virtual std::span<const LocatedEvent> events() const { return {}; }
  /// What the scheme carries from step to step besides state and reactions, of most schemes nothing: a run
  /// that goes on elsewhere from these three has the same bits.
  virtual std::vector<double> memory() const { return {}; }
  /// After prepare(): goes on with what memory() gave.
  /// @throws std::invalid_argument if it is of another scheme or model
  virtual void remember(std::span<const double> memory);
  /// The same scheme with a workspace of its own.
  virtual std::unique_ptr<OneStepIntegrator> clone() const = 0;
};

}  // namespace saltus
