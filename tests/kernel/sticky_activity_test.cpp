// Persistent contact that starts at g = 0: remembered activity and stabilised positions, every tableau.
#include <gtest/gtest.h>

#include <cmath>

#include "saltus/kernel/assembly/configuration.hpp"
#include "saltus/numerics/solvers/registry.hpp"
#include "slider_crank/slider_crank.hpp"
#include "support/half_explicit_family.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

const std::vector<std::string> remembering = {"sticky", "stabilised"};

class Sticky : public testing::TestWithParam<std::string> {};

// Steps that are neither in rounding nor before the asymptotic range
std::vector<double> steps_for(int order, double until, int of_high_order) {
  const int first = order > 3 ? of_high_order : 40;
  return {until / first, until / (2 * first), until / (4 * first), until / (8 * first)};
}

TEST_P(Sticky, SlidingFromGapZeroKeepsTheOrderWithoutASingleImpact) {
  const double until = 0.25;
  const int order = family_order(GetParam()).constrained;
  for (const std::string& activity : remembering)
    for (double mu : {0.0, 0.3}) {
      const auto scheme = family(GetParam(), activity);
      const auto model = make_touching_bowl(mu, 0.5);
      const std::vector<double> dt = steps_for(order, until, 10);
      const Orders orders = measure_orders(model, *scheme, exact_touching_bowl(mu, until), until, dt);
      EXPECT_NEAR(orders.q, order, 0.2) << activity;
      EXPECT_NEAR(orders.v, order, 0.2) << activity;
      for (double h : dt)
        for (const Row& row : rows_of_run(model, *scheme, h, until)) {
          EXPECT_FALSE(row.report.impulsive) << activity << " " << row.state.t;
          if (activity == "stabilised") {
            EXPECT_LE(0.8 - row.state.q.norm(), 1e-15) << row.state.t;
          }
        }
    }
}

TEST_P(Sticky, SlidingFromAPenetrationKeepsTheOrderWithThePlainRuleAsWell) {
  const double until = 0.25, mu = 0.3;
  const int order = family_order(GetParam()).constrained;
  for (const char* activity : {"start", "sticky", "stabilised"}) {
    const Orders orders = measure_orders(make_bowl(mu), *family(GetParam(), activity), exact_bowl(mu, until),
                                         until, steps_for(order, until, 10));
    EXPECT_NEAR(orders.q, order, 0.2) << activity;
    EXPECT_NEAR(orders.v, order, 0.2) << activity;
  }
}

TEST_P(Sticky, OrdersOfBilateralConstraintsAndOfFlightStayWhatTheyAre) {
  const double until = 0.5;
  const TableauOrder order = family_order(GetParam());
  for (const std::string& activity : remembering) {
    const auto scheme = family(GetParam(), activity);
    const Orders rod = measure_orders(make_pendulum(), *scheme, exact_pendulum(until), until,
                                      steps_for(order.constrained, until, 20));
    EXPECT_NEAR(rod.q, order.constrained, 0.2) << activity;
    EXPECT_NEAR(rod.v, order.constrained, 0.2) << activity;
    const Orders flight = measure_orders(make_double_pendulum(), *scheme, exact_double_pendulum(until), until,
                                         steps_for(order.free, until, 20));
    EXPECT_NEAR(flight.q, order.free, 0.2) << activity;
    EXPECT_NEAR(flight.v, order.free, 0.2) << activity;
  }
}

TEST_P(Sticky, ABilateralConstraintStaysClosed) {
  const double dt = 1e-3;
  const int steps = GetParam() == "third-order" ? 1'000'000 : 100'000;
  TimeStepping simulation(make_pendulum(), *family(GetParam(), "stabilised"), dt);
  double gap = 0.0, velocity = 0.0;
  for (int k = 0; k < steps; ++k) {
    simulation.step();
    const Vec& q = simulation.state().q;
    gap = std::max(gap, std::abs(q.norm() - 0.8));
    velocity = std::max(velocity, std::abs(q.dot(simulation.state().v)));
  }
  EXPECT_LT(gap, 1e-12);
  EXPECT_LT(velocity, 1e-11);  // positions are pulled before the last multiplier is sought
}

TEST_P(Sticky, AContactLeavesWhenItsForceEndsAndAnotherImpactFollows) {
  // Ball on a floor that a constant force lifts off at once, then gravity brings it back.
  for (const std::string& activity : remembering) {
    const auto rows = rows_of_run(make_ball(0.0, 2.0, 0.5), *family(GetParam(), activity), 1e-3, 0.6);
    int impacts = 0;
    for (const Row& row : rows) {
      impacts += row.report.impulsive;
      EXPECT_EQ(row.reactions.lambda_plus[0], 0.0) << activity << " " << row.state.t;
    }
    EXPECT_EQ(impacts, 1) << activity;
    EXPECT_NEAR(rows.back().state.v[0], 1.0 - gravity * (0.6 - 4.0 / gravity), 2e-2) << activity;
  }
}

