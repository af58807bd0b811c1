#pragma once
#include <memory>
#include <vector>

#include "saltus/kernel/integrators/contact_stage.hpp"

namespace saltus {

/// The classic explicit Moreau-Jean scheme (29)-(33): every contact force is an impulse, order 1.
class ExplicitMoreauJean final : public OneStepIntegrator {
 public:
  std::string name() const override { return "ExplicitMoreauJeanOSI"; }
  void prepare(const NonSmoothDynamicalSystem& model, ContactSolver& solver) override;
  StepReport step(double dt, State& state, Reactions& reactions) override;
  std::unique_ptr<OneStepIntegrator> clone() const override { return std::make_unique<ExplicitMoreauJean>(); }

 private:
  bool contact_impulses(const Reactions& reactions, StepReport& report);
  void commit(double dt, State& state, Reactions& reactions, StepReport& report);

  std::shared_ptr<const Layout> layout_;
  std::vector<Configuration> configurations_;  // start and end of the step
  std::unique_ptr<ContactStage> contacts_;
  std::vector<int> active_;
  Vec q_, rate_, v_, h_, gamma_before_, gamma_free_;
};

}  // namespace saltus
