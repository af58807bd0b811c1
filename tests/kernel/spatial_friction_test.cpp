// Friction in space: motions known in closed form, the plane law as a special case, and the frame of the
// tangents, which means nothing.
#include <gtest/gtest.h>

#include <cmath>

#include "support/runs.hpp"
#include "support/spatial_models.hpp"

namespace saltus::test {
namespace {

class FrictionInSpace : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<OneStepIntegrator> scheme_ = make_scheme(GetParam());
  bool forces_at_rest_ = scheme_properties(GetParam()).forces_at_rest;

  // What keeps or slows a contact: a force where the scheme tells it apart, else an impulse over a step
  Vec force(const Row& row, double dt) const {
    return forces_at_rest_ ? row.reactions.lambda_plus : Vec(row.reactions.impulse / dt);
  }
};

TEST_P(FrictionInSpace, ASledgeStopsWhereCoulombSaysInAnyDirection) {
  const double v0 = 3.0, mu = 0.4, dt = 1e-4;
  const double time = v0 / (mu * gravity), distance = v0 * v0 / (2.0 * mu * gravity);
  for (double angle : {0.3, 2.0, -1.2}) {
    const Vec along = vec({std::cos(angle), std::sin(angle)});
    const auto rows = rows_of_run(make_sledge({.velocity = v0 * along, .mu = mu}), *scheme_, dt, 1.1 * time);
    EXPECT_LT((rows.back().state.q.head(2) - distance * along).norm(), 2.0 * v0 * dt);
    double stop = 0.0;
    for (const Row& row : rows) {
      if (row.state.v.head(2).norm() > 1e-12) stop = row.state.t;
      EXPECT_NEAR(row.state.q[0] * along[1], row.state.q[1] * along[0], 1e-12);  // straight
    }
    EXPECT_NEAR(stop, time, 2.0 * dt);
    EXPECT_LT(rows.back().state.v.norm(), 1e-13);
  }
}

TEST_P(FrictionInSpace, ASlidingSledgeLosesExactlyMuGAndIsPushedByTheConesEdge) {
  const double mu = 0.4, dt = 1e-3;
  const Vec along = vec({0.6, -0.8});
  const auto rows = rows_of_run(make_sledge({.velocity = 3.0 * along, .mu = mu}), *scheme_, dt, 0.5);
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const Vec expected = (3.0 - mu * gravity * rows[k].state.t) * along;
    EXPECT_LT((rows[k].state.v.head(2) - expected).norm(), 1e-12);
    const Vec f = force(rows[k], dt);
    EXPECT_NEAR(f[0], 2.0 * gravity, 1e-9);
    EXPECT_LT((f.tail(2) + mu * f[0] * along).norm(), 1e-9);
  }
}

TEST_P(FrictionInSpace, MotionAlongOneAxisIsThatOfThePlaneLaw) {
  const double dt = 1e-3;
  const auto plane = rows_of_run(make_block(2.0, 0.3, 0.1), *scheme_, dt, 1.5);
  const auto space =
      rows_of_run(make_sledge({.velocity = vec({2.0, 0.0}), .mu = 0.3, .incline = 0.1}), *scheme_, dt, 1.5);
  ASSERT_EQ(plane.size(), space.size());
  for (std::size_t k = 0; k < plane.size(); ++k) {
    EXPECT_NEAR(space[k].state.q[0], plane[k].state.q[0], 1e-13);
    EXPECT_NEAR(space[k].state.q[2], plane[k].state.q[1], 1e-13);
    EXPECT_NEAR(space[k].state.v[0], plane[k].state.v[0], 1e-13);
    EXPECT_EQ(space[k].state.q[1], 0.0);
    const Vec f = force(space[k], dt), g = force(plane[k], dt);
    EXPECT_NEAR(f[0], g[0], 1e-9);
    EXPECT_NEAR(f[1], g[1], 1e-9);
    EXPECT_EQ(f[2], 0.0);
  }
}

TEST_P(FrictionInSpace, TurningTheTangentsChangesNothing) {
  const double dt = 1e-3, angle = 0.7;
  Sledge sledge{.position = vec({0.3, 0.0}),
                .velocity = vec({1.0, 2.0}),
                .mu = 0.3,
                .stiffness = vec({20.0, 60.0}),
                .height = 0.05,
                .restitution = 0.4,
                .tangential = 0.2};
  const auto rows = rows_of_run(make_sledge(sledge), *scheme_, dt, 1.5);
  sledge.turned = angle;
  const auto turned = rows_of_run(make_sledge(sledge), *scheme_, dt, 1.5);
  const Matrix R =
      (Matrix(2, 2) << std::cos(angle), std::sin(angle), -std::sin(angle), std::cos(angle)).finished();
  int impacts = 0;
  // Rounding moves steps of one's own choice, to others of the same tolerance.
  const double same = scheme_properties(GetParam()).error_controlled ? 1e-9 : 1e-12;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    impacts += rows[k].report.impulsive;
    EXPECT_LT((turned[k].state.q - rows[k].state.q).norm(), same);
    EXPECT_LT((turned[k].state.v - rows[k].state.v).norm(), same);
    const Vec P = rows[k].reactions.impulse, Q = turned[k].reactions.impulse;
    EXPECT_NEAR(P[0], Q[0], same);
    EXPECT_LT((R * P.tail(2) - Q.tail(2)).norm(), same);
  }
  EXPECT_GT(impacts, 2);
}

