// Impacts with a solution in closed form.
#include <gtest/gtest.h>

#include <cmath>

#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

class ExactImpacts : public testing::TestWithParam<std::string> {};
class FrictionalImpacts : public testing::TestWithParam<std::string> {};

TEST_P(ExactImpacts, ABouncingBallHitsAndComesToRestInTime) {
  // t1 = √(2h0/g), flight k lasts 2 εᵏ t1, rest at t1 (1+ε)/(1-ε). Every impact is late by up to a step.
  const double height = 1.0, e = 0.5, dt = 1e-4;
  const double t1 = std::sqrt(2.0 * height / gravity);
  const auto rows = rows_of_run(make_ball(height, 0.0, e), *make_scheme(GetParam()), dt, 2.0);
  std::vector<double> impacts;
  for (std::size_t k = 1; k < rows.size(); ++k)
    if (rows[k].state.v[0] > rows[k - 1].state.v[0]) impacts.push_back(rows[k].state.t);
  double expected = t1;
  for (int k = 0; k < 5; ++k) {
    ASSERT_GT(static_cast<int>(impacts.size()), k);
    EXPECT_NEAR(impacts[k], expected, 3.0 * (k + 1) * dt) << "impact " << k;
    expected += 2.0 * std::pow(e, k + 1) * t1;
  }
  const double rest = t1 * (1.0 + e) / (1.0 - e);
  for (const Row& row : rows) {
    if (row.state.t > rest + 0.02) {
      EXPECT_NEAR(row.state.v[0], 0.0, 2.0 * gravity * dt) << row.state.t;
    }
    EXPECT_LT(row.report.penetration, 1e-3);
  }
}

TEST_P(ExactImpacts, EqualBallsExchangeTheirVelocities) {
  const State end = run_to(make_two_balls(1.5, 1.5, 2.0, -1.0, 1.0), *make_scheme(GetParam()), 1e-3, 0.1);
  EXPECT_NEAR(end.v[0], -1.0, 1e-14);
  EXPECT_NEAR(end.v[1], 2.0, 1e-14);
}

TEST_P(ExactImpacts, UnequalBallsKeepMomentumAndObeyNewton) {
  const double m1 = 1.0, m2 = 3.0, v1 = 2.0, v2 = -1.0;
  for (double e : {0.0, 0.3, 1.0}) {
    const auto rows = rows_of_run(make_two_balls(m1, m2, v1, v2, e), *make_scheme(GetParam()), 1e-3, 0.1);
    const State& end = rows.back().state;
    EXPECT_NEAR(end.v[1] - end.v[0], -e * (v2 - v1), 1e-14);
    EXPECT_NEAR(m1 * end.v[0] + m2 * end.v[1], m1 * v1 + m2 * v2, 1e-14);
    double impulse = 0.0;
    for (const Row& row : rows) impulse += row.reactions.impulse.sum();
    EXPECT_NEAR(impulse, (1.0 + e) * (v1 - v2) * m1 * m2 / (m1 + m2), 1e-13);
  }
}

TEST_P(FrictionalImpacts, AnObliqueImpactSticksInsideTheFrictionCone) {
  // ε_T = 0: sticks iff (2/7)|u_T| <= μ (1+ε) |v_N|, otherwise slips with Λ_T = -μ Λ_N sign(u_T).
  const double e = 0.6, mu = 0.2, m = 2.0, r = 0.1, dt = 1e-5, v_N = -3.0;
  const double limit = 3.5 * mu * (1.0 + e) * 3.0;
  for (double u : {0.5 * limit, 0.98 * limit, 1.02 * limit, 3.0 * limit, -0.98 * limit, -1.02 * limit}) {
    TimeStepping simulation(make_sphere(vec({0.0, 1e-3, 0.0}), vec({u, v_N, 0.0}), e, mu, r),
                            *make_scheme(GetParam()), dt);
    while (simulation.reactions().impulse[0] == 0.0) {
      ASSERT_LT(simulation.steps(), 1000);
      simulation.step();
    }
    const Vec& v = simulation.state().v;
    const double normal = simulation.reactions().impulse[0], tangential = simulation.reactions().impulse[1];
    const bool sticks = std::abs(u) < limit;
    const double speed = gravity * simulation.state().t - v_N;  // of free fall, a little above 3 m/s
    EXPECT_NEAR(normal, m * (1.0 + e) * speed, 2.0 * m * gravity * dt);
    const double slipping = u - std::copysign(3.5 * mu * normal / m, u);
    EXPECT_NEAR(v[0] + r * v[2], sticks ? 0.0 : slipping, 1e-13);
    EXPECT_NEAR(tangential, sticks ? -2.0 / 7.0 * m * u : -std::copysign(mu * normal, u), 1e-12);
    EXPECT_NEAR(m * v[0], m * u + tangential, 1e-12);
    EXPECT_NEAR(0.4 * m * r * v[2], tangential, 1e-12);  // I φ̇ = r Λ_T
  }
}

