// The rotor of Section 6.2: model, welds and the first impacts. Its axle is compared with beam theory in
// Python.
#include "rotor/rotor.hpp"

#include <gtest/gtest.h>

#include "saltus/kernel/model/check.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

constexpr double dt = 5e-6;  // [s]

double largest_opening(const NonSmoothDynamicalSystem& model, const Vec& q) {
  double largest = 0.0;
  for (int k = 0; k < 2; ++k) {
    const auto& link = model.links()[k];
    const auto offset = k == 0 ? 30 : 37;
    Vec ends(37);
    ends << q.head(30), q.segment(offset, 7);
    Vec g = Vec::Zero(6);
    link.interaction->relation().gap(In(ends.data(), 37), Out(g.data(), 6));
    largest = std::max(largest, g.head<3>().cwiseAbs().maxCoeff());
  }
  return largest;
}

TEST(Rotor, ItsModelAgreesWithItself) {
  for (const CheckItem& item : check(examples::make_rotor()))
    EXPECT_TRUE(item.ok()) << item.subject << ' ' << item.quantity << ' ' << item.deviation;
}

TEST(Rotor, HitsTheRingWithClosedWelds) {
  const auto model = examples::make_rotor();
  const auto rows = rows_of_run(
      model, *make_integrator("HalfExplicitTrapezoidalOSI", {{"impulsive_substeps", 10.0}}), dt, 5e-3);
  int impulsive = 0;
  for (const Row& row : rows) {
    EXPECT_LT(largest_opening(model, row.state.q), 1e-8) << row.state.t;
    EXPECT_LT(row.report.penetration, 2e-8) << row.state.t;
    if (!row.report.impulsive) continue;
    if (impulsive++ == 0) {
      EXPECT_NEAR(row.state.t, 4.475e-3, 2 * dt);
    }
  }
  EXPECT_GT(impulsive, 1);
}

TEST(Rotor, RefusesStationsBesideTheAxleAndBodiesThatAreNone) {
  const Vec zero = Vec::Zero(30);
  const examples::Axle axle(zero, zero, {});
  expect_refusal([&] { axle.station(-1e-9); }, {"from 0 to its length"});
  expect_refusal([&] { examples::AxleWeld(axle, 0.1).require_dimensions(30, 30); }, {"its axle"});
}

}  // namespace
}  // namespace saltus::test
