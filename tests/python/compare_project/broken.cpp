// The half-explicit scheme, broken in three ways.
#include "saltus/kernel/integrators/registry.hpp"

namespace {

using namespace saltus;

template <class Broken>
class Wrapped : public OneStepIntegrator {
 public:
  std::unique_ptr<OneStepIntegrator> clone() const override { return std::make_unique<Broken>(); }
  void prepare(const NonSmoothDynamicalSystem& model, ContactSolver& solver) override {
    scheme_->prepare(model, solver);
  }
  StepReport step(double dt, State& state, Reactions& reactions) override {
    return scheme_->step(dt, state, reactions);
  }

 private:
  std::unique_ptr<OneStepIntegrator> scheme_ = make_integrator("HalfExplicitTrapezoidalOSI");
};

// Restitution 0.9 times what it should be
class WeakRestitution final : public Wrapped<WeakRestitution> {
 public:
  std::string name() const override { return "WeakRestitution"; }
  void prepare(const NonSmoothDynamicalSystem& model, ContactSolver& solver) override {
    model_ = std::make_unique<NonSmoothDynamicalSystem>(model.systems(), model.t0());
    for (const auto& link : model.links()) {
      NonSmoothLaw law = link.interaction->law();
      law.restitution *= 0.9;
      const std::shared_ptr<const Relation> relation(link.interaction, &link.interaction->relation());
      const LagrangianDS* second = link.second < 0 ? nullptr : model.systems()[link.second].get();
      model_->link(std::make_shared<Interaction>(relation, law, link.name), *model.systems()[link.first],
                   second);
    }
    Wrapped::prepare(*model_, solver);
  }

 private:
  std::unique_ptr<NonSmoothDynamicalSystem> model_;
};

// Positions by Euler's rule: first order
class LostOrder final : public Wrapped<LostOrder> {
 public:
  std::string name() const override { return "LostOrder"; }
  StepReport step(double dt, State& state, Reactions& reactions) override {
    const Vec q = state.q + dt * state.v;
    const StepReport report = Wrapped::step(dt, state, reactions);
    state.q = q;
    return report;
  }
};

// Positions that sink by 3 mm/s, whatever carries them
class Sinking final : public Wrapped<Sinking> {
 public:
  std::string name() const override { return "Sinking"; }
  StepReport step(double dt, State& state, Reactions& reactions) override {
    const StepReport report = Wrapped::step(dt, state, reactions);
    state.q.array() -= 0.003 * dt;
    return report;
  }
};

}  // namespace

SALTUS_INTEGRATOR(WeakRestitution, .summary = "restitution 0.9 times too small");
SALTUS_INTEGRATOR(LostOrder, .summary = "positions of first order");
SALTUS_INTEGRATOR(Sinking, .summary = "positions that drift");