TEST_P(FrictionalImpacts, TangentialRestitutionReversesASuperball) {
  // ε_T = 1 and much friction: the contact point's velocity changes its sign.
  auto sphere = std::make_shared<LagrangianLinearTIDS>(vec({0.0, 1e-3, 0.0}), vec({0.7, -3.0, 0.0}),
                                                       Matrix(vec({2.0, 2.0, 8e-3}).asDiagonal()));
  NonSmoothDynamicalSystem model({sphere});
  const Matrix H = (Matrix(2, 3) << 0.0, 1.0, 0.0, 1.0, 0.0, 0.1).finished();
  model.link(linear_contact(H, Vec::Zero(2), NewtonImpactFrictionNSL(1.0, 1.0, 10.0, 2), "floor"), *sphere);
  const State end = run_to(model, *make_scheme(GetParam()), 1e-4, 0.01);
  EXPECT_NEAR(end.v[0] + 0.1 * end.v[2], -0.7, 1e-13);
  EXPECT_NEAR(end.v[1], 3.0, 1e-13);
}

TEST_P(FrictionalImpacts, ARockingBlockLosesWhatHousnerSays) {
  // The right corner hits while the block turns about the left one, which is closed and lifts off:
  // ω⁺/ω⁻ = 1 - (3/2) sin²a, tan a = b/h. q = (x, y, φ), the geometry of the upright block.
  const double b = 0.3, h = 1.0, omega = -0.5;
  const double I = (b * b + h * h) / 3.0, sin2 = b * b / (b * b + h * h);
  auto block = std::make_shared<LagrangianLinearTIDS>(vec({0.0, h, 0.0}), vec({-h * omega, b * omega, omega}),
                                                      Matrix(vec({1.0, 1.0, I}).asDiagonal()));
  NonSmoothDynamicalSystem model({block});
  const NonSmoothLaw law = NewtonImpactFrictionNSL(0.0, 0.0, 10.0, 2);
  const Matrix left = (Matrix(2, 3) << 0.0, 1.0, -b, 1.0, 0.0, h).finished();
  const Matrix right = (Matrix(2, 3) << 0.0, 1.0, b, 1.0, 0.0, h).finished();
  model.link(linear_contact(left, vec({-h - 1e-4, 0.0}), law, "left"), *block);
  model.link(linear_contact(right, vec({-h + 1e-7, 0.0}), law, "right"), *block);
  TimeStepping simulation(model, *make_scheme(GetParam()), 1e-6);
  simulation.step();
  // One that the impact opens is no longer closed where a scheme remembers its contacts.
  EXPECT_EQ(simulation.report().closed, scheme_properties(GetParam()).error_controlled ? 1 : 2);
  EXPECT_NEAR(simulation.state().v[2] / omega, 1.0 - 1.5 * sin2, 1e-12);
  EXPECT_NEAR(simulation.reactions().impulse[0], 0.0, 1e-14);
  EXPECT_GT(simulation.reactions().impulse[2], 0.01);
}

INSTANTIATE_TEST_SUITE_P(Schemes, ExactImpacts, testing::ValuesIn(and_accurate_ones(scheme_names())),
                         [](const auto& test) { return test.param; });
INSTANTIATE_TEST_SUITE_P(Schemes, FrictionalImpacts,
                         testing::ValuesIn(and_accurate_ones(frictional_schemes())),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace saltus::test
