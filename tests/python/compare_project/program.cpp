// A comparison in C++, whose figures a test holds against those of the command line. Exits with 1 if a limit
// is broken.
#include <saltus/compare.hpp>

#include <cstdio>
#include <iostream>

#include "slider_crank/slider_crank.hpp"

int main(int count, char** words) {
  const auto model = saltus::examples::make_slider_crank(saltus::examples::Guidance::frictional);
  saltus::CompareSettings settings{.integrators = {saltus::candidate("HalfExplicitTrapezoidalOSI")},
                                   .baseline = saltus::candidate("ExplicitMoreauJeanOSI"),
                                   .time_steps = {1e-3, 1e-4},
                                   .until = 0.1,
                                   .timings = 0};
  if (count > 1) settings.limits.max_error = std::stod(words[1]);
  const auto result = saltus::compare(model, settings);
  for (const auto& row : result.rows)
    std::printf("%s %.17g %.17g %.17g %.17g %.17g %.17g\n", row.integrator.c_str(), row.time_step,
                row.figures.error_q, row.figures.error_v, row.figures.spectral, row.figures.impulse_error,
                row.figures.energy_drift);
  std::cerr << saltus::to_text(result);
  return result.ok() ? 0 : 1;
}
