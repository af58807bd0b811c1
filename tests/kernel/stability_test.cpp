// The warning of a Δt beyond the stability limit: limits in closed form.
#include "saltus/kernel/simulation/stability.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "saltus/kernel/simulation/modes.hpp"
#include "saltus/numerics/linear/largest_eigenvector.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

const double omega = 300.0;

std::optional<Instability> verdict(const OneStepIntegrator& scheme, double omega_dt, double zeta = 0.0) {
  return find_instability(make_oscillator(omega, 0.0, 0.0, 2.0 * zeta * omega), scheme, omega_dt / omega);
}

std::unique_ptr<OneStepIntegrator> theta_scheme(double theta) {
  return make_integrator("MoreauJeanOSI", {{"theta", theta}});
}

TEST(StabilityLimit, OfTheVelocityLevelIsTwo) {
  for (const char* name : {"HalfExplicitTrapezoidalOSI", "DMinusAccelerationOSI"}) {
    const auto scheme = make_integrator(name);
    EXPECT_FALSE(verdict(*scheme, 1.9999)) << name;
    for (double beyond : {2.0001, 2.5, 100.0}) {
      const auto found = verdict(*scheme, beyond);
      ASSERT_TRUE(found) << name;
      EXPECT_NEAR(found->largest_stable * omega, 2.0, 1e-6);
      EXPECT_NEAR(found->omega, omega, 1e-10);
      EXPECT_EQ(found->system, 0);
      EXPECT_EQ(found->time_step, beyond / omega);
      const double x = 1.0 - 0.5 * beyond * beyond;  // velocity Verlet: half of the trace
      const double radius = std::abs(x) + std::sqrt(x * x - 1.0);
      EXPECT_NEAR(std::log(found->growth), std::log(radius) * std::max(1.0, 2.0 * std::numbers::pi / beyond),
                  1e-6);
    }
  }
}

// |1 + (1−θ) z|² ≤ |1 − θ z|² for z = (−ζ ± i √(1−ζ²)) ωΔt: ωΔt ≤ 2ζ / (1−2θ)
TEST(StabilityLimit, OfTheThetaScheme) {
  for (double theta : {0.5, 0.7, 1.0})
    for (double zeta : {0.0, 0.3, 2.0}) EXPECT_FALSE(verdict(*theta_scheme(theta), 1e4, zeta)) << theta;
  for (double theta : {0.0, 0.2, 0.45}) {
    const auto undamped = verdict(*theta_scheme(theta), 1.0);
    ASSERT_TRUE(undamped) << theta;
    EXPECT_EQ(undamped->largest_stable, 0.0) << theta;
    for (double zeta : {0.01, 0.2}) {
      const double limit = 2.0 * zeta / (1.0 - 2.0 * theta);
      EXPECT_FALSE(verdict(*theta_scheme(theta), 0.99 * limit, zeta)) << theta;
      const auto found = verdict(*theta_scheme(theta), 1.5 * limit, zeta);
      ASSERT_TRUE(found) << theta << " " << zeta;
      EXPECT_NEAR(found->largest_stable * omega / limit, 1.0, 1e-4) << theta << " " << zeta;
    }
  }
}

TEST(StabilityLimit, OfExplicitMoreauJeanComesFromDampingAlone) {
  const auto scheme = make_integrator("ExplicitMoreauJeanOSI");
  const auto undamped = verdict(*scheme, 0.1);
  ASSERT_TRUE(undamped);
  EXPECT_EQ(undamped->largest_stable, 0.0);
  EXPECT_NEAR(undamped->growth, std::pow(1.01, std::numbers::pi / 0.1), 1e-9);  // |1 + iωΔt| a step
  EXPECT_FALSE(verdict(*scheme, 0.003));                                        // below 1 % in a period
  const auto damped = verdict(*scheme, 0.5, 0.1);
  ASSERT_TRUE(damped);
  EXPECT_NEAR(damped->largest_stable * omega, 0.2, 1e-4);
}

