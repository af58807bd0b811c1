#pragma once
#include "saltus/kernel/integrators/adaptive/event_search.hpp"

namespace saltus {

struct ErrorControl : Tolerances {
  /// Steps are not made smaller [s]; 0: a millionth of the simulation's step
  double minimum_step = 0.0;
  /// Contacts that meet with less are closed plastically [m/s]
  double velocity_tolerance = 0.0;
};

/// A half-explicit scheme that chooses its steps: their error is held to a tolerance, and they end where
/// contacts close, so that the order survives impacts. A step of the simulation is only where the motion is
/// looked at: positions between the ends of inner steps are interpolated.
///
/// Contacts of an inner step are those closed at its start. One leaves when its last multiplier is zero and
/// it opens, one joins when its gap, a cubic polynomial over the step, falls to zero: the step is then taken
/// again from the same start with that length. Impacts start from v⁻ with λ, so that what rests stays at
/// rest. A contact that bounced within the smallest step before is closed plastically.
class AdaptiveHalfExplicit final : public OneStepIntegrator {
 public:
  using MakeTrial = std::unique_ptr<Trial> (*)();
  /// @throws std::invalid_argument if a tolerance or the smallest step is out of range
  AdaptiveHalfExplicit(MakeTrial method, ErrorControl control);

  std::string name() const override { return "AdaptiveHalfExplicitOSI"; }
  void prepare(const NonSmoothDynamicalSystem& model, ContactSolver& solver) override;
  StepReport step(double dt, State& state, Reactions& reactions) override;
  std::vector<double> memory() const override;
  void remember(std::span<const double> memory) override;
  std::unique_ptr<OneStepIntegrator> clone() const override {
    return std::make_unique<AdaptiveHalfExplicit>(method_, control_);
  }

 private:
  struct Impact {  // at the end of the inner step
    Vec impulse;   // Λ (rows) [N s]
    double work;   // [J]
    bool happens;
    int captures;
  };

  template <typename Scheme, typename Memory>
  static void exchange(Scheme& scheme, Memory& memory);
  bool continues(double t, const State& state, double dt) const;
  bool restart(const State& state, const Reactions& reactions, double dt, StepReport& report);
  bool inner_step(StepReport& report);
  double attempt(double h, StepReport& report);
  double error() const;
  bool meet_tolerance(double& h, StepReport& report);
  bool meet_event(double& h, StepReport& report);
  bool accept(double h, StepReport& report);
  bool leaves(int contact, double h);
  bool impact(Configuration& at, Vec& v, StepReport& report);
  void choose_rebound(Configuration& at, const Vec& v);
  bool takes_turns(int contact, double speed) const;
  void close(Configuration& at, const Vec& v_before, const Vec& v_after);
  void take_impact(StepReport& report, Reactions& sums);
  bool take_inner_steps(double from, double to, StepReport& report);
  void show(double to, double dt, State& state, Reactions& reactions, StepReport& report);

  MakeTrial method_;
  ErrorControl control_;
  std::shared_ptr<const Layout> layout_;
  std::unique_ptr<Trial> trial_;
  std::unique_ptr<EventSearch> events_;
  std::unique_ptr<PositionProjection> projection_;
  std::unique_ptr<Configuration> view_;  // where the motion is looked at

  // Where the inner steps have come to
  double t_ = 0.0;
  Vec q_, v_;
  std::vector<int> closed_;               // of the next inner step
  std::vector<unsigned char> is_closed_;  // the same as flags
  std::vector<double> last_impact_;       // of each contact [s]
  Vec level_;                             // gaps at which closed contacts are held (gaps) [m]
  double h_ = 0.0;                        // length of the next inner step [s]
  double smallest_ = 0.0, largest_ = 0.0;
  long attempts_ = 0, shortest_steps_ = 0;  // within a step of the simulation
  double fastest_ = 0.0;                    // approach in the last impact [m/s]
  Reactions warm_;

  InnerStep inner_;                        // the last one
  bool ahead_ = false;                     // it is not yet used up
  Impact impact_;                          // at its end
  std::vector<unsigned char> was_closed_;  // in it

  State shown_;               // what the simulation has seen last
  bool valid_ = false;        // shown_ and the inner steps belong together
  Reactions sums_;            // of a step of the simulation
  std::vector<int> meeting_;  // contacts of an impact
  Vec gamma_, rebound_, v_before_;
};

}  // namespace saltus
