// Figures of whole comparisons against what is known: Table 3, closed forms, and every refusal.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "saltus/compare.hpp"
#include "slider_crank/slider_crank.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

const char* const half_explicit = "HalfExplicitTrapezoidalOSI";
const char* const moreau_jean = "ExplicitMoreauJeanOSI";

CompareSettings settings_for(std::vector<double> time_steps, double until) {
  return {.integrators = {candidate(half_explicit)},
          .time_steps = std::move(time_steps),
          .until = until,
          .timings = 0};
}

TEST(Compare, TableThreeOfThePaper) {
  const auto model = examples::make_slider_crank(examples::Guidance::frictional);
  auto settings = settings_for({1e-4}, 0.1);
  settings.baseline = candidate(moreau_jean);
  settings.reference = ReferenceRun{candidate(half_explicit), 1e-7};
  const Comparison result = compare(model, settings);
  ASSERT_EQ(result.rows.size(), 2u);
  EXPECT_TRUE(result.rows[0].baseline);
  EXPECT_NEAR(result.rows[0].figures.spectral, 0.1526, 5e-5);   // printed: 0.15
  EXPECT_NEAR(result.rows[1].figures.spectral, 0.01747, 5e-6);  // printed: 0.018
  EXPECT_EQ(result.rows[1].figures.common_times, 1000);
  EXPECT_EQ(result.rows[1].impulsive_steps, 20);
  EXPECT_TRUE(result.ok());
  EXPECT_TRUE(result.warnings.empty()) << result.warnings.front();
}

TEST(Compare, OrdersAgainstAnExactMotion) {
  auto settings = settings_for({4e-3, 2e-3, 1e-3}, 0.5);
  settings.baseline = candidate(moreau_jean);
  settings.limits.min_order = 1.9;
  const Comparison result = compare(make_double_pendulum(), settings);
  EXPECT_NEAR(result.orders[0].second, 1.0, 0.1);
  EXPECT_NEAR(result.orders[1].second, 2.0, 0.05);
  EXPECT_TRUE(result.ok());  // the baseline keeps no limits
  EXPECT_TRUE(std::isnan(result.rows[0].order));
  EXPECT_NEAR(result.rows[1].order, 1.0, 0.1);
  EXPECT_EQ(result.rows.back().figures.impacts, 0);
  EXPECT_EQ(result.rows.back().figures.impulse_error, 0.0);
}

TEST(Compare, ARecordedRunIsAReference) {
  const auto model = make_ball(1.0, 0.0, 0.5);
  const auto recording = std::make_shared<Recording>();
  TimeStepping simulation(model, *make_integrator(half_explicit), 1e-3);
  simulation.add_observer(recording);
  simulation.run(1.0);
  auto settings = settings_for({1e-3}, 1.0);
  settings.reference = RecordedReference{"before", 1e-3, recording};
  const Comparison same = compare(model, settings);
  EXPECT_EQ(same.rows[0].figures.error_q, 0.0);
  EXPECT_EQ(same.rows[0].figures.error_v, 0.0);
  EXPECT_EQ(same.rows[0].figures.impulse_error, 0.0);
  EXPECT_LT(same.rows[0].figures.energy_drift, 1e-13);
  EXPECT_EQ(same.rows[0].figures.impacts, 2);
  ASSERT_EQ(same.warnings.size(), 1u);
  EXPECT_NE(same.warnings[0].find("not clearly finer"), std::string::npos);
  expect_refusal([&] { compare(make_two_balls(1.0, 1.0, 1.0, 0.0, 0.5), settings); },
                 {"recorded reference", "2 coordinates, got 1"});
}

TEST(Compare, FreeFallIsExactBetweenTheStepsOfTheReference) {
  // Parabolas are exact under the half-explicit scheme, and the cubic between two states is as well.
  auto settings = settings_for({7e-3}, 0.4);
  settings.reference = ReferenceRun{candidate(half_explicit), 3e-3};
  settings.limits.min_order.reset();
  const Figures figures = compare(make_ball(1.0, 0.0, 0.5), settings).rows[0].figures;
  EXPECT_EQ(figures.common_times, 57);
  EXPECT_LT(figures.error_q, 1e-13);
  EXPECT_LT(figures.error_v, 1e-13);
}

