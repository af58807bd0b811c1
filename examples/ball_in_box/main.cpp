// The ball in a box of Section 5.2 in C++: prints its impacts until it lies in the corner.
#include <cstdio>
#include <exception>

#include "ball_in_box/ball_in_box.hpp"
#include "saltus/io/recording.hpp"
#include "saltus/kernel/integrators/registry.hpp"
#include "saltus/kernel/simulation/time_stepping.hpp"

int main() try {
  const auto model = saltus::examples::make_ball_in_box(saltus::examples::Gravity::oblique);
  const auto scheme = saltus::make_integrator("HalfExplicitTrapezoidalOSI");
  saltus::TimeStepping simulation(model, *scheme, 5e-3);
  const auto recording = std::make_shared<saltus::Recording>();
  simulation.add_observer(recording);
  simulation.run(2.0);

  for (long row = 0; row < recording->rows(); ++row)
    for (int side = 0; side < 4; ++side)
      if (const double impulse = recording->impulse[4 * row + side]; impulse > 0.0)
        std::printf("t = %.3f s: %.3g N s on the %s side\n", recording->t[row], impulse,
                    model.links()[side].name.c_str());
  std::printf("at rest: x = %.9f m, y = %.9f m\n", simulation.state().q[0], simulation.state().q[1]);
} catch (const std::exception& error) {
  std::fprintf(stderr, "ball_in_box: %s\n", error.what());
  return 1;
}
