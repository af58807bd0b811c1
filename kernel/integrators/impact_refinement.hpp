#pragma once
#include <memory>

#include "saltus/kernel/integrators/one_step_integrator.hpp"

namespace saltus {

/// Takes a step in which an impact happened again, in equal parts: the time-step size Δt/10 of impulsive
/// periods, Section 6.2. An impact is then met within Δt/parts; the steps' times stay what they are.
/// Of such a step λ⁺ is that of its first part, λ⁻ that of its last, Λ the sum, their mean force the mean.
class ImpactRefinement final : public OneStepIntegrator {
 public:
  /// @param scheme  that takes the steps
  /// @throws std::invalid_argument if parts < 2
  ImpactRefinement(std::unique_ptr<OneStepIntegrator> scheme, int parts);

  std::string name() const override { return scheme_->name(); }
  void prepare(const NonSmoothDynamicalSystem& model, ContactSolver& solver) override;
  StepReport step(double dt, State& state, Reactions& reactions) override;
  std::vector<double> memory() const override { return scheme_->memory(); }
  void remember(std::span<const double> memory) override { scheme_->remember(memory); }
  std::unique_ptr<OneStepIntegrator> clone() const override {
    return std::make_unique<ImpactRefinement>(scheme_->clone(), parts_);
  }

 private:
  StepReport parts(double dt, State& state, Reactions& reactions);

  std::unique_ptr<OneStepIntegrator> scheme_;
  int parts_;
  State state_before_;
  Reactions reactions_before_, sums_;
};

}  // namespace saltus