TEST_P(Sticky, AnAccumulationOfBouncesIsCaptured) {
  // The ball is at rest after t1 (1 + ε)/(1 − ε), t1 = √(2 h0/g); then the floor carries it.
  const double restitution = 0.5, height = 0.05, dt = 1e-3;
  const double rest = std::sqrt(2.0 * height / gravity) * (1.0 + restitution) / (1.0 - restitution);
  for (const std::string& activity : remembering) {
    const auto rows =
        rows_of_run(make_ball(height, 0.0, restitution), *family(GetParam(), activity), dt, rest + 0.05);
    const Row& last = rows.back();
    EXPECT_NEAR(last.reactions.lambda_minus[0], 2.0 * gravity, 1e-9) << activity;
    EXPECT_NEAR(last.state.v[0], 0.0, 1e-14) << activity;
    EXPECT_NEAR(last.state.q[0], 0.0, gravity * dt * dt * 10.0) << activity;
    if (activity == "stabilised") {
      EXPECT_LE(last.state.q[0], 0.0);
    }
  }
}

TEST_P(Sticky, TheFrictionalCrankImpactsNoMoreThanWithThePlainRule) {
  const double dt = 1e-4, until = 0.1;
  const auto model = examples::make_slider_crank(examples::Guidance::frictional);
  int plain = 0;
  for (const Row& row : rows_of_run(model, *family(GetParam(), "start"), dt, until))
    plain += row.report.impulsive;
  const auto layout = std::make_shared<Layout>(model);
  Configuration view(layout);
  for (const std::string& activity : remembering) {
    int impacts = 0;
    std::vector<double> opened(4, 1.0);  // of each corner since it last carried a force
    Vec before = Vec::Ones(4);
    for (const Row& row : rows_of_run(model, *family(GetParam(), activity), dt, until)) {
      impacts += row.report.impulsive;
      view.move_to(row.state.q, row.state.t);
      for (int k = 0; k < 4; ++k) {
        const double gap = view.gaps()[k];
        if (row.report.impulsive && gap <= 0.0 && before[k] > 0.0) {
          EXPECT_GE(opened[k], 1e-6) << row.state.t;
        }
        opened[k] = row.reactions.lambda_minus[2 * k] > 0.0 ? 0.0 : std::max(opened[k], gap);
      }
      before = view.gaps();
    }
    EXPECT_LE(impacts, plain) << activity;
    EXPECT_GE(impacts, plain / 2) << activity;  // it does bounce
  }
}

INSTANTIATE_TEST_SUITE_P(Tableaux, Sticky, testing::ValuesIn(family_names()), family_test_name);

TEST(Hem5, AnUnloadedContactChangesNothing) {
  // A point on a spring along a wall that does not press it: λ is zero up to rounding in every stage.
  const double k = 30.0;
  const Vec t = vec({std::cos(0.3), std::sin(0.3)}), n = vec({-std::sin(0.3), std::cos(0.3)});
  const auto end = [&](bool wall, const char* activity) {
    const auto point = std::make_shared<LagrangianLinearTIDS>(
        0.3 * t - 1e-4 * n, t, Matrix::Identity(2, 2),
        LagrangianLinearTIDS::Terms{.stiffness = Matrix(k * t * t.transpose())});
    NonSmoothDynamicalSystem model({point});
    if (wall) model.link(linear_contact(n.transpose(), vec({0.0}), NewtonImpactNSL(0.0), "wall"), *point);
    return run_to(model, *family("HEM5", activity), 1.0 / 40, 1.0);
  };
  for (const char* activity : {"start", "sticky", "stabilised"}) {
    EXPECT_NEAR((end(true, activity).q - end(false, activity).q).norm(), 0.0, 1e-12) << activity;
    EXPECT_NEAR((end(true, activity).v - end(false, activity).v).norm(), 0.0, 1e-12) << activity;
  }
}

TEST(Sticky, AContactThatHasLostItsGroundIsNotHeld) {
  // A table that ends at x = 0.1: the gap jumps to 1 m.
  class Table final : public Relation {
   public:
    Table() : Relation(1) {}
    void gap(const In& q, Out g) const override { g[0] = q[0] < 0.1 ? q[1] : q[1] + 1.0; }
    void jacobian(const In&, OutMatrix J) const override { J << 0.0, 1.0; }
  };
  for (const std::string& tableau : family_names())
    for (const std::string& activity : remembering) {
      auto block = std::make_shared<LagrangianLinearTIDS>(
          vec({0.0, 0.0}), vec({1.0, 0.0}), Matrix::Identity(2, 2),
          LagrangianLinearTIDS::Terms{.external_force = vec({0.0, -gravity})});
      NonSmoothDynamicalSystem model({block});
      model.link(std::make_shared<Interaction>(std::make_shared<Table>(), NewtonImpactNSL(0.0)), *block);
      const State end = run_to(model, *family(tableau, activity), 1e-3, 0.3);
      EXPECT_NEAR(end.q[1], -0.5 * gravity * 0.2 * 0.2, 5e-3) << tableau << activity;
    }
}