// Heun's method grows by (ωΔt)⁴/8 a step, HEM5 by (ωΔt)⁶/1800 and is damped beyond 1.35 up to 3.456: steps
// of practical size are let pass, and beyond them the harmless one is named, not one where rounding begins.
TEST(StabilityLimit, OfWeaklyUnstableSchemes) {
  const auto with = [](const char* tableau) {
    return make_integrator("HalfExplicitRungeKuttaOSI", {{"tableau", tableau}});
  };
  for (double harmless : {0.01, 0.1, 0.2}) EXPECT_FALSE(verdict(*with("Heun"), harmless));
  for (double harmless : {0.01, 0.1, 0.5, 1.0, 3.45}) EXPECT_FALSE(verdict(*with("HEM5"), harmless));
  const auto heun = verdict(*with("Heun"), 0.5), hem5 = verdict(*with("HEM5"), 3.5);
  ASSERT_TRUE(heun && hem5);
  EXPECT_NEAR(heun->growth, std::pow(1.0 + std::pow(0.5, 4) / 4.0, 2.0 * std::numbers::pi), 1e-9);
  for (const auto& found : {*heun, *hem5}) EXPECT_EQ(found.largest_stable, 0.0);
  const double x = heun->largest_harmless * omega;
  EXPECT_NEAR(0.5 * std::log1p(std::pow(x, 4) / 4.0) * 2.0 * std::numbers::pi / x, std::log1p(0.01), 1e-8);
  EXPECT_NEAR(hem5->largest_harmless * omega, 3.456, 2e-2);
  // Damping makes it a limit: RK methods of order 2 need ωΔt³/8 = ζ where ζ is small.
  const auto damped = verdict(*with("Heun"), 1.0, 1e-3);
  ASSERT_TRUE(damped);
  EXPECT_NEAR(damped->largest_stable * omega, 0.2, 0.01);
}

// Strong damping bounds Δt as well: for v̇ = −c v the trapezoidal rule with a forecast needs cΔt ≤ 2.
TEST(StabilityLimit, OfADamperWithoutASpring) {
  const auto scheme = make_integrator("HalfExplicitTrapezoidalOSI");
  const auto model = make_oscillator(0.0, 0.0, 0.0, 50.0);
  EXPECT_FALSE(find_instability(model, *scheme, 1.9999 / 50.0));
  const auto found = find_instability(model, *scheme, 2.1 / 50.0);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->omega, 0.0);
  EXPECT_NEAR(found->largest_stable * 50.0, 2.0, 1e-6);
  EXPECT_FALSE(find_instability(model, *theta_scheme(0.5), 1.0));
  // However strong: near the double eigenvalue 1 the digits must not cancel.
  const auto stiff = find_instability(make_oscillator(0.0, 0.0, 0.0, 1e8), *scheme, 1e-7);
  ASSERT_TRUE(stiff);
  EXPECT_NEAR(stiff->largest_stable * 1e8, 2.0, 1e-6);
}

// A chain of n masses between walls, ω_max = 2 √(k/m) sin(nπ / (2n+2)), of systems or as one.
NonSmoothDynamicalSystem chain(int n, bool systems) {
  const double k = 1e4, m = 0.25;
  if (!systems) {
    Matrix K = Matrix::Zero(n, n);
    K.diagonal().setConstant(2.0 * k);
    for (int i = 1; i < n; ++i) K(i, i - 1) = K(i - 1, i) = -k;
    return NonSmoothDynamicalSystem(
        {std::make_shared<LagrangianLinearTIDS>(Vec::Zero(n), Vec::Zero(n), m * Matrix::Identity(n, n),
                                                LagrangianLinearTIDS::Terms{.stiffness = K})});
  }
  NonSmoothDynamicalSystem::Systems all;
  for (int i = 0; i < n; ++i)
    all.push_back(std::make_shared<LagrangianLinearTIDS>(vec({0.0}), vec({0.0}), m * Matrix::Identity(1, 1)));
  NonSmoothDynamicalSystem model(all);
  auto add = [&](Matrix H, const LagrangianDS& first, const LagrangianDS* second) {
    model.add_force(std::make_shared<ForceElement>(std::make_shared<LagrangianLinearTIR>(H), SpringDamper(k)),
                    first, second);
  };
  const Matrix wall = Matrix::Ones(1, 1), between = (Matrix(1, 2) << -1.0, 1.0).finished();
  add(wall, *all.front(), nullptr);
  add(wall, *all.back(), nullptr);
  for (int i = 1; i < n; ++i) add(between, *all[i - 1], all[i].get());
  return model;
}

