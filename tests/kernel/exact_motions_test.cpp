// Motions with friction, constraints and springs whose solution is known in closed form.
#include <gtest/gtest.h>

#include <cmath>

#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

class ExactMotions : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<OneStepIntegrator> scheme_ = make_scheme(GetParam());
};

class FrictionalMotions : public ExactMotions {};

TEST_P(FrictionalMotions, ASlidingBlockStopsWhereCoulombSays) {
  const double v0 = 3.0, mu = 0.4, dt = 1e-4;
  const double time = v0 / (mu * gravity), distance = v0 * v0 / (2.0 * mu * gravity);
  for (double sign : {1.0, -1.0}) {
    const auto rows = rows_of_run(make_block(sign * v0, mu), *scheme_, dt, 1.2 * time);
    EXPECT_NEAR(rows.back().state.q[0], sign * distance, 2.0 * v0 * dt);
    double stop = 0.0;
    for (const Row& row : rows)
      if (std::abs(row.state.v[0]) > 1e-12) stop = row.state.t;
    EXPECT_NEAR(stop, time, 2.0 * dt);
    EXPECT_NEAR(rows.back().state.v[0], 0.0, 1e-13);
  }
}

TEST_P(FrictionalMotions, FrictionAcceleratesExactlyBesidesTheStop) {
  // Constant forces: v = v0 - mu g t to rounding, and the force at the limit of the cone.
  const double mu = 0.4, dt = 1e-3, weight = 2.0 * gravity;
  const auto rows = rows_of_run(make_block(3.0, mu), *scheme_, dt, 0.5);
  const bool forces = scheme_properties(GetParam()).forces_at_rest;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    EXPECT_NEAR(rows[k].state.v[0], 3.0 - mu * gravity * rows[k].state.t, 1e-12);
    const Reactions& r = rows[k].reactions;
    EXPECT_NEAR(forces ? r.lambda_plus[1] : r.impulse[1], -mu * weight * (forces ? 1.0 : dt), 1e-9);
  }
}

TEST_P(FrictionalMotions, AnOscillatorWithDryFrictionLosesTheSameInEveryHalfCycle) {
  // Turning points (-1)ⁿ (x0 - 2 n d), d = mu m g/k; it stops where |x| <= d.
  const double k = 50.0, mu = 0.1, m = 2.0, dt = 1e-4;
  const double d = mu * m * gravity / k, x0 = 8.5 * d, half_cycle = M_PI * std::sqrt(m / k);
  const auto rows = rows_of_run(make_friction_oscillator(x0, mu, k), *scheme_, dt, 5.0 * half_cycle);
  for (int n = 1; n <= 4; ++n) {
    const State& turn = rows[std::lround(n * half_cycle / dt)].state;
    EXPECT_NEAR(turn.q[0], (n % 2 ? -1.0 : 1.0) * (x0 - 2.0 * n * d), 0.02 * d) << "half cycle " << n;
  }
  // After four half cycles 0.5 d are left: inside the dead zone.
  EXPECT_NEAR(rows.back().state.q[0], 0.5 * d, 0.02 * d);
  EXPECT_NEAR(rows.back().state.v[0], 0.0, 1e-13);
}

TEST_P(FrictionalMotions, ASlidingSphereStartsToRoll) {
  // t = 2 v0/(7 mu g), then v = 5 v0/7 and the contact point rests.
  const double v0 = 2.0, mu = 0.3, dt = 1e-4, r = 0.1;
  const double start = 2.0 * v0 / (7.0 * mu * gravity);
  const auto rows = rows_of_run(make_sphere(vec({0.0, -1e-4, 0.0}), vec({v0, 0.0, 0.0}), 0.0, mu, r),
                                *scheme_, dt, 2.0 * start);
  double last_sliding = 0.0;
  for (const Row& row : rows)
    if (std::abs(row.state.v[0] + r * row.state.v[2]) > 1e-10) last_sliding = row.state.t;
  EXPECT_NEAR(last_sliding, start, 2.0 * dt);
  EXPECT_NEAR(rows.back().state.v[0], 5.0 / 7.0 * v0, 1e-12);
}

