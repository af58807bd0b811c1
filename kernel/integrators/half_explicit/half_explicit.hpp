#pragma once
#include <memory>
#include <string>
#include <vector>

#include "saltus/kernel/assembly/position_projection.hpp"
#include "saltus/kernel/integrators/half_explicit/rows.hpp"

namespace saltus {

/// Which contacts carry multipliers, C_i.
enum class Activity {
  start,      ///< closed at the start of the step, (69); the last multiplier of those still closed at its end
  predicted,  ///< closed at the predicted position, (77), (B.11): corrupts impacts, kept to show it
  /// closed at the start, or held: a contact is held as long as its last multiplier presses, and if an impact
  /// does not separate it. A gap that drifts open by rounding then costs no force and no order.
  sticky,
};

/// Where the multipliers of the stages put the constraint right.
enum class Level {
  velocity,      ///< Wᵀv at the row's own position, (69)-(72)
  acceleration,  ///< g̈ at the stage of the multiplier, (36)-(42), on contacts that are closed and do not
                 ///< open, (52); without friction
};

/// The velocity v⁻ before an impact.
enum class ImpactRule {
  paper,  ///< without any λ, (55): bodies at rest elsewhere arrive with h Δt and bounce by ε of it
  keep_resting_forces,  ///< with λ of the contacts that were closed before: they stay at rest
};

struct HalfExplicitSettings {
  Level level = Level::velocity;
  Activity activity = Activity::start;
  ImpactRule impact = ImpactRule::paper;
  bool stabilized = false;  ///< pulls positions back to the constraints, PositionProjection; sticky only
};

/// All half-explicit schemes: one row after the other, each an explicit stage with a multiplier that keeps
/// the constraint; then the impact, if a contact has newly closed. A scheme that finds its stages together
/// overrides take_stages(): the output row and the impact are the same.
class HalfExplicit : public OneStepIntegrator {
 public:
  /// @param name  in the registry
  /// @throws std::invalid_argument if the tableau or a combination of settings is refused
  HalfExplicit(std::string name, Tableau tableau, HalfExplicitSettings settings);

  std::string name() const override { return name_; }
  void prepare(const NonSmoothDynamicalSystem& model, ContactSolver& solver) override;
  StepReport step(double dt, State& state, Reactions& reactions) override;
  std::unique_ptr<OneStepIntegrator> clone() const override {
    return std::make_unique<HalfExplicit>(name_, rows_.tableau(), settings_);
  }

 protected:
  using Stage = Rows::Stage;

  /// The stages 1…s, and the multipliers of those before them. @param before  reactions of the last step
  /// @return false if the status in the report is no longer ok
  virtual bool take_stages(double dt, const Reactions& before, StepReport& report);
  /// Is some contact not in one state, open, sticking or sliding one way, over all stages up to the last?
  virtual bool changes_contacts(int last, double dt);

  HalfExplicitSettings settings_;
  Rows rows_;
  std::shared_ptr<const Layout> layout_;
  std::unique_ptr<HalfExplicit> simple_;  // of two stages, for steps in which more do harm
  std::vector<int> start_;                // C_i

 private:
  void begin(const State& state, const Reactions& reactions);
  bool is_held(int contact, const State& state);
  bool row(int l, double dt, StepReport& report);
  bool move_to_end(double dt, StepReport& report);
  bool impact(double dt, StepReport& report);
  void choose_active(int l, const Configuration& constraint);
  void choose_staying(Configuration& at, const Stage& stage, double dt);
  bool newly_closed();
  bool approaches(double dt);
  int contact_state(int contact, int stage, double zero) const;
  bool within_reach(int contact, double dt);
  bool impacts(int contact, double dt);
  void hold(double dt, bool impulsive, std::vector<unsigned char>& held);
  void commit(double dt, State& state, Reactions& reactions, StepReport& report);

  std::string name_;
  double least_weight_;  // smallest a_{l,l-1}, b_s
  bool in_order_;        // the stages follow each other in time

  std::unique_ptr<PositionProjection> projection_;
  std::vector<unsigned char> in_start_;  // start_ as flags
  std::vector<int> active_;              // of the contact problem at hand
  std::vector<int> drifted_;             // that may be pulled back
  Vec gamma_, impulse_;
};

}  // namespace saltus
