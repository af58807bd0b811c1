// What happens in an impulsive step: the velocity before the impact, and taking the step again in parts.
#include <gtest/gtest.h>

#include <cmath>

#include "saltus/kernel/integrators/impact_refinement.hpp"
#include "support/half_explicit_family.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

class ImpactOptions : public testing::TestWithParam<std::string> {};

TEST_P(ImpactOptions, ABlockThatHitsAWallLeavesTheFloorOnlyWithThePapersRule) {
  const double dt = 1e-3, restitution = 0.8;
  const auto model = make_block_before_wall(dt, restitution);
  for (const char* activity : {"start", "sticky", "stabilised"})
    for (const bool keeps : {false, true}) {
      const auto scheme = family(GetParam(), activity, {{"impact", keeps ? "keep-resting-forces" : "paper"}});
      TimeStepping simulation(model, *scheme, dt);
      while (!simulation.step().impulsive) ASSERT_LT(simulation.steps(), 20);
      const Vec& v = simulation.state().v;
      EXPECT_NEAR(v[0], restitution, 1e-14) << activity;  // the wall's law holds with either
      EXPECT_NEAR(v[1], keeps ? 0.0 : restitution * gravity * dt, 1e-14) << activity;  // (55): v⁻ = −g Δt
      const Reactions& reactions = simulation.reactions();
      EXPECT_NEAR(reactions.lambda_minus[1], keeps ? 2.0 * gravity : 0.0, 1e-9) << activity;
      EXPECT_NEAR(reactions.force[1], keeps ? 2.0 * gravity : 0.0, 1e-9) << activity;
      EXPECT_NEAR(reactions.impulse[0], 2.0 * (1.0 + restitution), 1e-13) << activity;
      double jump = -1.0;
      for (int k = 0; k < 10; ++k) {
        simulation.step();
        jump = std::max(jump, simulation.state().q[1]);
      }
      // Stabilised, the small jump may be caught and pulled back at once.
      if (keeps || std::string(activity) != "stabilised") {
        EXPECT_EQ(jump <= 0.0, keeps) << activity;
      }
    }
}

TEST_P(ImpactOptions, TheWorksOfAnImpulsiveStepWithForcesAddUp) {
  const auto scheme = family(GetParam(), "start", {{"impact", "keep-resting-forces"}});
  const auto rows = rows_of_run(make_block_before_wall(1e-3, 0.5), *scheme, 1e-3, 0.02);
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const StepReport& report = rows[k].report;
    EXPECT_NEAR(report.work_forces + report.work_lambda + report.work_impulse,
                report.kinetic_energy - rows[k - 1].report.kinetic_energy, 1e-13);
  }
}

INSTANTIATE_TEST_SUITE_P(Tableaux, ImpactOptions, testing::ValuesIn(family_names()), family_test_name);

TEST(ImpactRefinement, AnImpulsiveStepIsThatOfTheFinerStep) {
  // From the start of the impulsive step on, ten steps of Δt/10 give its end to the last bit.
  const double dt = 1e-3;
  const auto model = make_ball(0.05, 0.0, 0.5);
  TimeStepping refined(model, *family("third-order", "start", {{"impulsive_substeps", 10.0}}), dt);
  State before;
  while (!refined.report().impulsive) {
    before = refined.state();
    refined.step();
    ASSERT_LT(refined.steps(), 200);
  }
  const auto ball = std::make_shared<LagrangianLinearTIDS>(
      before.q, before.v, 2.0 * Matrix::Identity(1, 1),
      LagrangianLinearTIDS::Terms{.external_force = vec({-2.0 * gravity})});
  NonSmoothDynamicalSystem again({ball}, before.t);
  again.link(model.links()[0].interaction, *ball);
  const auto rows = rows_of_run(again, *family("third-order", "start"), dt / 10.0, before.t + dt);
  ASSERT_EQ(rows.size(), 11u);
  EXPECT_TRUE(same_bits(rows.back().state.q, refined.state().q));
  EXPECT_TRUE(same_bits(rows.back().state.v, refined.state().v));
  double impulse = 0.0, work = 0.0;
  for (const Row& row : rows) {
    impulse += row.reactions.impulse[0];
    work += row.report.work_impulse;
  }
  EXPECT_EQ(refined.reactions().impulse[0], impulse);
  EXPECT_EQ(refined.report().work_impulse, work);
  EXPECT_EQ(refined.state().t, before.t + dt);
}

