// Bodies at rest: what carries their weight, and that they stay where they are.
#include <gtest/gtest.h>

#include <cmath>

#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

class Rest : public testing::TestWithParam<std::string> {
 protected:
  // Expects weight [N] in a row of the reactions, as a force or as an impulse.
  void expect_carried(const Row& row, int index, double weight, double dt) const {
    const bool forces = scheme_properties(GetParam()).forces_at_rest;
    EXPECT_NEAR(row.reactions.lambda_plus[index], forces ? weight : 0.0, 1e-9);
    EXPECT_NEAR(row.reactions.lambda_minus[index], forces ? weight : 0.0, 1e-9);
    EXPECT_NEAR(row.reactions.impulse[index], forces ? 0.0 : weight * dt, 1e-12);
    EXPECT_EQ(row.report.impulsive, !forces);
  }
};

TEST_P(Rest, ABallOnTheFloor) {
  const double dt = 1e-3, mass = 2.0;
  const auto rows = rows_of_run(make_ball(-1e-4, 0.0, 0.5, mass), *make_scheme(GetParam()), dt, 0.1);
  for (std::size_t k = 1; k < rows.size(); ++k) {
    expect_carried(rows[k], 0, mass * gravity, dt);
    EXPECT_NEAR(rows[k].state.v[0], 0.0, 1e-15);
    EXPECT_NEAR(rows[k].state.q[0], -1e-4, 1e-16);
    EXPECT_NEAR(rows[k].report.penetration, 1e-4, 1e-16);
    EXPECT_EQ(rows[k].report.closed, 1);
  }
}

TEST_P(Rest, AColumnOfBalls) {
  const int n = 6;
  const double dt = 1e-3;
  NonSmoothDynamicalSystem::Systems balls;
  for (int k = 0; k < n; ++k)
    balls.push_back(std::make_shared<LagrangianLinearTIDS>(
        vec({k * (1.0 - 1e-9)}), vec({0.0}), Matrix::Identity(1, 1),
        LagrangianLinearTIDS::Terms{.external_force = vec({-gravity})}));
  NonSmoothDynamicalSystem model(balls);
  for (int k = 0; k < n; ++k) {
    const Matrix H = k == 0 ? Matrix(Matrix::Identity(1, 1)) : Matrix((Matrix(1, 2) << -1.0, 1.0).finished());
    const auto contact = linear_contact(H, vec({k == 0 ? -1e-9 : -1.0}), NewtonImpactNSL(0.0), "");
    model.link(contact, *balls[k == 0 ? 0 : k - 1], k == 0 ? nullptr : balls[k].get());
  }
  const auto rows = rows_of_run(model, *make_scheme(GetParam()), dt, 0.02);
  for (std::size_t step = 1; step < rows.size(); ++step)
    for (int k = 0; k < n; ++k) expect_carried(rows[step], k, (n - k) * gravity, dt);
}

class RestByFriction : public Rest {};

TEST_P(RestByFriction, ABlockOnAnInclineSticksUpToTheFrictionAngle) {
  const double angle = 0.5, dt = 1e-3, weight = 2.0 * gravity;
  const auto scheme = make_scheme(GetParam());
  const auto sticking = rows_of_run(make_block(0.0, std::tan(angle) + 1e-6, angle), *scheme, dt, 0.2);
  for (std::size_t k = 1; k < sticking.size(); ++k) {
    EXPECT_NEAR(sticking[k].state.v.norm(), 0.0, 1e-14);
    expect_carried(sticking[k], 0, weight * std::cos(angle), dt);
    expect_carried(sticking[k], 1, -weight * std::sin(angle), dt);
  }
  // One millionth below, it starts to slide: v = g (sin - mu cos) t
  const double mu = std::tan(angle) - 1e-6;
  const State slid = run_to(make_block(0.0, mu, angle), *scheme, dt, 0.2);
  EXPECT_NEAR(slid.v[0], gravity * (std::sin(angle) - mu * std::cos(angle)) * 0.2, 1e-12);
  EXPECT_GT(slid.v[0], 1e-7);
}

INSTANTIATE_TEST_SUITE_P(Schemes, Rest, testing::ValuesIn(and_accurate_ones(scheme_names())),
                         [](const auto& test) { return test.param; });
INSTANTIATE_TEST_SUITE_P(Schemes, RestByFriction, testing::ValuesIn(and_accurate_ones(frictional_schemes())),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace saltus::test