TEST_P(FrictionInSpace, OnTheCriticalInclineSidewaysMotionTurnsDownhill) {
  // tan α = μ: speed and downhill velocity change by ∓g sin α (1 - cos ψ), so their sum stays v0; in the end
  // the block slides straight down with v0/2.
  const double incline = 0.4, v0 = 2.0;
  const Sledge sledge{.velocity = vec({0.0, v0}), .mu = std::tan(incline), .incline = incline};
  const auto sum = [](const State& s) { return s.v.head(2).norm() + s.v[0]; };
  std::vector<double> error;
  const std::vector<double> dt = {4e-3, 2e-3, 1e-3};
  for (double h : dt) error.push_back(std::abs(sum(run_to(make_sledge(sledge), *scheme_, h, 0.4)) - v0));
  EXPECT_LT(error.back(), 2e-3 * v0);
  if (error.back() > 1e-11 && !scheme_properties(GetParam()).error_controlled) {  // else rounding
    EXPECT_GE(slope(dt, error), 0.8);
  }
  const State end = run_to(make_sledge(sledge), *scheme_, 1e-3, 5.0);
  EXPECT_NEAR(end.v[0], 0.5 * v0, 1e-3 * v0);
  EXPECT_NEAR(end.v[1], 0.0, 1e-3 * v0);
}

// A sledge that springs pull off its line: it slides on a curve
const Sledge curved{
    .position = vec({0.3, 0.0}), .velocity = vec({1.0, 2.0}), .mu = 0.2, .stiffness = vec({20.0, 60.0})};

TEST_P(FrictionInSpace, TheOrderHoldsWhereTheDirectionOfSlidingTurns) {
  if (scheme_properties(GetParam()).error_controlled) GTEST_SKIP() << "its errors do not depend on dt";
  const double until = 0.25;
  const int claimed = scheme_properties(GetParam()).order_sliding;
  const std::vector<double> steps = claimed > 3 ? std::vector<double>{6.25e-3, 3.125e-3, 1.5625e-3}
                                                : std::vector<double>{2e-3, 1e-3, 5e-4, 2.5e-4};
  const Orders orders =
      measure_orders(make_sledge(curved), *scheme_, exact_sliding(curved, until), until, steps);
  EXPECT_GE(std::min(orders.q, orders.v), claimed - 0.2);
  EXPECT_LE(std::min(orders.q, orders.v), claimed + 0.5);
}

TEST_P(FrictionInSpace, ASphereWithSpinSlidesOnAParabolaAndThenRolls) {
  // The velocity u of the contact point keeps its direction and falls by 7/2 μ g: rolling starts at
  // t = 2 |u0|/(7 μ g), and v has lost 2/7 u0 then.
  const double mu = 0.3, r = sphere_radius, dt = 1e-4;
  const Vec v0 = vec({2.0, 0.0, 0.0, 12.0, -9.0, 4.0});
  const auto contact = [&](const Vec& v) { return vec({v[0] - r * v[4], v[1] + r * v[3]}); };
  const Vec u0 = contact(v0);
  const double start = 2.0 * u0.norm() / (7.0 * mu * gravity);
  const auto rows = rows_of_run(make_rolling_sphere(v0, mu), *scheme_, dt, 1.5 * start);
  double last_sliding = 0.0;
  for (const Row& row : rows) {
    const Vec u = contact(row.state.v);
    if (u.norm() > 1e-10) last_sliding = row.state.t;
    EXPECT_NEAR(u[0] * u0[1], u[1] * u0[0], 1e-11);
  }
  EXPECT_NEAR(last_sliding, start, 2.0 * dt);
  EXPECT_LT((rows.back().state.v.head(2) - (v0.head(2) - 2.0 / 7.0 * u0)).norm(), 1e-12);
  EXPECT_NEAR(rows.back().state.v[5], 4.0, 1e-12);  // nothing acts on the spin around the normal
}

