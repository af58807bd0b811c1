// Relations that depend on the time, in every scheme.
#include <gtest/gtest.h>

#include <cmath>

#include "saltus/kernel/model/check.hpp"
#include "saltus/kernel/model/distance.hpp"
#include "saltus/kernel/model/driven.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

constexpr double omega = 6.0, amplitude = 0.2, length = 0.8, angle = 0.6;

// A rod that is pulled in and let out
Motion rod(double t) {
  return {length + amplitude * std::sin(omega * t), amplitude * omega * std::cos(omega * t),
          -amplitude * omega * omega * std::sin(omega * t)};
}

State polar(double t, double phi, double rate) {
  const Motion l = rod(t);
  const double s = std::sin(phi), c = std::cos(phi);
  return {t, vec({l.position * s, -l.position * c}),
          vec({l.velocity * s + l.position * rate * c, -l.velocity * c + l.position * rate * s})};
}

NonSmoothDynamicalSystem make_pulled_pendulum() {
  const State start = polar(0.0, angle, 0.0);
  const auto bob = std::make_shared<LagrangianLinearTIDS>(
      start.q, start.v, 2.0 * Matrix::Identity(2, 2),
      LagrangianLinearTIDS::Terms{.external_force = vec({0.0, -2.0 * gravity})});
  NonSmoothDynamicalSystem model({bob});
  auto distance = std::make_shared<Distance>(Matrix::Identity(2, 2), Vec::Zero(2));
  model.link(std::make_shared<Interaction>(std::make_shared<Driven>(std::move(distance), rod),
                                           EqualityConditionNSL(1), "rod"),
             *bob);
  return model;
}

// φ̈ = −(2 l̇ φ̇ + g sin φ)/l
State exact_pulled_pendulum(double until) {
  const auto f = [](double t, const Vec& y) {
    const Motion l = rod(t);
    return vec({y[1], -(2.0 * l.velocity * y[1] + gravity * std::sin(y[0])) / l.position});
  };
  const Vec y = integrate_ode(f, vec({angle, 0.0}), until, 20000);
  return polar(until, y[0], y[1]);
}

class MovingGeometry : public testing::TestWithParam<std::string> {};

TEST_P(MovingGeometry, TheOrderIsThatOfAConstraintAtRest) {
  const double until = 0.5;
  const int order = scheme_properties(GetParam()).order_bilateral;
  std::vector<double> steps;
  for (int k : {1, 2, 4}) steps.push_back(until / (k * (order > 5 ? 5 : order > 3 ? 25 : 125)));
  const Orders orders = measure_orders(make_pulled_pendulum(), *make_scheme(GetParam()),
                                       exact_pulled_pendulum(until), until, steps);
  EXPECT_GE(std::min(orders.q, orders.v), order - 0.2);
}

// The rod's force is the only one that works beside the weight.
TEST_P(MovingGeometry, TheDriveDoesTheWork) {
  const auto model = make_pulled_pendulum();
  const std::vector<double> steps = {2e-3, 1e-3};
  const Layout layout(model);
  std::vector<double> missing;
  for (double dt : steps) {
    TimeStepping simulation(model, *make_scheme(GetParam()), dt);
    const double before = simulation.report().kinetic_energy + potential_energy(layout, 0.0, model.q0());
    double work = 0.0, drive = 0.0;
    while (simulation.reaches(0.5)) {
      const StepReport& report = simulation.step();
      work += report.work_lambda + report.work_impulse;
      drive += std::abs(report.work_lambda + report.work_impulse);
    }
    EXPECT_GT(drive, 5.0);
    const double after =
        simulation.report().kinetic_energy + potential_energy(layout, 0.5, simulation.state().q);
    missing.push_back(std::abs(after - before - work));
  }
  EXPECT_LT(missing.back(), 0.05);
  EXPECT_LT(missing.back(), 0.6 * missing.front() + 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Schemes, MovingGeometry,
                         testing::ValuesIn(with_fixed_steps(and_accurate_ones(scheme_names()))),
                         [](const auto& test) { return test.param; });

TEST(MovingGeometryOf, MotionAndCurvatureAreThoseOfTheGap) {
  for (const CheckItem& item : check(make_pulled_pendulum()))
    EXPECT_TRUE(item.ok()) << item.quantity << " " << item.deviation;
}

}  // namespace
}  // namespace saltus::test