TEST(Compare, LimitsAreNamed) {
  auto settings = settings_for({1e-3}, 1.0);
  settings.baseline = candidate(moreau_jean);
  settings.timings = 1;
  settings.limits = {.max_error = 1e-9,
                     .max_energy_drift = 1e-15,
                     .max_impulse_error = 1e-9,
                     .max_penetration = 1e-9,
                     .max_slowdown = 1e-9};
  const Comparison result = compare(make_ball(1.0, 0.0, 0.5), settings);
  std::vector<std::string> names;
  for (const Breach& breach : result.breaches) {
    EXPECT_EQ(breach.integrator, half_explicit);
    names.push_back(breach.limit);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"max-error", "max-energy-drift", "max-impulse-error",
                                             "max-penetration", "max-slowdown"}));
  EXPECT_FALSE(result.ok());
  const std::string text = to_text(result);
  for (const std::string& name : names) EXPECT_NE(text.find(name), std::string::npos) << name;
}

TEST(Compare, MisuseIsRefused) {
  const auto model = make_ball(1.0, 0.0, 0.5);
  const auto refused = [&](const std::function<void(CompareSettings&)>& change,
                           const std::vector<std::string>& words) {
    CompareSettings settings = settings_for({1e-3}, 1.0);
    change(settings);
    expect_refusal([&] { compare(model, settings); }, words);
  };
  refused([](auto& s) { s.integrators.clear(); }, {"an integrator, got none"});
  refused([](auto& s) { s.integrators.push_back(candidate(half_explicit)); }, {"must differ", "twice"});
  refused([](auto& s) { s.integrators[0].scheme = nullptr; }, {"is missing"});
  refused([](auto& s) { s.time_steps.clear(); }, {"a time step, got none"});
  refused([](auto& s) { s.time_steps = {-1.0}; }, {"time step", "got -1"});
  refused([](auto& s) { s.until = 1e-4; }, {"until", "got 0.0001"});
  refused([](auto& s) { s.until = std::numeric_limits<double>::infinity(); }, {"until", "inf"});
  refused([](auto& s) { s.limits.max_error = -1.0; }, {"max-error", "got -1"});
  refused([](auto& s) { s.limits.max_slowdown = 2.0; }, {"max-slowdown needs a baseline"});
  refused([](auto& s) { s.limits.min_order = 1.0; }, {"at least two time steps, got 1"});
  refused([](auto& s) { s.reference = ReferenceRun{candidate("MoreauJeanOSI"), 0.0}; },
          {"reference", "got 0"});
  refused([](auto& s) { s.reference = RecordedReference{"x", 1e-3, std::make_shared<Recording>()}; },
          {"no rows"});
  EXPECT_THROW(candidate("NoSuchOSI"), std::invalid_argument);
}

TEST(Comparison, TheEnergyOfSpringsBelongsToTheBalance) {
  // Two masses on a spring, as a force element and as a stiffness matrix: the same motion, the same drift.
  const double k = 400.0;
  const auto mass = [](double x) {
    return std::make_shared<LagrangianLinearTIDS>(vec({x}), vec({0.0}), Matrix::Identity(1, 1));
  };
  const auto left = mass(0.0), right = mass(1.5);
  NonSmoothDynamicalSystem elements({left, right});
  const Matrix apart = (Matrix(1, 2) << -1.0, 1.0).finished();
  elements.add_force(
      std::make_shared<ForceElement>(std::make_shared<LagrangianLinearTIR>(apart), SpringDamper(k, 0.0, 0.0)),
      *left, right.get());
  const Matrix K = k * apart.transpose() * apart;
  const NonSmoothDynamicalSystem whole(
      {std::make_shared<LagrangianLinearTIDS>(vec({0.0, 1.5}), vec({0.0, 0.0}), Matrix::Identity(2, 2),
                                              LagrangianLinearTIDS::Terms{.stiffness = K})});
  CompareSettings settings;
  settings.integrators = {candidate("HalfExplicitTrapezoidalOSI")};
  settings.time_steps = {1e-2};
  settings.until = 1.0;
  const double drift = compare(whole, settings).rows[0].figures.energy_drift;
  EXPECT_GT(drift, 1e-4);  // (ωΔt)² of it comes and goes
  EXPECT_NEAR(compare(elements, settings).rows[0].figures.energy_drift, drift, 1e-9 * drift);
}

}  // namespace
}  // namespace saltus::test