TEST_P(FrictionInSpace, TangentialRestitutionReversesBothComponents) {
  // Inside the cone (57) gives γ_T⁺ = -ε_T γ_T⁻; at its edge friction only slows, along γ_T⁻.
  const double et = 0.3, dt = 1e-3;
  const Vec v_T = vec({0.5, -0.4});
  for (double mu : {2.0, 0.05}) {
    const Sledge sledge{
        .velocity = v_T, .mu = mu, .height = 0.01, .falling = 2.0, .restitution = 0.5, .tangential = et};
    const auto rows = rows_of_run(make_sledge(sledge), *scheme_, dt, 0.02);
    const Row& end = rows.back();  // one impact, then flight
    EXPECT_GT(end.state.v[2], 0.5);
    Vec impulse = Vec::Zero(3);
    for (const Row& row : rows) impulse += row.reactions.impulse;
    const Vec expected =
        mu > 1.0 ? Vec(-et * v_T) : Vec(v_T - mu * impulse[0] / 2.0 * v_T / v_T.norm());  // m = 2 kg
    EXPECT_LT((end.state.v.head(2) - expected).norm(), 1e-13) << mu;
  }
}

TEST_P(FrictionInSpace, ATableOnFourFeetStopsLikeAPoint) {
  // Which foot carries how much is not determined, where the table stops is.
  const double mu = 0.4, v0 = 2.0, dt = 1e-3;
  const double time = v0 / (mu * gravity), distance = v0 * v0 / (2.0 * mu * gravity);
  const Vec along = vec({0.8, 0.6});
  const State end = run_to(make_table(-1e-4, vec({v0 * along[0], v0 * along[1], 0, 0, 0, 0}), mu), *scheme_,
                           dt, 1.1 * time);
  EXPECT_LT((end.q.head(2) - distance * along).norm(), 2.0 * v0 * dt);
  EXPECT_LT(end.v.norm(), 1e-11);
  EXPECT_LT(end.q.tail(3).norm(), 1e-11);  // it has not turned
}

TEST_P(FrictionInSpace, ATurningTableIsStoppedByTheMomentOfItsFeet) {
  // Every foot slides across its radius R: ω falls by μ m g R/I.
  const double mu = 0.2, dt = 1e-3, rate = 8.0;
  const double slowing = mu * 2.0 * gravity * foot_radius / table_inertia;
  const auto rows = rows_of_run(make_table(-1e-4, vec({0, 0, 0, 0, 0, rate}), mu), *scheme_, dt, 2.2);
  // Within a step of its own a scheme knows v as well as q: to the tolerance over its length.
  const double slack = scheme_properties(GetParam()).error_controlled ? 2e-4 : 1e-9;
  for (const Row& row : rows) {
    EXPECT_NEAR(row.state.v[5], std::max(0.0, rate - slowing * row.state.t), slack + 1e-3 * dt);
    EXPECT_LT(row.state.v.head(5).norm(), slack);
  }
}

INSTANTIATE_TEST_SUITE_P(Schemes, FrictionInSpace, testing::ValuesIn(and_accurate_ones(frictional_schemes())),
                         [](const auto& test) { return test.param; });

TEST(HalfExplicitFriction, ForcesOfASlidingStepPointAgainstTheVelocityOfTheirStage) {
  // (62)-(68) in sliding on the plane, written out: λ⁺ acts against v_{i-1}, λ⁻ against v_{i-1,1}. With the
  // directions of (70) and (72), those of v_{i-1,1} and v_i⁻, the order is 1 where the direction turns.
  const double dt = 1e-2, g = gravity, m = 2.0;
  TimeStepping simulation(make_sledge(curved), *make_integrator("HalfExplicitTrapezoidalOSI"), dt);
  Vec q = curved.position, v = curved.velocity;
  const auto acceleration = [&](const Vec& at) { return Vec(-curved.stiffness.cwiseProduct(at) / m); };
  for (int k = 0; k < 22; ++k) {  // while it slides fast
    const Vec a0 = acceleration(q), free = v + dt * a0;
    const Vec slowing = -curved.mu * g * v / v.norm();  // λ_T⁺/m
    const Vec v1 = free + dt * slowing;
    q += 0.5 * dt * (v + v1);
    const Vec end = v + 0.5 * dt * (a0 + slowing + acceleration(q));
    v = end - 0.5 * dt * curved.mu * g * v1 / v1.norm();
    simulation.step();
    ASSERT_LT((simulation.state().q.head(2) - q).norm(), 1e-13) << k;
    ASSERT_LT((simulation.state().v.head(2) - v).norm(), 1e-13) << k;
  }
}

class SpatialLaws : public testing::TestWithParam<std::string> {};

TEST_P(SpatialLaws, WithoutFrictionTheContactGuidesAndDoesNotSlow) {
  const Sledge sledge{.velocity = vec({1.0, -2.0}), .height = 0.02, .restitution = 0.0};
  const State end = run_to(make_sledge(sledge), *make_scheme(GetParam()), 1e-3, 0.5);
  EXPECT_NEAR(end.v[0], 1.0, 1e-13);
  EXPECT_NEAR(end.v[1], -2.0, 1e-13);
  EXPECT_NEAR(end.v[2], 0.0, 1e-12);
  EXPECT_LT(std::abs(end.q[2]), 2e-3);
}

INSTANTIATE_TEST_SUITE_P(Schemes, SpatialLaws, testing::ValuesIn(and_accurate_ones(scheme_names())),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace saltus::test