TEST(ImpactRefinement, ForcesOfAnImpulsiveStepAreThoseOfItsParts) {
  // The block rests on the floor before and after the wall's impact: momentum needs the mean force.
  const double dt = 1e-3;
  const auto scheme =
      family("trapezoidal", "start", {{"impulsive_substeps", 10.0}, {"impact", "keep-resting-forces"}});
  for (const Row& row : rows_of_run(make_block_before_wall(dt, 0.5), *scheme, dt, 0.02)) {
    if (row.state.t == 0.0) continue;
    EXPECT_NEAR(row.reactions.lambda_plus[1], 2.0 * gravity, 1e-8);
    EXPECT_NEAR(row.reactions.lambda_minus[1], 2.0 * gravity, 1e-8);
    EXPECT_NEAR(row.reactions.force[1], 2.0 * gravity, 1e-8);
  }
}

TEST(ImpactRefinement, TheImpactIsMetTenTimesMoreExactly) {
  // A ball with ε = 0 falls on a floor: it stops at −γΔt at the deepest, in the mean over phases at half of
  // it.
  const auto depth = [](double parts) {
    double sum = 0.0;
    for (int k = 0; k < 50; ++k) {
      const auto model = make_ball(1e-2 + k * 2e-5, -1.0, 0.0);
      sum -= run_to(model, *family("trapezoidal", "start", {{"impulsive_substeps", parts}}), 1e-3, 0.02).q[0];
    }
    return sum / 50;
  };
  EXPECT_NEAR(depth(1.0) / depth(10.0), 10.0, 1.5);
}

TEST(ImpactRefinement, StepsWithoutImpactAreUntouched) {
  const auto model = make_pendulum();
  EXPECT_TRUE(same_bits(run_to(model, *family("RK4", "start"), 1e-3, 0.3).q,
                        run_to(model, *family("RK4", "start", {{"impulsive_substeps", 10.0}}), 1e-3, 0.3).q));
}

TEST(ImpactRefinement, AModelThatThrowsLeavesTheStepUntaken) {
  struct Ball final : LagrangianDS {
    Ball() : LagrangianDS(vec({0.01}), vec({0.0})) {}
    void mass(const In&, OutMatrix M) const override { M(0, 0) = 1.0; }
    void forces(double, const In&, const In&, Out h) const override {
      if (--left == 0) throw std::runtime_error("no force today");
      h[0] = -gravity;
    }
    mutable long left = 1'000'000;
  };
  const auto floor = linear_contact(Matrix::Identity(1, 1), vec({0.0}), NewtonImpactNSL(0.5), "floor");
  const auto scheme = family("Heun", "start", {{"impulsive_substeps", 10.0}});
  const auto ball = std::make_shared<Ball>(), clean = std::make_shared<Ball>();
  NonSmoothDynamicalSystem model({ball}), other({clean});
  model.link(floor, *ball);
  other.link(floor, *clean);
  TimeStepping simulation(model, *scheme, 1e-3), expected(other, *scheme, 1e-3);
  for (int k = 0; k < 45; ++k) simulation.step();
  ball->left = 8;  // within a part of the impulsive step
  const State before = simulation.state();
  EXPECT_THROW(simulation.step(), std::runtime_error);
  EXPECT_TRUE(same_bits(simulation.state().q, before.q));
  EXPECT_TRUE(same_bits(simulation.state().v, before.v));
  simulation.run(0.1);
  expected.run(0.1);
  EXPECT_TRUE(same_bits(simulation.state().q, expected.state().q));
}

TEST(ImpactRefinement, RefusesPartsThatAreNone) {
  for (double parts : {0.0, -1.0, 2.5, 1e9})
    expect_refusal([=] { family("Heun", "start", {{"impulsive_substeps", parts}}); },
                   {"impulsive_substeps", "whole number"});
  expect_refusal([] { ImpactRefinement(family("Heun", "start"), 1); }, {"at least 2 parts", "got 1"});
}

}  // namespace
}  // namespace saltus::test
