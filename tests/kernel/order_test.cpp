// Measured orders of every scheme against what its row in the registry claims.
#include <gtest/gtest.h>

#include <cmath>

#include "slider_crank/slider_crank.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

class Order : public testing::TestWithParam<std::string> {
 protected:
  SchemeProperties properties() const { return scheme_properties(GetParam()); }
  // Four steps, those of high orders so large that rounding does not show
  static std::vector<double> steps(double until, int order, int coarsest) {
    const int first = order > 3 ? 20 : coarsest;
    return {until / first, until / (2 * first), until / (4 * first), until / (order > 3 ? 6 : 8) / first};
  }
  void expect(const Orders& measured, int claimed) const {
    EXPECT_GE(measured.q, claimed - 0.2) << GetParam();
    EXPECT_GE(measured.v, claimed - 0.2) << GetParam();
    // A claim that is too small hides what the scheme can do.
    EXPECT_LE(std::min(measured.q, measured.v), claimed + 0.5) << GetParam();
  }
};

TEST_P(Order, FreeFlight) {
  const double until = 0.5;
  const int order = properties().order_free;
  expect(measure_orders(make_double_pendulum(), *make_scheme(GetParam()), exact_double_pendulum(until), until,
                        steps(until, order, 500)),
         order);
}

TEST_P(Order, BilateralConstraint) {
  const double until = 0.5;
  const int order = properties().order_bilateral;
  expect(measure_orders(make_pendulum(), *make_scheme(GetParam()), exact_pendulum(until), until,
                        steps(until, order, 250)),
         order);
}

class OrderOfFriction : public Order {};

TEST_P(OrderOfFriction, Sliding) {
  const double until = 0.25, mu = 0.3;
  const auto model = make_bowl(mu);
  const auto scheme = make_scheme(GetParam());
  const int order = properties().order_sliding;
  const std::vector<double> dt = steps(until, order, 250);
  expect(measure_orders(model, *scheme, exact_bowl(mu, until), until, dt), order);
  // The contact must have been closed and sliding throughout, else another motion was measured.
  for (const Row& row : rows_of_run(model, *scheme, dt.front(), until))
    EXPECT_EQ(row.report.closed, 1) << row.state.t;
}

TEST_P(Order, BilateralConstraintDriftsNoFasterThanTheOrder) {
  // Velocity level keeps Wᵀv to rounding and the position drifts; acceleration level keeps g̈ and both drift.
  const int order = properties().order_bilateral;
  const std::vector<double> dt = order > 3 ? std::vector{0.05, 0.025, 0.0125} : std::vector{2e-3, 1e-3, 5e-4};
  std::vector<double> gap, velocity;
  for (double h : dt) {
    const State end = run_to(make_pendulum(), *make_scheme(GetParam()), h, 0.5);
    gap.push_back(std::abs(end.q.norm() - 0.8));
    velocity.push_back(std::abs(end.q.dot(end.v)) / end.q.norm());
  }
  if (gap.front() > 1e-13) {  // else it is stabilised
    EXPECT_GE(slope(dt, gap), order - 0.2);
  }
  if (keeps_velocity_constraints(GetParam())) {
    for (double drift : velocity) EXPECT_LT(drift, 1e-12);
  } else {
    EXPECT_GT(velocity.back(), 1e-9);  // it does drift
    EXPECT_GE(slope(dt, velocity), order - 0.2);
  }
}

INSTANTIATE_TEST_SUITE_P(Schemes, Order, testing::ValuesIn(with_fixed_steps(scheme_names())),
                         [](const auto& test) { return test.param; });
INSTANTIATE_TEST_SUITE_P(Schemes, OrderOfFriction, testing::ValuesIn(with_fixed_steps(frictional_schemes())),
                         [](const auto& test) { return test.param; });

TEST(HalfExplicitOrder, ThePredictedActivityIsOfSecondOrderWithoutImpacts) {
  const auto scheme = make_integrator("HalfExplicitTrapezoidalOSI", {{"activity", "predicted"}});
  const Orders orders =
      measure_orders(make_bowl(0.3), *scheme, exact_bowl(0.3, 0.25), 0.25, {1e-3, 5e-4, 2.5e-4, 1.25e-4});
  EXPECT_GE(orders.q, 1.8);
  EXPECT_GE(orders.v, 1.8);
}

TEST(HalfExplicitOrder, SliderCrankWithEqualityConstraintsPointwise) {
  // Errors at t_k = k ms against a much smaller step; the largest over all t_k.
  const auto model = examples::make_slider_crank(examples::Guidance::equality);
  const auto scheme = make_integrator("HalfExplicitTrapezoidalOSI");
  const double until = 0.02;
  const auto samples = [&](double dt) {
    std::vector<Vec> q;
    TimeStepping simulation(model, *scheme, dt);
    for (int k = 1; k <= 20; ++k) {
      simulation.run(k * until / 20);
      q.push_back(simulation.state().q);
    }
    return q;
  };
  const std::vector<Vec> reference = samples(1e-6);
  std::vector<double> errors;
  const std::vector<double> dt = {1e-4, 5e-5, 2.5e-5};
  for (double h : dt) {
    const std::vector<Vec> q = samples(h);
    errors.push_back(0.0);
    for (std::size_t k = 0; k < q.size(); ++k)
      errors.back() = std::max(errors.back(), (q[k] - reference[k]).norm());
  }
  EXPECT_GE(slope(dt, errors), 1.9);
}

TEST(HalfExplicitOrder, TheMeanOfBothLimitsOfAForceIsOfSecondOrder) {
  // λ⁺ and λ⁻ are each of first order in their mean's time, t + Δt/2; the mean is of second.
  std::vector<double> single, mean;
  const std::vector<double> dt = {4e-3, 2e-3, 1e-3};
  for (double h : dt) {
    const Row last =
        rows_of_run(make_pendulum(), *make_integrator("HalfExplicitTrapezoidalOSI"), h, 0.4).back();
    const double tension = pendulum_tension(last.state.t - 0.5 * h);
    single.push_back(std::abs(last.reactions.lambda_plus[0] - tension));
    mean.push_back(
        std::abs(0.5 * (last.reactions.lambda_plus[0] + last.reactions.lambda_minus[0]) - tension));
  }
  EXPECT_NEAR(slope(dt, single), 1.0, 0.2);
  EXPECT_NEAR(slope(dt, mean), 2.0, 0.2);
}

}  // namespace
}  // namespace saltus::test
