// Schemes that choose steps of their own: events, what lies between the ends of inner steps, tolerances that
// are met.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "saltus/kernel/integrators/adaptive/crossing.hpp"
#include "saltus/kernel/integrators/adaptive/inner_step.hpp"
#include "saltus/numerics/solvers/registry.hpp"
#include "slider_crank/slider_crank.hpp"
#include "support/body_models.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"
#include "support/spatial_models.hpp"

namespace saltus::test {
namespace {

constexpr double pi = 3.14159265358979323846;

// ---- Where a gap falls to zero

// The cubic c0 + c1 x + c2 x² + c3 x³ on [0, dt]
GapCurve cubic(double c0, double c1, double c2, double c3, double dt) {
  return {c0, c1, c0 + dt * (c1 + dt * (c2 + dt * c3)), c1 + dt * (2.0 * c2 + 3.0 * dt * c3), dt};
}

TEST(FirstFall, IsTheRootOfAFallingParabola) {
  const auto x = first_fall(cubic(1.0, 0.0, -0.5 * gravity, 0.0, 1.0), 0.0);
  ASSERT_TRUE(x);
  EXPECT_NEAR(*x, std::sqrt(2.0 / gravity), 1e-15);
}

TEST(FirstFall, SeesADipBetweenTwoOpenEnds) {
  const auto x = first_fall(cubic(0.06, -0.5, 1.0, 0.0, 0.5), 0.0);  // (x - 0.2)(x - 0.3)
  ASSERT_TRUE(x);
  EXPECT_NEAR(*x, 0.2, 1e-14);
  EXPECT_FALSE(first_fall(cubic(0.0626, -0.5, 1.0, 0.0, 0.5), 0.0));  // 1e-4 above
}

TEST(FirstFall, OfThreeRootsTheFirst) {
  const auto x = first_fall(cubic(0.06, -1.1, 6.0, -10.0, 1.0), 0.0);  // -10 (x-0.1)(x-0.2)(x-0.3)
  ASSERT_TRUE(x);
  EXPECT_NEAR(*x, 0.1, 1e-14);
}

TEST(FirstFall, OfAContactThatLeavesIsItsReturn) {
  const auto x = first_fall(cubic(0.0, 1.0, -2.0, 0.0, 1.0), 0.0);
  ASSERT_TRUE(x);
  EXPECT_NEAR(*x, 0.5, 1e-15);
  EXPECT_FALSE(first_fall(cubic(0.0, 1.0, -0.5, 0.0, 1.0), 0.0));
  const auto below = first_fall(cubic(-1e-17, 1.0, -2.0, 0.0, 1.0), -1e-17);  // rounding left it there
  ASSERT_TRUE(below);
  EXPECT_NEAR(*below, 0.5, 1e-15);
}

// ---- Between the ends of an inner step

TEST(InnerStep, IsExactForCubicsAndKeepsMeans) {
  const Layout layout(make_ball(1.0, 0.0, 0.5));
  InnerStep step;
  step.reserve(layout);
  const auto q = [](double t) { return 1.0 + 2.0 * t - 3.0 * t * t + 4.0 * t * t * t; };
  const auto v = [](double t) { return 2.0 - 6.0 * t + 12.0 * t * t; };
  step.t = 0.5;
  step.dt = 0.25;
  step.q0 = vec({q(0.5)});
  step.q1 = vec({q(0.75)});
  step.rate0 = step.v0 = vec({v(0.5)});
  step.rate1 = step.v1 = vec({v(0.75)});
  step.mean_v = (step.q1 - step.q0) / step.dt;
  for (const double t : {0.5, 0.55, 0.7, 0.75}) {
    Vec at_q, at_v;
    step.motion_at(t, at_q, at_v);
    EXPECT_NEAR(at_q[0], q(t), 1e-14);
    EXPECT_NEAR(at_v[0], v(t), 1e-13);
  }

  // λ = 8 t is known at a third and at the end; h·v = t², whose work is t³/3.
  step.place[0] = 1.0 / 3;
  step.lambda[0] = vec({8.0 * (0.5 + 0.25 / 3)});
  step.lambda[1] = vec({8.0 * 0.75});
  const double places[] = {0.0, 1.0 / 3, 1.0};
  for (int k = 0; k < 3; ++k) {
    step.power_place[k] = places[k];
    step.power_forces[k] = std::pow(0.5 + 0.25 * step.power_place[k], 2);
  }
  Vec lambda(1), sum = Vec::Zero(1);
  step.lambda_at(0.6, lambda);
  EXPECT_NEAR(lambda[0], 4.8, 1e-14);
  step.add_impulse(0.5, 0.6, sum);
  step.add_impulse(0.6, 0.75, sum);
  EXPECT_NEAR(sum[0], 4.0 * (0.75 * 0.75 - 0.25), 1e-14);
  EXPECT_NEAR(step.work_forces(0.55, 0.7), (std::pow(0.7, 3) - std::pow(0.55, 3)) / 3.0, 1e-15);
}

// ---- Tolerances

struct Motion {
  const char* name;
  NonSmoothDynamicalSystem model;
  State exact;
};

std::vector<Motion> motions() {
  const Sledge curved{
      .position = vec({0.3, 0.0}), .velocity = vec({1.0, 2.0}), .mu = 0.2, .stiffness = vec({20.0, 60.0})};
  return {{"double pendulum", make_double_pendulum(), exact_double_pendulum(0.5)},
          {"pendulum on a constraint", make_pendulum(), exact_pendulum(0.5)},
          {"sliding in a bowl", make_bowl(0.3), exact_bowl(0.3, 0.25)},
          {"sliding that turns", make_sledge(curved), exact_sliding(curved, 0.25)},
          {"body in space", make_tumbling_body(), exact_tumbling_body(0.5)},
          {"top on a joint", make_top(), exact_top(0.2)},
          {"skidding body", make_skidding_body(0.2), exact_skidding_body(0.2, 0.2)}};
}

std::unique_ptr<OneStepIntegrator> adaptive(double tolerance, const char* method = "third-order") {
  return make_integrator("AdaptiveHalfExplicitOSI",
                         {{"rtol", tolerance}, {"atol", tolerance}, {"method", method}});
}

class Tolerance : public testing::TestWithParam<const char*> {};

TEST_P(Tolerance, IsMetInSmoothMotion) {
  for (const Motion& motion : motions()) {
    std::vector<double> tolerances = {1e-5, 1e-7, 1e-9}, errors;
    for (const double tolerance : tolerances) {
      const State end =
          run_to(motion.model, *adaptive(tolerance, GetParam()), motion.exact.t / 4, motion.exact.t);
      errors.push_back(std::max((end.q - motion.exact.q).cwiseAbs().maxCoeff(),
                                (end.v - motion.exact.v).cwiseAbs().maxCoeff()));
      EXPECT_LE(errors.back(), 100.0 * tolerance) << motion.name;
    }
    EXPECT_GE(slope(tolerances, errors), 0.75) << motion.name;
  }
}

// The frictional slider crank, with its impacts
TEST_P(Tolerance, IsMetThroughImpactsAndFriction) {
  const auto model = examples::make_slider_crank(examples::Guidance::frictional);
  const auto angles = [&](double tolerance) {
    return Vec(run_to(model, *adaptive(tolerance, GetParam()), 1e-3, 0.1).q.head(2));
  };
  const Vec exact = angles(1e-11);
  std::vector<double> tolerances = {1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9}, errors;
  for (const double tolerance : tolerances) {
    errors.push_back((angles(tolerance) - exact).cwiseAbs().maxCoeff());
    EXPECT_LE(errors.back(), 100.0 * tolerance);
  }
  EXPECT_NEAR(slope(tolerances, errors), 0.95, 0.15);
}

TEST_P(Tolerance, DoesNotDependOnWhereTheMotionIsLookedAt) {
  const auto model = examples::make_slider_crank(examples::Guidance::frictional);
  const Vec often = run_to(model, *adaptive(1e-7, GetParam()), 1e-4, 0.05).q;
  const Vec seldom = run_to(model, *adaptive(1e-7, GetParam()), 5e-3, 0.05).q;
  EXPECT_LT((often - seldom).cwiseAbs().maxCoeff(), 1e-5);
  int steps[2] = {0, 0};
  for (const int k : {0, 1})
    for (const Row& row : rows_of_run(model, *adaptive(1e-7, GetParam()), k ? 5e-3 : 1e-4, 0.05))
      steps[k] += row.report.accepted_steps;
  EXPECT_NEAR(steps[0], steps[1], 0.1 * steps[0]);
}

TEST_P(Tolerance, WorksExplainTheKineticEnergyOfEveryRow) {
  const auto model = examples::make_slider_crank(examples::Guidance::frictional);
  const auto rows = rows_of_run(model, *adaptive(1e-9, GetParam()), 2e-4, 0.05);
  double before = TimeStepping(model, *adaptive(1e-9), 2e-4).report().kinetic_energy;
  for (const Row& row : rows) {
    EXPECT_NEAR(row.report.kinetic_energy - before,
                row.report.work_forces + row.report.work_lambda + row.report.work_impulse, 2e-5)
        << row.state.t;
    before = row.report.kinetic_energy;
  }
}

TEST_P(Tolerance, AnOscillatorWithDryFrictionStopsWhereItShould) {
  // Half cycle n ends at (-1)ⁿ (x0 - 2 n μmg/k); it stays where |x| <= μmg/k.
  const double x0 = 1.0, mu = 0.3, k = 50.0;
  const auto model = make_friction_oscillator(x0, mu, k);
  Matrix M = Matrix::Zero(2, 2);
  const auto& block = *model.systems()[0];
  block.mass(In(block.q0().data(), 2), {M.data(), 2, 2});
  const double m = M(0, 0), reach = mu * m * gravity / k, half = pi / std::sqrt(k / m);
  const int cycles = static_cast<int>(std::ceil((x0 / reach - 1.0) / 2.0));
  ASSERT_GT(cycles, 2);
  const double end = (cycles % 2 ? -1.0 : 1.0) * (x0 - 2.0 * cycles * reach);
  for (const double tolerance : {1e-5, 1e-7, 1e-9}) {
    const double dt = 1e-3;
    double moved = 0.0;
    for (const Row& row : rows_of_run(model, *adaptive(tolerance, GetParam()), dt, (cycles + 1) * half)) {
      if (std::abs(row.state.v[0]) > 1e-9) moved = row.state.t;
      if (row.state.t > cycles * half + dt) {
        EXPECT_NEAR(row.state.q[0], end, 100.0 * tolerance);
      }
    }
    EXPECT_NEAR(moved, cycles * half, 1.01 * dt);
  }
}

TEST_P(Tolerance, ABallComesToRestInTime) {
  const double height = 1.0, e = 0.5, rest = std::sqrt(2.0 * height / gravity) * (1.0 + e) / (1.0 - e);
  const double dt = 1e-3;
  const auto model = make_ball(height, 0.0, e);
  double moved = 0.0;
  int captures = 0, after = 0, impulses = 0;
  for (const Row& row : rows_of_run(model, *adaptive(1e-8, GetParam()), dt, 2.0)) {
    captures += row.report.captures;
    if (std::abs(row.state.v[0]) > 1e-12) moved = row.state.t;
    if (row.state.t > rest + dt) {
      after += row.report.accepted_steps;
      impulses += row.report.impulsive;
      EXPECT_EQ(row.state.q[0], 0.0);
      EXPECT_NEAR(row.reactions.force[0], 2.0 * gravity, 1e-9);
    }
  }
  // The state just before rest, at a look that is 1e-7 s early, and at one that is as late
  const auto at = [&](double t) {
    return run_to(model, *make_integrator("AdaptiveHalfExplicitOSI", {{"minimum_step", 1e-9}}), t, t);
  };
  EXPECT_GT(std::abs(at(rest - 1e-7).v[0]), 1e-8);
  EXPECT_NEAR(at(rest + 1e-7).v[0], 0.0, 1e-15);
  EXPECT_NEAR(moved, rest, dt);
  EXPECT_EQ(captures, 1);
  EXPECT_EQ(impulses, 0);
  EXPECT_LE(after, (2.0 - rest) / dt + 1.0);  // as long as they may be
}

INSTANTIATE_TEST_SUITE_P(Methods, Tolerance, testing::Values("third-order", "trapezoidal"),
                         [](const auto& test) {
                           return std::string(test.param) == "trapezoidal" ? "Trapezoidal" : "ThirdOrder";
                         });

// ---- The rest

TEST(Adaptive, AStateFromElsewhereBeginsANewRun) {
  const auto model = make_bowl(0.3);
  const auto solver = make_contact_solver("auto"), other = make_contact_solver("auto");
  const auto one = adaptive(1e-6), two = adaptive(1e-6);
  one->prepare(model, *solver);
  two->prepare(model, *other);
  State state{0.0, model.q0(), model.v0()}, second = state;
  Reactions reactions, forces;
  reactions.set_zero(2);
  forces.set_zero(2);
  for (int k = 0; k < 5; ++k) one->step(1e-3, state, reactions);
  state = second;
  reactions.set_zero(2);
  ASSERT_EQ(one->step(1e-3, state, reactions).status, StepStatus::ok);
  ASSERT_EQ(two->step(1e-3, second, forces).status, StepStatus::ok);
  EXPECT_TRUE(same_bits(state.q, second.q) && same_bits(state.v, second.v));
}

TEST(Adaptive, AnApproachingContactAtTheStartIsStruckByTheLaw) {
  TimeStepping simulation(make_ball(0.0, -1.0, 0.5), *adaptive(1e-8), 1e-3);
  simulation.step();
  EXPECT_TRUE(simulation.report().impulsive);
  EXPECT_NEAR(simulation.state().v[0], 0.5 - gravity * 1e-3, 1e-14);
  EXPECT_NEAR(simulation.reactions().impulse[0], 2.0 * 1.5, 1e-14);
}

TEST(Adaptive, ABlockThatRocksToRestDoesNotStall) {
  const double b = 0.1, h = 0.4, I = (b * b + h * h) / 3.0, tilt = 0.05;
  auto block = std::make_shared<LagrangianLinearTIDS>(
      vec({0.0, h + b * tilt, tilt}), Vec::Zero(3), Matrix(vec({1.0, 1.0, I}).asDiagonal()),
      LagrangianLinearTIDS::Terms{.external_force = vec({0.0, -gravity, 0.0})});
  NonSmoothDynamicalSystem model({block});
  const NonSmoothLaw law = NewtonImpactFrictionNSL(0.0, 0.0, 10.0, 2);
  for (const double side : {-1.0, 1.0})
    model.link(linear_contact((Matrix(2, 3) << 0.0, 1.0, side * b, 1.0, 0.0, h).finished(), vec({-h, 0.0}),
                              law, side < 0 ? "left" : "right"),
               *block);
  int steps = 0;
  for (const Row& row : rows_of_run(model, *adaptive(1e-6), 1e-3, 5.0)) steps += row.report.accepted_steps;
  EXPECT_LT(steps, 8000);
  EXPECT_LT(run_to(model, *adaptive(1e-6), 1e-3, 5.0).v.norm(), 1e-12);
}

TEST(Adaptive, RefusesTolerancesThatMakeNoSense) {
  const auto make = [](const char* option, double value) {
    return [=] { make_integrator("AdaptiveHalfExplicitOSI", {{option, value}}); };
  };
  for (const double value : {0.0, -1.0, 1.0, std::nan("")}) expect_refusal(make("rtol", value), {"rtol"});
  for (const char* option : {"atol", "minimum_step", "velocity_tolerance"})
    for (const double value : {-1.0, HUGE_VAL, std::nan("")})
      expect_refusal(make(option, value), {option, "not negative"});
}

}  // namespace
}  // namespace saltus::test
