// The event-driven reference against motions known in closed form, or by an independent integration.
#include <gtest/gtest.h>

#include <cmath>

#include "saltus/kernel/model/driven.hpp"
#include "slider_crank/slider_crank.hpp"
#include "support/body_models.hpp"
#include "support/runs.hpp"
#include "support/spatial_models.hpp"

namespace saltus::test {
namespace {

using Terms = LagrangianLinearTIDS::Terms;

std::unique_ptr<OneStepIntegrator> event_driven(double rtol = 1e-10, double velocity_tolerance = 0.0) {
  return make_integrator("EventDrivenOSI", {{"rtol", rtol}, {"velocity_tolerance", velocity_tolerance}});
}

void expect_near(const Vec& measured, const Vec& exact, double tolerance) {
  ASSERT_EQ(measured.size(), exact.size());
  EXPECT_LT((measured - exact).lpNorm<Eigen::Infinity>(), tolerance)
      << measured.transpose() << " expected " << exact.transpose();
}

// Height and velocity of a ball dropped from h, at t
Vec bouncing(double h, double e, double t) {
  double fall = std::sqrt(2.0 * h / gravity), speed = std::sqrt(2.0 * gravity * h);
  if (t < fall) return vec({h - 0.5 * gravity * t * t, -gravity * t});
  t -= fall;
  for (speed *= e; t > 2.0 * speed / gravity; speed *= e) t -= 2.0 * speed / gravity;
  return vec({speed * t - 0.5 * gravity * t * t, speed - gravity * t});
}

TEST(EventDriven, ABouncingBallAtEveryTimeBeforeItsBouncesAccumulate) {
  for (double dt : {0.1, 0.01, 1e-3})
    for (const Row& row : rows_of_run(make_ball(1.0, 0.0, 0.8), *event_driven(), dt, 3.5)) {
      const Vec exact = bouncing(1.0, 0.8, row.state.t);
      EXPECT_NEAR(row.state.q[0], exact[0], 1e-9) << row.state.t;
      EXPECT_NEAR(row.state.v[0], exact[1], 1e-9) << row.state.t;
    }
}

TEST(EventDriven, BouncesThatAccumulateAreRefusedByName) {
  TimeStepping simulation(make_ball(1.0, 0.0, 0.5), *event_driven(), 1e-2);
  const double rest = std::sqrt(2.0 / gravity) * 3.0;  // t1 (1 + e) / (1 - e)
  try {
    simulation.run(2.0);
    FAIL();
  } catch (const SimulationError& error) {
    EXPECT_EQ(error.report().status, StepStatus::accumulation);
    EXPECT_NE(std::string(error.what()).find("'floor'"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("velocity_tolerance"), std::string::npos);
    EXPECT_NEAR(error.time(), rest, 1e-2);
  }
}

TEST(EventDriven, BouncesThatAccumulateAreRefusedWhateverTheStep) {
  for (double dt : {1e-3, 1e-4, 1e-5}) {
    TimeStepping simulation(make_ball(1.0, 0.0, 0.5), *event_driven(), dt);
    const double rest = std::sqrt(2.0 / gravity) * 3.0;
    try {
      simulation.run(2.0);
      FAIL();
    } catch (const SimulationError& error) {
      EXPECT_EQ(error.report().status, StepStatus::accumulation);
      EXPECT_LT(error.report().event_steps, 80);  // few of them too low to be told apart
      EXPECT_NEAR(error.time(), rest, 1.1 * dt);
    }
  }
}

TEST(EventDriven, WithAVelocityToleranceABallRestsInTime) {
  const double rest = std::sqrt(2.0 / gravity) * 3.0, tolerance = 1e-4;
  double start = 0.0;
  int captures = 0;
  for (const Row& row : rows_of_run(make_ball(1.0, 0.0, 0.5), *event_driven(1e-10, tolerance), 1e-5, 1.5)) {
    captures += row.report.captures;
    if (row.state.v[0] != 0.0) start = row.state.t;
  }
  EXPECT_EQ(captures, 1);
  EXPECT_NEAR(start, rest, 4.0 * tolerance / gravity + 1e-5);  // what the bounces left out would take
}

TEST(EventDriven, APendulumInCartesianCoordinates) {
  const double until = 5.0;
  const State end = run_to(make_pendulum(), *event_driven(), 0.05, until), exact = exact_pendulum(until);
  expect_near(end.q, exact.q, 1e-9);
  expect_near(end.v, exact.v, 1e-8);
  EXPECT_NEAR(end.q.norm(), 0.8, 1e-14);
  EXPECT_NEAR(end.q.dot(end.v), 0.0, 1e-13);
}

TEST(EventDriven, ADryFrictionOscillatorLosesItsAmplitudeLinearlyAndStops) {
  const double mu = 0.1, k = 50.0, m = 2.0, x0 = 0.5, half = std::acos(-1.0) * std::sqrt(m / k);
  const double loss = 2.0 * mu * m * gravity / k;
  const auto scheme = event_driven();
  for (int n = 1; x0 - n * loss > -0.5 * loss; ++n) {
    const State turned = run_to(make_friction_oscillator(x0, mu, k), *scheme, half, n * half);
    const double amplitude = std::abs(x0 - (n - 1) * loss) > 0.5 * loss ? x0 - n * loss : x0 - (n - 1) * loss;
    EXPECT_NEAR(std::abs(turned.q[0]), std::abs(amplitude), 1e-9) << n;
    EXPECT_NEAR(turned.v[0], 0.0, 1e-8);
  }
  const auto rows = rows_of_run(make_friction_oscillator(x0, mu, k), *scheme, 1e-2, 8.0);
  EXPECT_EQ(rows.back().state.v[0], 0.0);
}

// On a belt: sticks until the spring overcomes friction, then slides, sticks again where ẋ is the belt's
struct Belt final : RheonomousRelation {
  explicit Belt(double speed) : RheonomousRelation(2), speed_(speed) {}
  void gap_at(double, const In& q, Out g) const override { g[0] = q[1]; }
  void jacobian_at(double, const In&, OutMatrix J) const override { J(0, 1) = J(1, 0) = 1.0; }
  void motion_at(double, const In&, Out w) const override { w[1] = -speed_; }
  double speed_;
};

TEST(EventDriven, ABlockOnABeltSticksAndSlips) {
  const double m = 2.0, k = 50.0, mu = 0.3, u = 0.4, omega = std::sqrt(k / m), xs = mu * m * gravity / k;
  auto block = std::make_shared<LagrangianLinearTIDS>(
      vec({0.0, 0.0}), vec({u, 0.0}), Matrix(m * Matrix::Identity(2, 2)),
      Terms{.stiffness = Matrix(vec({k, 0.0}).asDiagonal()), .external_force = vec({0.0, -m * gravity})});
  NonSmoothDynamicalSystem model({block});
  model.link(std::make_shared<Interaction>(std::make_shared<Belt>(u),
                                           NewtonImpactFrictionNSL(0.0, 0.0, mu, 2), "belt"),
             *block);
  // With one coefficient x goes on as a harmonic about xs with |amplitude| = u/ω and never sticks again:
  // at x = xs it comes back at the belt's speed after a whole period.
  const double slip = xs / u;
  for (double t : {0.3, 0.9 * slip, slip + 0.2, slip + 0.9}) {
    const State state = run_to(model, *event_driven(), t, t);
    const double phase = omega * (t - slip);
    const double x = t < slip ? u * t : xs + u / omega * std::sin(phase);
    EXPECT_NEAR(state.q[0], x, 1e-9) << t;
    EXPECT_NEAR(state.v[0], t < slip ? u : u * std::cos(phase), 1e-9) << t;
  }
}

// The outside of a circle of radius r
struct Bump final : Relation {
  explicit Bump(double r) : Relation(1), r_(r) {}
  void gap(const In& q, Out g) const override { g[0] = q.norm() - r_; }
  void jacobian(const In& q, OutMatrix J) const override { J.row(0) = q.transpose() / q.norm(); }
  double r_;
};

TEST(EventDriven, ABallLeavesACircularBumpAtTwoThirds) {
  const double r = 0.5, angle = 0.1;
  auto ball = std::make_shared<LagrangianLinearTIDS>(vec({r * std::sin(angle), r * std::cos(angle)}),
                                                     vec({0.0, 0.0}), Matrix::Identity(2, 2),
                                                     Terms{.external_force = vec({0.0, -gravity})});
  NonSmoothDynamicalSystem model({ball});
  model.link(std::make_shared<Interaction>(std::make_shared<Bump>(r), NewtonImpactNSL(0.5), "bump"), *ball);
  double height = 0.0;
  TimeStepping simulation(model, *event_driven(), 0.02);
  while (simulation.step().closed == 1) height = simulation.state().q[1];
  EXPECT_GT(height, r * 2.0 / 3.0 * std::cos(angle));
  // From the free flight back to where it began: cos = 2/3 cos(angle), v² = g r cos
  const double c = 2.0 / 3.0 * std::cos(angle), s = std::sqrt(1.0 - c * c), v = std::sqrt(gravity * r * c);
  const Vec q = simulation.state().q, w = simulation.state().v;
  EXPECT_NEAR(w[0], v * c, 1e-9);
  const double time = (-v * s - w[1]) / gravity;
  EXPECT_NEAR(q[0], r * s + v * c * time, 1e-9);
  EXPECT_NEAR(q[1], r * c - v * s * time - 0.5 * gravity * time * time, 1e-9);
}

TEST(EventDriven, TwoBallsKeepMomentumAndRestitution) {
  const double e = 0.8;
  const State end = run_to(make_two_balls(1.0, 2.0, 1.0, -1.0, e), *event_driven(), 0.2, 0.2);
  const double v1 = (1.0 - 2.0 - 2.0 * e * 2.0) / 3.0, v2 = v1 + 2.0 * e;
  expect_near(end.v, vec({v1, v2}), 1e-12);
  expect_near(end.q, vec({0.05 + 0.15 * v1, 0.05 + 0.15 * v2}), 1e-12);
}

TEST(EventDriven, SlidingThatTurnsInSpace) {
  const Sledge sledge{.velocity = vec({1.0, 2.0}), .mu = 0.2, .incline = 0.3, .stiffness = vec({30.0, 10.0})};
  const State end = run_to(make_sledge(sledge), *event_driven(), 0.05, 0.3),
              exact = exact_sliding(sledge, 0.3);
  expect_near(end.q, exact.q, 1e-9);
  expect_near(end.v, exact.v, 1e-9);
}

TEST(EventDriven, ASlidingSphereRolls) {
  const double v0 = 1.0, mu = 0.2, roll = 2.0 * v0 / (7.0 * mu * gravity);
  const State end = run_to(make_sphere(vec({0.0, 0.0, 0.0}), vec({v0, 0.0, 0.0}), 0.0, mu), *event_driven(),
                           0.5, 2.0 * roll < 0.5 ? 0.5 : 1.0);
  const double x = v0 * roll - 0.5 * mu * gravity * roll * roll + 5.0 / 7.0 * v0 * (end.t - roll);
  EXPECT_NEAR(end.v[0], 5.0 / 7.0 * v0, 1e-12);
  EXPECT_NEAR(end.q[0], x, 1e-12);
}

TEST(EventDriven, TheSliderCrankIsTheSameForAllTolerances) {
  const auto model = examples::make_slider_crank(examples::Guidance::frictional);
  const State fine = run_to(model, *event_driven(1e-12, 1e-5), 1e-4, 0.1);
  for (double dt : {1e-4, 1e-3}) {
    const State coarse = run_to(model, *event_driven(1e-10, 1e-4), dt, 0.1);
    expect_near(coarse.q.head(2), fine.q.head(2), 1e-8);
  }
}

TEST(EventDriven, WorkIsTheChangeOfTheKineticEnergy) {
  const auto model = examples::make_slider_crank(examples::Guidance::frictional);
  const auto rows = rows_of_run(model, *event_driven(1e-10, 1e-5), 1e-4, 0.1);
  double before = 7.49554875;
  int events = 0, steps = 0;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const StepReport& report = rows[k].report;
    const double work = report.work_forces + report.work_lambda + report.work_impulse;
    if (k > 1) {
      EXPECT_NEAR(report.kinetic_energy - before, work, 1e-9) << k;
    }
    before = report.kinetic_energy;
    events += report.event_steps;
    steps += report.accepted_steps;
  }
  EXPECT_GT(events, 30);
  EXPECT_GT(steps, 1000);
}

TEST(EventDriven, TheMeanForceIsTheIntegralOfTheForce) {
  // A ball that is dropped: momentum m v = ∫λ dt + Λ − m g t over every step
  double before = 0.0;
  for (const Row& row : rows_of_run(make_ball(0.1, 0.0, 0.5), *event_driven(1e-10, 1e-5), 0.05, 1.0)) {
    if (row.state.t == 0.0) continue;
    const double force = 0.05 * (row.reactions.force[0] - 2.0 * gravity) + row.reactions.impulse[0];
    EXPECT_NEAR(2.0 * (row.state.v[0] - before), force, 1e-12) << row.state.t;
    before = row.state.v[0];
  }
}

TEST(EventDriven, AGapThatDipsBelowZeroWithinAStepIsMet) {
  // A body on a spring just reaches the wall at the end of its way and comes back: steps are much longer.
  for (double depth : {1e-3, 1e-6, 1e-8}) {
    auto body = std::make_shared<LagrangianLinearTIDS>(vec({1.0}), vec({0.0}), Matrix::Identity(1, 1),
                                                       Terms{.stiffness = Matrix::Identity(1, 1)});
    NonSmoothDynamicalSystem model({body});
    model.link(linear_contact(Matrix::Identity(1, 1), vec({1.0 - depth}), NewtonImpactNSL(1.0), "wall"),
               *body);
    const double wall = std::acos(-(1.0 - depth)), t = 4.0;  // elastic: it is thrown back at once
    const State end = run_to(model, *event_driven(), t, t);
    EXPECT_NEAR(end.q[0], std::cos(2.0 * wall - t), 1e-9) << depth;
  }
}

TEST(EventDriven, ABlockIsPushedUntilItSlips) {
  // A spring that is drawn at constant speed: static friction holds until k u t = μ m g
  const double m = 2.0, k = 50.0, mu = 0.3, u = 0.4, stuck = mu * m * gravity / (k * u),
               omega = std::sqrt(k / m);
  auto block = std::make_shared<LagrangianLinearTIDS>(
      vec({0.0, 0.0, 0.0}), vec({0.0, 0.0, u}), Matrix(m * Matrix::Identity(3, 3)),
      Terms{.stiffness = (Matrix(3, 3) << k, 0, -k, 0, 0, 0, 0, 0, 0).finished(),
            .external_force = vec({0.0, -m * gravity, 0.0})});
  NonSmoothDynamicalSystem model({block});
  const Matrix H = (Matrix(2, 3) << 0.0, 1.0, 0.0, 1.0, 0.0, 0.0).finished();
  model.link(linear_contact(H, Vec::Zero(2), NewtonImpactFrictionNSL(0.0, 0.0, mu, 2), "plane"), *block);
  EXPECT_EQ(run_to(model, *event_driven(), 0.9 * stuck, 0.9 * stuck).v[0], 0.0);
  const double t = 0.3, end = stuck + t;
  const State slid = run_to(model, *event_driven(), end, end);
  EXPECT_NEAR(slid.v[0], u * (1.0 - std::cos(omega * t)), 1e-9);
  EXPECT_NEAR(slid.q[0], u * (t - std::sin(omega * t) / omega), 1e-9);
}

TEST(EventDriven, OptionsOutOfRangeAreRefused) {
  expect_refusal([] { event_driven(1e-14); }, {"rtol", "1e-14"});
  expect_refusal([] { event_driven(1.0); }, {"rtol", "1"});
  expect_refusal([] { event_driven(1e-10, -1.0); }, {"velocity_tolerance", "-1"});
}

TEST(EventDriven, BodiesWithQuaternions) {
  const State top = run_to(make_top(), *event_driven(), 0.05, 0.5), exact = exact_top(0.5);
  expect_near(top.q, exact.q, 1e-9);
  expect_near(top.v, exact.v, 1e-8);
  const State skid = run_to(make_skidding_body(0.2), *event_driven(), 0.05, 0.2);
  const State skidded = exact_skidding_body(0.2, 0.2);
  expect_near(skid.q, skidded.q, 1e-9);
  expect_near(skid.v, skidded.v, 1e-8);
}

TEST(EventDriven, AgreesWithTheErrorControlledSchemeOnTheSliderCrank) {
  // Two codes that share neither the way to events nor the integration between them; q0 = 0.
  const auto model = examples::make_slider_crank(examples::Guidance::frictional);
  const auto event = make_integrator("EventDrivenOSI", {{"rtol", 1e-12}, {"velocity_tolerance", 1e-5}});
  const auto adaptive = make_integrator("AdaptiveHalfExplicitOSI", {{"rtol", 1e-11}, {"atol", 1e-11}});
  TimeStepping one(model, *event, 1e-3), two(model, *adaptive, 1e-3);
  for (int k = 0; k < 100; ++k) {
    one.step();
    two.step();
    EXPECT_LT((one.state().q - two.state().q).head(2).cwiseAbs().maxCoeff(), 1e-9) << one.state().t;
  }
}

}  // namespace
}  // namespace saltus::test
