// How far contacts penetrate on the three levels: impulses, accelerations, velocities (Sections 2, 3, 4).
#include <gtest/gtest.h>

#include <algorithm>

#include "slider_crank/slider_crank.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

double largest_penetration(const NonSmoothDynamicalSystem& model, const std::string& scheme, double dt,
                           double until) {
  double largest = 0.0;
  for (const Row& row : rows_of_run(model, *make_integrator(scheme), dt, until))
    largest = std::max(largest, row.report.penetration);
  return largest;
}

TEST(Penetration, OfTheFrictionlessSliderCrank) {
  const auto model = examples::make_slider_crank(examples::Guidance::frictionless);
  for (const auto& [scheme, expected] : {std::pair("ExplicitMoreauJeanOSI", 3.97e-4),
                                         {"DMinusAccelerationOSI", 8.3e-5},
                                         {"HalfExplicitTrapezoidalOSI", 5.4e-5}})
    EXPECT_NEAR(largest_penetration(model, scheme, 1e-4, 0.1), expected, 0.02 * expected) << scheme;
}

// The growth of the penetration in a bowl without friction, where the contact persists.
double drift_slope(const std::string& scheme) {
  const std::vector<double> dt = {1e-3, 5e-4, 2.5e-4, 1.25e-4};
  std::vector<double> drift;
  for (double h : dt) drift.push_back(largest_penetration(make_bowl(0.0), scheme, h, 0.25) - 1e-4);
  return slope(dt, drift);
}

TEST(Penetration, OfAPersistentContactDriftsOnAccelerationLevel) {
  // Where a stage leaves the contact out because ġ > 0 by the scheme's own error, ġ of the size of Δt
  // remains.
  EXPECT_NEAR(drift_slope("DMinusAccelerationOSI"), 1.0, 0.1);
  EXPECT_GE(drift_slope("HalfExplicitTrapezoidalOSI"), 1.9);  // on a circle even 3
}

}  // namespace
}  // namespace saltus::test
