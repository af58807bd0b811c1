#include "siconos/native_run.hpp"

#include "saltus/kernel/integrators/registry.hpp"
#include "saltus/kernel/simulation/time_stepping.hpp"
#include "slider_crank/slider_crank.hpp"

namespace saltus::test {
namespace {

std::vector<double> list(const Vec& values) { return {values.data(), values.data() + values.size()}; }

class Steps final : public Observer {
 public:
  explicit Steps(double dt) : dt_(dt) {}
  void observe(const StepView& view) override {
    if (view.step > 0)
      rows.push_back({list(view.state.q), list(view.state.v), list(view.gaps), list(view.velocities),
                      list(view.reactions.impulse + dt_ * view.reactions.force)});
  }
  std::vector<NativeStep> rows;

 private:
  double dt_;
};

}  // namespace

std::vector<NativeStep> native_slider_crank(const std::string& scheme, double dt, double until) {
  const auto model = examples::make_slider_crank(examples::Guidance::frictional);
  TimeStepping simulation(model, *make_integrator(scheme), dt);
  const auto steps = std::make_shared<Steps>(dt);
  simulation.add_observer(steps);
  simulation.run(until);
  return steps->rows;
}

}  // namespace saltus::test
