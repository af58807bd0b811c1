#pragma once
#include <memory>
#include <vector>

#include "saltus/kernel/integrators/contact_stage.hpp"
#include "saltus/kernel/integrators/moreau_jean/iteration_matrix.hpp"

namespace saltus {

/// Moreau-Jean time-stepping with the θ rule for the smooth forces:
///   M(q_θ)(v⁺ − v) = Δt (θ h(t⁺, q⁺, v⁺) + (1−θ) h(t, q, v)) + W(q⁺) Λ,   q_θ = (1−θ) q + θ q⁺,
///   q⁺ = q + Δt Y (θ v⁺ + (1−θ) v),   law (6)-(7) between W(q⁺)ᵀv⁺ + ε W(q)ᵀv and Λ,
/// on the contacts that a part `gamma` of the step would close at the velocity of its start (33). Newton's
/// iteration; a single one for time-invariant systems and force elements whose relations are linear. Of order
/// 2 in smooth motion for θ = ½, else 1.
class MoreauJean final : public OneStepIntegrator {
 public:
  /// @param theta, gamma  in [0, 1]
  /// @throws std::invalid_argument if one is outside
  MoreauJean(double theta, double gamma);
  std::string name() const override { return "MoreauJeanOSI"; }
  void prepare(const NonSmoothDynamicalSystem& model, ContactSolver& solver) override;
  StepReport step(double dt, State& state, Reactions& reactions) override;
  std::unique_ptr<OneStepIntegrator> clone() const override {
    return std::make_unique<MoreauJean>(theta_, gamma_);
  }

 private:
  bool begin(double dt, const State& state, StepReport& report);
  bool iterate(double dt, const State& state, const Reactions& reactions, StepReport& report);
  bool move(double dt, const State& state, StepReport& report);
  void commit(double dt, State& state, Reactions& reactions, StepReport& report);

  double theta_, gamma_;
  double size_ = 0.0;    // of the velocities in the step
  bool linear_ = false;  // one iteration is exact
  std::shared_ptr<const Layout> layout_;
  std::vector<Configuration> configurations_;  // start and end of the step
  std::unique_ptr<Configuration> middle_;      // q_θ
  std::unique_ptr<IterationMatrix> matrix_;
  std::unique_ptr<ContactStage> contacts_;
  std::vector<int> active_;
  Vec q_, q_middle_, rate_, v_, next_, change_, h_, h_end_, gamma_before_;
};

}  // namespace saltus
