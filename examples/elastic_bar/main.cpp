// The elastic bar of Section 6.1 in C++: what the obstacle feels, beside what the continuous bar would press.
#include <cmath>
#include <cstdio>
#include <exception>

#include "elastic_bar/elastic_bar.hpp"
#include "saltus/io/recording.hpp"
#include "saltus/kernel/integrators/registry.hpp"
#include "saltus/kernel/simulation/time_stepping.hpp"

int main() try {
  const saltus::examples::ElasticBarParameters p;
  const auto model = saltus::examples::make_elastic_bar(50);
  const auto scheme = saltus::make_integrator("HalfExplicitTrapezoidalOSI");
  saltus::TimeStepping simulation(model, *scheme, 1e-7);
  const auto recording = std::make_shared<saltus::Recording>();
  simulation.add_observer(recording);
  simulation.run(1.5e-3);

  double impact = 0.0, end = 0.0, momentum = 0.0;  // [s], [s], [N s]
  for (long row = 0; row < recording->rows(); ++row) {
    if (recording->impulsive[row]) {
      impact = recording->t[row];
      std::printf("impact at %.7f s, impulse %.6f N s\n", impact, recording->impulse[row]);
    }
    if (recording->force[row] > 0.0) end = recording->t[row];
    momentum += recording->impulse[row] + 1e-7 * recording->force[row];
  }
  const double wave_speed = std::sqrt(p.modulus / p.density);
  std::printf("contact lasts %.4e s, of the continuous bar %.4e s\n", end - impact,
              2.0 * p.length / wave_speed);
  std::printf("momentum from the obstacle %.6f N s, of the continuous bar %.6f N s\n", momentum,
              2.0 * p.density * p.section * p.length * p.speed);
} catch (const std::exception& error) {
  std::fprintf(stderr, "elastic_bar: %s\n", error.what());
  return 1;
}
