// The frictional slider crank of Section 2.1 in C++: ten lines from a model to its impacts.
#include "slider_crank/slider_crank.hpp"

#include <cstdio>
#include <exception>

#include "saltus/io/recording.hpp"
#include "saltus/kernel/integrators/registry.hpp"
#include "saltus/kernel/simulation/time_stepping.hpp"

int main() try {
  const auto model = saltus::examples::make_slider_crank(saltus::examples::Guidance::frictional);
  const auto scheme = saltus::make_integrator("HalfExplicitTrapezoidalOSI");
  saltus::TimeStepping simulation(model, *scheme, 1e-5);
  const auto recording = std::make_shared<saltus::Recording>();
  simulation.add_observer(recording);
  simulation.run(0.1);

  long impacts = 0;
  for (unsigned char impulsive : recording->impulsive) impacts += impulsive;
  std::printf("%ld steps, %ld of them impulsive; theta = (%.9f, %.9f, %.9f) at t = %g s\n",
              simulation.steps(), impacts, simulation.state().q[0], simulation.state().q[1],
              simulation.state().q[2], simulation.state().t);
} catch (const std::exception& error) {
  std::fprintf(stderr, "slider_crank: %s\n", error.what());
  return 1;
}