TEST(Stabilization, BilateralConstraintsComeFirst) {
  // y = d as an equality and y >= 0 as a contact that carries the weight: both cannot be at g = 0.
  const double d = 1e-6;
  auto block = std::make_shared<LagrangianLinearTIDS>(
      vec({0.0, 0.0}), vec({1.0, 0.0}), Matrix::Identity(2, 2),
      LagrangianLinearTIDS::Terms{.external_force = vec({0.0, -gravity})});
  NonSmoothDynamicalSystem model({block});
  const Matrix up = (Matrix(1, 2) << 0.0, 1.0).finished();
  model.link(linear_contact(up, vec({-d}), EqualityConditionNSL(1), "equality"), *block);
  model.link(linear_contact(up, vec({0.0}), NewtonImpactNSL(0.3), "contact"), *block);
  EXPECT_NEAR(run_to(model, *family("third-order", "stabilised"), 1e-3, 0.1).q[1], d, 1e-15);
}

TEST(Stabilization, AProjectionChangesTheEnergyOfTheCrankByLessThanAMillionth) {
  // The same step with and without: what remains between them is the projection.
  const auto model = examples::make_slider_crank(examples::Guidance::equality);
  const auto layout = std::make_shared<Layout>(model);
  for (const std::string& tableau : family_names()) {
    const auto pulled = family(tableau, "stabilised"), plain = family(tableau, "sticky");
    const auto solver = make_contact_solver("auto"), other = make_contact_solver("auto");
    pulled->prepare(model, *solver);
    plain->prepare(model, *other);
    State state{0.0, model.q0(), model.v0()};
    Reactions reactions;
    reactions.set_zero(layout->rows);
    double change = 0.0, moved = 0.0;
    for (int k = 0; k < 1000; ++k) {
      State free = state;
      Reactions free_reactions = reactions;
      const StepReport a = pulled->step(1e-4, state, reactions);
      const StepReport b = plain->step(1e-4, free, free_reactions);
      const double energy = a.kinetic_energy + potential_energy(*layout, state.t, state.q);
      change = std::max(
          change, std::abs(b.kinetic_energy + potential_energy(*layout, free.t, free.q) - energy) / energy);
      moved = std::max(moved, (free.q - state.q).norm());
    }
    EXPECT_LT(change, 1e-6) << tableau;
    EXPECT_GT(moved, 0.0) << tableau;
  }
}

TEST(Stabilization, ConstraintsThatDependOnEachOtherAreClosedAsWell) {
  // The pendulum's rod three times
  auto model = make_pendulum();
  for (int k = 0; k < 2; ++k)
    model.link(std::make_shared<Interaction>(std::make_shared<Circle>(1, 0.8), EqualityConditionNSL(1)),
               *model.systems()[0]);
  const Vec expected = run_to(make_pendulum(), *family("third-order", "stabilised"), 1e-3, 0.5).q;
  EXPECT_NEAR((run_to(model, *family("third-order", "stabilised"), 1e-3, 0.5).q - expected).norm(), 0.0,
              1e-12);
}

TEST(Stabilization, APenetrationIsNotPulledOut) {
  const auto rows = rows_of_run(make_ball(-1e-4, 0.0, 0.5), *family("third-order", "stabilised"), 1e-3, 0.1);
  EXPECT_EQ(rows.back().state.q[0], -1e-4);
}

TEST(Stabilization, AnOpenBilateralConstraintIsPulledShutInTheFirstStep) {
  auto point =
      std::make_shared<LagrangianLinearTIDS>(vec({0.81, 0.0}), vec({0.0, 0.0}), 2.0 * Matrix::Identity(2, 2));
  NonSmoothDynamicalSystem model({point});
  model.link(std::make_shared<Interaction>(std::make_shared<Circle>(1, 0.8), EqualityConditionNSL(1)),
             *point);
  EXPECT_NEAR(run_to(model, *family("Heun", "stabilised"), 1e-3, 1e-3).q[0], 0.8, 1e-15);
}

TEST(Stabilization, ItTakesStickyActivityAndKeepsPredictedOut) {
  expect_refusal([] { HalfExplicit("mine", trapezoidal_tableau(), {.stabilized = true}); },
                 {"mine", "sticky"});
  for (const char* name : {"HalfExplicitTrapezoidalOSI", "HalfExplicitRungeKuttaOSI"}) {
    const auto make = [name](const Options& options) { return [=] { make_integrator(name, options); }; };
    expect_refusal(make({{"stabilization", "position"}, {"activity", "predicted"}}),
                   {name, "stabilization", "sticky", "predicted"});
    expect_refusal(make({{"impact", "keep-resting-forces"}, {"activity", "predicted"}}),
                   {name, "keep-resting-forces", "predicted"});
    expect_refusal(make({{"stabilization", "velocity"}}), {"stabilization", "none, position", "'velocity'"});
    expect_refusal(make({{"impact", "plastic"}}), {"impact", "paper, keep-resting-forces", "'plastic'"});
  }
}

}  // namespace
}  // namespace saltus::test
