// The rotor of Section 6.2 in C++: impacts in the ring, and what holds at the end.
#include <algorithm>
#include <cstdio>
#include <exception>

#include "rotor/rotor.hpp"
#include "saltus/kernel/integrators/registry.hpp"
#include "saltus/kernel/simulation/time_stepping.hpp"

int main() try {
  const auto model = saltus::examples::make_rotor();
  const auto scheme = saltus::make_integrator("HalfExplicitTrapezoidalOSI", {{"impulsive_substeps", 10.0}});
  saltus::TimeStepping simulation(model, *scheme, 5e-6);
  int impulsive = 0;
  double penetration = 0.0;  // [m]
  for (int k = 0; k < 10'000; ++k) {
    const saltus::StepReport& report = simulation.step();
    impulsive += report.impulsive;
    penetration = std::max(penetration, report.penetration);
  }
  const Eigen::Index flywheel = model.systems()[0]->dimension();
  std::printf("flywheel at %.2f rad/s, %d of 10000 steps impulsive, penetration %.1e m\n",
              simulation.state().v[flywheel + 3], impulsive, penetration);
} catch (const std::exception& error) {
  std::fprintf(stderr, "rotor: %s\n", error.what());
  return 1;
}