TEST(FastestModes, OfAChainInClosedForm) {
  for (int n : {1, 2, 20, 50, 300}) {
    const double exact = 400.0 * std::sin(n * std::numbers::pi / (2 * n + 2));
    for (bool systems : {true, false}) {
      const auto modes = fastest_modes(chain(n, systems));
      ASSERT_EQ(modes.size(), 1u);
      const double error = 1.0 - std::sqrt(modes[0].stiffness) / exact;
      EXPECT_NEAR(error, 0.0, n <= 64 ? 1e-12 : 2e-3) << n;  // above, Lanczos comes from below
      EXPECT_GE(error, -1e-12);
      EXPECT_EQ(modes[0].damping, 0.0);
    }
  }
}

TEST(FastestModes, NameTheSystemAndKeepToWhatIsLinear) {
  const auto slow = make_oscillator(3.0, 0.0, 0.0).systems()[0];
  const auto fast = make_oscillator(40.0, 0.0, 0.0, 0.5).systems()[0];
  const auto pendulum = make_double_pendulum().systems()[0];
  const NonSmoothDynamicalSystem model({slow, pendulum, fast});
  const auto modes = fastest_modes(model);
  ASSERT_EQ(modes.size(), 2u);
  for (const Mode& mode : modes) {
    EXPECT_EQ(mode.system, 2);
    EXPECT_NEAR(mode.stiffness, 1600.0, 1e-10);
    EXPECT_NEAR(mode.damping, 0.5, 1e-14);
  }
  EXPECT_TRUE(fastest_modes(make_double_pendulum()).empty());
  EXPECT_TRUE(fastest_modes(make_ball(1.0, 0.0, 0.5)).empty());
  EXPECT_TRUE(fastest_modes(make_oscillator(0.0, 0.0, 0.0)).empty());
  NonSmoothDynamicalSystem driven({slow});  // a force that may be anything
  driven.add_force(std::make_shared<ForceElement>(std::make_shared<LagrangianLinearTIR>(Matrix::Ones(1, 1)),
                                                  Actuator([](double, double, double) { return 0.0; })),
                   *slow);
  EXPECT_TRUE(fastest_modes(driven).empty());
}

TEST(StabilityMessage, NamesWhatIsWrongAndWhatWouldBeRight) {
  const auto scheme = make_integrator("HalfExplicitTrapezoidalOSI");
  const std::string text = verdict(*scheme, 3.0)->message(scheme->name());
  for (const char* word : {"time_step = 0.01 s", "HalfExplicitTrapezoidalOSI", "system 0",
                           "omega = 300 rad/s", "largest stable time_step is 0.00666667 s"})
    EXPECT_NE(text.find(word), std::string::npos) << word << " in: " << text;
  const auto euler = make_integrator("ExplicitMoreauJeanOSI");
  const std::string always = verdict(*euler, 3.0)->message(euler->name());
  for (const char* word :
       {"without more damping it grows at every small time_step", "up to 1.055", "1 % in a period"})
    EXPECT_NE(always.find(word), std::string::npos) << word << " in: " << always;
}

}  // namespace
}  // namespace saltus::test