TEST_P(ExactMotions, OneStepOfConstantForce) {
  // v is exact for every scheme; q is for those of order 2 and lacks ½ g Δt² for the explicit Euler.
  const double dt = 0.01;
  const State end = run_to(make_ball(1.0, 0.5, 0.0), *scheme_, dt, dt);
  EXPECT_NEAR(end.v[0], 0.5 - gravity * dt, 1e-15);
  const double fall = scheme_properties(GetParam()).order_free >= 2 ? 0.5 * gravity * dt * dt : 0.0;
  EXPECT_NEAR(end.q[0], 1.0 + 0.5 * dt - fall, 1e-15);
}

TEST_P(ExactMotions, FreeSystemsHaveNoReactions) {
  const auto rows = rows_of_run(make_ball(1.0, 0.0, 0.5), *scheme_, 1e-3, 0.1);
  for (const Row& row : rows) {
    EXPECT_EQ(row.report.closed, 0);
    EXPECT_EQ(row.report.impulsive, false);
    EXPECT_EQ(row.report.penetration, 0.0);
    EXPECT_EQ(row.reactions.lambda_plus[0], 0.0);
    EXPECT_EQ(row.reactions.lambda_minus[0], 0.0);
    EXPECT_EQ(row.reactions.impulse[0], 0.0);
  }
}

TEST_P(ExactMotions, TimeDependentForcesAreTakenAtTheStagesTimes) {
  // v̇ = 3 t²: the explicit Euler takes the left value, the trapezoidal rule both ends of each step; schemes
  // of higher order are exact.
  struct Driven final : LagrangianDS {
    Driven() : LagrangianDS(Vec::Zero(1), Vec::Zero(1)) {}
    void mass(const In&, OutMatrix M) const override { M(0, 0) = 1.0; }
    void forces(double t, const In&, const In&, Out h) const override { h[0] = 3.0 * t * t; }
  };
  const NonSmoothDynamicalSystem model({std::make_shared<Driven>()}, 1.0);
  const double dt = 0.1;
  double expected = 0.0;
  const int order = scheme_properties(GetParam()).order_free;
  for (int k = 0; k < 5; ++k) {
    const double left = 1.0 + k * dt, right = left + dt;
    expected += order > 2    ? right * right * right - left * left * left
                : order == 2 ? dt * 1.5 * (left * left + right * right)
                             : dt * 3.0 * left * left;
  }
  // What chooses its own steps has a tolerance of 1e-6.
  const double slack = scheme_properties(GetParam()).error_controlled ? 1e-6 * expected : 1e-13;
  EXPECT_NEAR(run_to(model, *scheme_, dt, 1.5).v[0], expected, slack);
}

INSTANTIATE_TEST_SUITE_P(Schemes, ExactMotions, testing::ValuesIn(and_accurate_ones(scheme_names())),
                         [](const auto& test) { return test.param; });
INSTANTIATE_TEST_SUITE_P(Schemes, FrictionalMotions,
                         testing::ValuesIn(and_accurate_ones(frictional_schemes())),
                         [](const auto& test) { return test.param; });

TEST(Stability, TheVelocityLevelSchemeIsStableUpToOmegaDtOfTwo) {
  const auto scheme = make_integrator("HalfExplicitTrapezoidalOSI");
  const auto amplitude = [&](double omega_dt) {
    const double dt = 1e-2;
    return run_to(make_oscillator(omega_dt / dt, 1.0, 0.0), *scheme, dt, 20.0).q.norm();
  };
  EXPECT_LT(amplitude(1.99), 20.0);
  EXPECT_GT(amplitude(2.01), 1e20);
}

}  // namespace
}  // namespace saltus::test
