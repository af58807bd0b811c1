#pragma once
#include <memory>
#include <string>
#include <vector>

#include "saltus/kernel/integrators/d_minus/coefficients.hpp"
#include "saltus/kernel/integrators/d_minus/coupled_contacts.hpp"
#include "saltus/kernel/integrators/half_explicit/half_explicit.hpp"

namespace saltus {

/// The time-discontinuous Galerkin scheme (B.1)-(B.8): all stages and their multipliers together, by an
/// iteration for the velocities of the stages with W, M, h of the iterate before and the contact problem of
/// all stages inside. Output row and impact are those of a half-explicit scheme.
///
/// Where a contact approaches at the start, or changes between open, sticking and sliding within the step, no
/// polynomial in time describes what happens: the half-explicit trapezoidal rule takes that step.
class DMinusGalerkin final : public HalfExplicit {
 public:
  /// @param stages  the paper's s; of the order 2s with Lobatto's points
  /// @throws std::invalid_argument if stages is not 1, 2 or 3
  DMinusGalerkin(int stages, StagePoints points, Activity activity);

  void prepare(const NonSmoothDynamicalSystem& model, ContactSolver& solver) override;
  StepReport step(double dt, State& state, Reactions& reactions) override;
  std::unique_ptr<OneStepIntegrator> clone() const override {
    return std::make_unique<DMinusGalerkin>(rows_.s(), points_, settings_.activity);
  }

 protected:
  bool take_stages(double dt, const Reactions& before, StepReport& report) override;
  bool changes_contacts(int last, double dt) override;

 private:
  void begin_iteration(double dt, const Reactions& before);
  bool iterate(double dt, int iteration, StepReport& report);
  bool add_reactions(double dt, bool first, StepReport& report);
  bool take_over(StepReport& report);
  int contact_state(int contact, int stage, double zero);
  bool has_converged(double dt, int iteration) const;

  StagePoints points_;
  std::unique_ptr<CoupledContacts> coupled_;
  std::vector<Vec> next_;  // velocities of the iteration, of stages 1..s
  Vec rate_, gamma_;
  bool needs_end_ = true;                    // for W or Y there, in the iteration
  double change_ = 0.0, last_change_ = 0.0;  // largest of a velocity in an iteration
};

}  // namespace saltus
