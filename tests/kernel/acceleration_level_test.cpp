// The scheme of Section 3: contacts that are closed and do not open keep g̈ (52).
#include <gtest/gtest.h>

#include <cmath>

#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

const std::string scheme_name = "DMinusAccelerationOSI";

TEST(Curvature, OfTheCircleIsTheRateOfItsJacobian) {
  // (38) along q + t v
  const Circle circle(2, 0.8);
  const Vec q = vec({0.5, -0.7}), v = vec({1.5, 2.5});
  const double step = 1e-5;
  Matrix rows[2] = {Matrix::Zero(2, 2), Matrix::Zero(2, 2)};
  for (int side : {0, 1}) {
    const Vec moved = q + (side ? step : -step) * v;
    circle.jacobian(In(moved.data(), 2), OutMatrix(rows[side].data(), 2, 2));
  }
  Vec c = Vec::Zero(2);
  circle.curvature(In(q.data(), 2), In(v.data(), 2), Out(c.data(), 2));
  EXPECT_LT((c - (rows[1] - rows[0]) * v / (2.0 * step)).norm(), 1e-8);
}

TEST(AccelerationLevel, ACoulombLawWithoutFrictionIsTheLawWithoutFriction) {
  const auto with = make_bowl(0.0);
  NonSmoothDynamicalSystem without(with.systems());
  without.link(std::make_shared<Interaction>(std::make_shared<Circle>(1, 0.8), NewtonImpactNSL(0.0), "bowl"),
               *with.systems()[0]);
  const auto scheme = make_integrator(scheme_name);
  const auto rows = rows_of_run(with, *scheme, 1e-3, 0.25),
             others = rows_of_run(without, *scheme, 1e-3, 0.25);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    EXPECT_LT((rows[k].state.q - others[k].state.q).norm(), 1e-12);
    EXPECT_LT((rows[k].state.v - others[k].state.v).norm(), 1e-12);
    EXPECT_NEAR(rows[k].reactions.lambda_plus[0], others[k].reactions.lambda_plus[0], 1e-9);
    EXPECT_NEAR(rows[k].reactions.lambda_minus[0], others[k].reactions.lambda_minus[0], 1e-9);
    EXPECT_EQ(rows[k].reactions.lambda_plus[1], 0.0);
  }
  EXPECT_GT(rows.back().reactions.lambda_plus[0], 1.0);  // in contact, or nothing was compared
}

TEST(AccelerationLevel, APersistentContactIsOfFirstOrder) {
  // Second order under bilateral constraints; here (52) drops λ⁻ once, where the predicted ġ is above zero.
  const Orders orders = measure_orders(make_bowl(0.0), *make_integrator(scheme_name), exact_bowl(0.0, 0.25),
                                       0.25, {1e-3, 5e-4, 2.5e-4, 1.25e-4});
  EXPECT_NEAR(orders.q, 1.0, 0.1);
  EXPECT_NEAR(orders.v, 1.0, 0.1);
}

TEST(AccelerationLevel, AClosedContactThatApproachesSinksAtConstantSpeed) {
  // g̈ = 0 leaves ġ as it is: the weight is carried, the approach is not taken. This is why Section 4 exists.
  for (const Row& row : rows_of_run(make_ball(-1e-4, -0.5, 0.9), *make_integrator(scheme_name), 1e-3, 0.1)) {
    EXPECT_NEAR(row.state.v[0], -0.5, 1e-13);
    EXPECT_NEAR(row.report.penetration, 1e-4 + 0.5 * row.state.t, 1e-13);
    EXPECT_FALSE(row.report.impulsive);
    if (row.state.t == 0.0) continue;
    EXPECT_NEAR(row.reactions.lambda_plus[0], 2.0 * gravity, 1e-10);
    EXPECT_NEAR(row.reactions.lambda_minus[0], 2.0 * gravity, 1e-10);
  }
}

TEST(AccelerationLevel, AClosedContactThatOpensHasNoForce) {
  for (const Row& row : rows_of_run(make_ball(-1e-2, 1.0, 0.9), *make_integrator(scheme_name), 1e-3, 5e-3)) {
    EXPECT_GT(row.report.penetration, 0.0);
    EXPECT_NEAR(row.state.v[0], 1.0 - gravity * row.state.t, 1e-14);
    EXPECT_EQ(row.reactions.lambda_plus[0] + row.reactions.lambda_minus[0], 0.0);
  }
}

}  // namespace
}  // namespace saltus::test
