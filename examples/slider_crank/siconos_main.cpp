// The frictional slider crank in a simulation of Siconos, with an integrator of Saltus.
#include <SiconosKernel.hpp>
#include <cstdio>
#include <exception>

#include "saltus/siconos/one_step_integrator.hpp"
#include "slider_crank/siconos_model.hpp"

int main() try {
  const auto nsds = make_siconos_slider_crank(0.1);
  const auto scheme = std::make_shared<saltus::siconos::HalfExplicitTrapezoidal>();
  const auto td = std::make_shared<TimeDiscretisation>(0.0, 1e-5);
  const auto simulation =
      std::make_shared<TimeStepping>(nsds, td, scheme, std::make_shared<FrictionContact>(2));
  long steps = 0;
  for (; simulation->hasNextEvent(); ++steps) {
    simulation->computeOneStep();
    simulation->nextStep();
  }
  const auto crank = std::static_pointer_cast<LagrangianDS>(nsds->dynamicalSystemsVector().front());
  const SiconosVector& q = *crank->q();
  std::printf("%ld steps; theta = (%.9f, %.9f, %.9f) at t = %g s\n", steps, q(0), q(1), q(2),
              simulation->startingTime());
} catch (const std::exception& error) {
  std::fprintf(stderr, "siconos_slider_crank: %s\n", error.what());
  return 1;
}
