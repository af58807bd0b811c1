// First-order systems against closed solutions, the formulas of the scheme, and measured orders.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "saltus/kernel/first_order/first_order_time_stepping.hpp"
#include "saltus/numerics/solvers/registry.hpp"

namespace saltus::test {
namespace {

using Weights = EulerMoreau::Weights;
using DS = std::shared_ptr<const FirstOrderDS>;

Vec vec(std::initializer_list<double> values) {
  return Eigen::Map<const Vec>(values.begin(), static_cast<Eigen::Index>(values.size()));
}

Matrix matrix(std::initializer_list<std::initializer_list<double>> rows) { return Matrix(rows); }

FirstOrderTimeStepping simulate(const FirstOrderSystem& model, Weights weights, double dt) {
  return {model, weights, dt, *make_contact_solver("auto")};
}

DS linear(Vec x0, std::optional<Matrix> A, std::optional<Vec> b = {}, std::optional<Matrix> M = {}) {
  return std::make_shared<FirstOrderLinearTIDS>(
      std::move(x0), FirstOrderLinearDS::Terms{std::move(A), std::move(b), std::move(M)});
}

std::shared_ptr<FirstOrderLinearTIR> relation(Matrix C, Matrix B, std::optional<Matrix> D = {},
                                              std::optional<Vec> e = {}) {
  return std::make_shared<FirstOrderLinearTIR>(std::move(C), std::move(B),
                                               FirstOrderLinearR::Terms{std::move(D), std::move(e)});
}

// ẋ = f(t, x), f and its derivative as functions
class Given final : public FirstOrderDS {
 public:
  using F = std::function<double(double, double)>;
  Given(double x0, F f, F slope = {}) : FirstOrderDS(vec({x0})), f_(std::move(f)), slope_(std::move(slope)) {}
  void f(double t, const In& x, Out f) const override { f[0] = f_(t, x[0]); }
  bool jacobian(double t, const In& x, OutMatrix J) const override {
    if (slope_) J(0, 0) = slope_(t, x[0]);
    return static_cast<bool>(slope_);
  }

 private:
  F f_, slope_;
};

// A charged capacitor that discharges through an inductance and a diode: half a sine, then rest at the
// opposite voltage. x = (v, i), v̇ = i/C, i̇ = (λ − v)/L, 0 <= i, 0 <= λ.
struct DiodeCircuit {
  double capacitance = 0.5, inductance = 2.0;
  double omega() const { return 1.0 / std::sqrt(capacitance * inductance); }
  FirstOrderSystem model(double v0) const {
    const DS circuit = linear(vec({v0, 0.0}), matrix({{0.0, 1.0 / capacitance}, {-1.0 / inductance, 0.0}}));
    FirstOrderSystem system({circuit});
    system.link(relation(matrix({{0.0, 1.0}}), matrix({{0.0}, {1.0 / inductance}})), complementarity_laws(1),
                *circuit);
    return system;
  }
};

double half_sine_error(double theta, int steps, double fraction) {
  const DiodeCircuit circuit;
  const double T = fraction * std::numbers::pi / circuit.omega();
  auto simulation = simulate(circuit.model(-1.0), {theta}, T / steps);
  for (int k = 0; k < steps; ++k) simulation.step();
  const double phase = std::min(fraction, 1.0) * std::numbers::pi;
  const double v = -std::cos(phase);
  const double i = circuit.capacitance * circuit.omega() * (fraction < 1.0 ? std::sin(phase) : 0.0);
  return std::hypot(simulation.state().x[0] - v, simulation.state().x[1] - i);
}

double order(const std::function<double(int)>& error, int steps) {
  return std::log2(error(steps) / error(2 * steps));
}

TEST(FirstOrder, AConductingDiodeIsAnOscillationOfTheOrderOfTheta) {
  EXPECT_NEAR(order([](int n) { return half_sine_error(0.5, n, 0.8); }, 100), 2.0, 0.01);
  EXPECT_NEAR(order([](int n) { return half_sine_error(1.0, n, 0.8); }, 400), 1.0, 0.02);
  EXPECT_LT(half_sine_error(0.5, 1000, 0.8), 2e-6);
}

TEST(FirstOrder, BeyondTheBlockingTheOrderIsOne) {
  EXPECT_NEAR(order([](int n) { return half_sine_error(1.0, n, 1.5); }, 800), 1.0, 0.05);
  EXPECT_LT(half_sine_error(1.0, 3200, 1.5), 3e-3);
  EXPECT_LT(half_sine_error(0.5, 3200, 1.5), 1e-3);
}

TEST(FirstOrder, ABlockingDiodeHoldsTheVoltageToRounding) {
  auto simulation = simulate(DiodeCircuit().model(1.0), {0.5}, 0.01);
  simulation.run(10.0);
  EXPECT_NEAR(simulation.state().x[0], 1.0, 1e-13);
  EXPECT_EQ(simulation.state().x[1], 0.0);
  EXPECT_NEAR(simulation.state().lambda[0], 1.0, 1e-13);
}

// ẋ = 0.3 + λ, λ ∈ −sign(x): down with slope −0.7, then sliding on x = 0 with λ = −0.3
TEST(FirstOrder, ARelaySlidesWhereItsInputBalancesTheDrift) {
  const DS process = linear(vec({1.0}), {}, vec({0.3}));
  FirstOrderSystem model({process});
  model.link(relation(matrix({{1.0}}), matrix({{1.0}})), relay_laws(1), *process);
  auto simulation = simulate(model, {1.0}, 1e-2);
  for (int k = 1; k <= 300; ++k) {
    simulation.step();
    const double exact = std::max(0.0, 1.0 - 0.7 * simulation.state().t);
    ASSERT_NEAR(simulation.state().x[0], exact, 1e-14) << k;
    if (k <= 142) {
      ASSERT_EQ(simulation.state().lambda[0], -1.0) << k;
    } else if (k > 143) {
      ASSERT_NEAR(simulation.state().lambda[0], -0.3, 1e-13) << k;
    }
  }
}

TEST(FirstOrder, BoundsOfARelayAreItsInputs) {
  const DS process = linear(vec({5.0}), {});
  FirstOrderSystem model({process});
  model.link(relation(matrix({{1.0}}), matrix({{1.0}})), relay_laws(1, -0.25, 3.0), *process);
  auto simulation = simulate(model, {1.0}, 0.5);
  simulation.step();
  EXPECT_EQ(simulation.state().x[0], 5.0 - 0.5 * 0.25);
}

// M (x⁺ − x) = Δt (θ A x⁺ + (1−θ) A x + b) + Δt B (γ λ⁺ + (1−γ) λ), D != 0: solved by hand for one state
TEST(FirstOrder, TheWeightsAreThoseOfTheFormula) {
  const double M = 2.0, a = -1.5, b = 0.3, c = 1.5, d = 0.4, e = -0.2, B = 2.0, dt = 0.1, theta = 0.6;
  for (const double gamma : {1.0, 0.7}) {
    for (const bool in_relation : {false, true}) {
      const DS system = linear(vec({-1.0}), matrix({{a}}), vec({b}), matrix({{M}}));
      FirstOrderSystem model({system});
      model.link(relation(matrix({{c}}), matrix({{B}}), matrix({{d}}), vec({e})), complementarity_laws(1),
                 *system);
      auto simulation = simulate(model, {theta, gamma, in_relation}, dt);
      double x = -1.0, lambda = 0.0;
      const double of_r = in_relation ? 1.0 : gamma, of_x = in_relation ? gamma : 1.0;
      for (int k = 0; k < 20; ++k) {
        const double W = M - dt * theta * a;
        const double free = (M * x + dt * ((1.0 - theta) * a * x + b) + dt * (1.0 - of_r) * B * lambda) / W;
        const double gain = dt * of_r * B / W;
        const double q = c * (of_x * free + (1.0 - of_x) * x) + e;
        lambda = std::max(0.0, -q / (d + of_x * c * gain));
        x = free + gain * lambda;
        simulation.step();
        ASSERT_NEAR(simulation.state().x[0], x, 1e-14);
        ASSERT_NEAR(simulation.state().lambda[0], lambda, 1e-13);
        ASSERT_NEAR(simulation.state().y[0], c * x + d * lambda + e, 1e-14);
        ASSERT_NEAR(simulation.state().r[0], B * lambda, 1e-13);
        ASSERT_LE(simulation.report().residual, 1e-12);
      }
    }
  }
}

// ẋ = (v, −x) + b + (0, λ): around its centre the state turns by Δt, whatever Δt is.
TEST(FirstOrder, AZeroOrderHoldIsExactForTheInputOfTheStep) {
  const double dt = 0.3, c = std::cos(dt), s = std::sin(dt);
  for (const double scale : {1.0, 2.5}) {  // of M and everything else: the same motion
    const DS process = linear(vec({2.0, 0.0}), scale * matrix({{0.0, 1.0}, {-1.0, 0.0}}),
                              scale * vec({0.1, 0.2}), scale * Matrix::Identity(2, 2));
    FirstOrderSystem model({process});
    model.link(relation(matrix({{0.5, 1.0}}), scale * matrix({{0.0}, {1.0}})), relay_laws(1), *process);
    auto simulation = simulate(model, {0.0, 1.0, false, true}, dt);
    int switched = 0;
    for (int k = 0; k < 60; ++k) {
      const Vec before = simulation.state().x;
      const double lambda_before = simulation.state().lambda[0];
      simulation.step();
      const Vec& x = simulation.state().x;
      const double lambda = simulation.state().lambda[0], y = 0.5 * x[0] + x[1];
      const double centre = 0.2 + lambda, u = before[0] - centre, v = before[1] + 0.1;
      ASSERT_NEAR(x[0], centre + c * u + s * v, 1e-13) << k;
      ASSERT_NEAR(x[1], -0.1 - s * u + c * v, 1e-13) << k;
      ASSERT_NEAR(lambda, std::clamp(lambda - y, -1.0, 1.0), 1e-12) << k;
      switched += lambda != lambda_before;
    }
    EXPECT_GT(switched, 3);
  }
}

TEST(FirstOrder, AZeroOrderHoldTakesSingularAAndRefusesTheRest) {
  const DS integrator = linear(vec({1.0}), {}, vec({-0.5}));
  auto simulation = simulate(FirstOrderSystem({integrator}), {0.0, 1.0, false, true}, 0.25);
  simulation.step();
  EXPECT_NEAR(simulation.state().x[0], 0.875, 1e-15);
  const DS algebraic = linear(vec({1.0}), {}, {}, Matrix::Zero(1, 1));
  EXPECT_THROW(simulate(FirstOrderSystem({algebraic}), {0.0, 1.0, false, true}, 0.1), std::invalid_argument);
  const auto nonlinear = std::make_shared<Given>(1.0, [](double, double x) { return -x; });
  EXPECT_THROW(simulate(FirstOrderSystem({nonlinear}), {0.0, 1.0, false, true}, 0.1), std::invalid_argument);
  EXPECT_THROW(simulate(FirstOrderSystem({integrator}), {0.5, 1.0, false, true}, 0.1), std::invalid_argument);
}

// Two capacitors joined by a resistance and a diode: the charge stays, the difference decays or is kept.
TEST(FirstOrder, TwoSystemsExchangeWhatOneRelationLetsThrough) {
  const double C1 = 2.0, C2 = 3.0, R = 0.5;
  const double rate = (1.0 / C1 + 1.0 / C2) / R;
  for (const double sign : {1.0, -1.0}) {
    const DS first = linear(vec({sign}), {}), second = linear(vec({0.0}), {});
    FirstOrderSystem model({first, second}, 1.0);
    // λ the current from the first to the second, y = R λ − (v1 − v2)
    model.link(relation(matrix({{-1.0, 1.0}}), matrix({{-1.0 / C1}, {1.0 / C2}}), matrix({{R}})),
               complementarity_laws(1), *first, second.get(), "diode");
    const auto error = [&](int steps) {
      auto simulation = simulate(model, {0.5, 0.5}, 1.0 / steps);
      for (int k = 0; k < steps; ++k) simulation.step();
      const Vec& x = simulation.state().x;
      EXPECT_NEAR(C1 * x[0] + C2 * x[1], C1 * sign, 1e-13);
      return std::abs(x[0] - x[1] - (sign > 0.0 ? std::exp(-rate) : -1.0));
    };
    if (sign > 0.0)
      EXPECT_NEAR(order([&](int n) { return error(n); }, 400), 1.0, 0.05);  // λ = 0 at the start: half of it
    else
      EXPECT_EQ(error(10), 0.0);
  }
}

TEST(FirstOrder, NonlinearSystemsHaveTheOrderOfTheta) {
  const auto f = [](double, double x) { return x * (1.0 - x); };
  const auto slope = [](double, double x) { return 1.0 - 2.0 * x; };
  const auto error = [&](double theta, const Given::F& derivative, int steps) {
    auto simulation =
        simulate(FirstOrderSystem({std::make_shared<Given>(0.1, f, derivative)}), {theta}, 2.0 / steps);
    for (int k = 0; k < steps; ++k) simulation.step();
    return std::abs(simulation.state().x[0] - 1.0 / (1.0 + 9.0 * std::exp(-2.0)));
  };
  EXPECT_NEAR(order([&](int n) { return error(0.5, slope, n); }, 50), 2.0, 0.01);
  EXPECT_NEAR(order([&](int n) { return error(1.0, slope, n); }, 400), 1.0, 0.02);
  EXPECT_NEAR(order([&](int n) { return error(0.0, slope, n); }, 400), 1.0, 0.02);
  EXPECT_NEAR(error(0.5, slope, 50), error(0.5, {}, 50), 1e-12);  // differences end at the same root
}

TEST(FirstOrder, SourcesAreTakenAtBothEnds) {
  const auto error = [](int steps) {  // ẋ = −x + sin t from 0
    auto simulation = simulate(
        FirstOrderSystem({std::make_shared<Given>(0.0, [](double t, double x) { return std::sin(t) - x; })}),
        {0.5}, 3.0 / steps);
    for (int k = 0; k < steps; ++k) simulation.step();
    return std::abs(simulation.state().x[0] - 0.5 * (std::exp(-3.0) + std::sin(3.0) - std::cos(3.0)));
  };
  EXPECT_NEAR(order(error, 100), 2.0, 0.01);
}

// A node without capacitance: 0 = (u − v)/R − v/R has no state of its own, M is singular.
TEST(FirstOrder, MMayBeSingular) {
  const DS circuit =
      linear(vec({1.0, 0.5}), matrix({{-1.0, 1.0}, {1.0, -2.0}}), {}, matrix({{1.0, 0.0}, {0.0, 0.0}}));
  auto simulation = simulate(FirstOrderSystem({circuit}), {1.0}, 1e-3);
  simulation.run(1.0);
  EXPECT_NEAR(simulation.state().x[1], 0.5 * simulation.state().x[0], 1e-15);
  EXPECT_NEAR(simulation.state().x[0], std::pow(1.0 + 0.5e-3, -1000.0), 1e-13);  // ẋ = −x/2 by backward Euler
}

// A nonlinear relation: y = x³ + λ, r = λ (1 + x²); its laws are checked outside.
class Cubic final : public FirstOrderRelation {
 public:
  explicit Cubic(bool derivatives) : FirstOrderRelation(1), derivatives_(derivatives) {}
  void output(double, const In& x, const In& l, Out y) const override {
    y[0] = x[0] * x[0] * x[0] + 0.1 * l[0];
  }
  void input(double, const In& x, const In& l, Out r) const override { r[0] = l[0] * (1.0 + x[0] * x[0]); }
  bool output_dx(double, const In& x, const In&, OutMatrix C) const override {
    C(0, 0) = 3.0 * x[0] * x[0];
    return derivatives_;
  }
  bool output_dlambda(double, const In&, const In&, OutMatrix D) const override {
    D(0, 0) = 0.1;
    return derivatives_;
  }
  bool input_dx(double, const In& x, const In& l, OutMatrix K) const override {
    K(0, 0) = 2.0 * x[0] * l[0];
    return derivatives_;
  }
  bool input_dlambda(double, const In& x, const In&, OutMatrix B) const override {
    B(0, 0) = 1.0 + x[0] * x[0];
    return derivatives_;
  }

 private:
  bool derivatives_;
};

TEST(FirstOrder, NonlinearRelationsAreSolvedToTheirLaws) {
  for (const bool derivatives : {true, false}) {
    const DS process = linear(vec({1.2}), {}, vec({0.2}));
    FirstOrderSystem model({process});
    model.link(std::make_shared<Cubic>(derivatives), relay_laws(1), *process);
    const double dt = 0.02;
    auto simulation = simulate(model, {1.0}, dt);
    bool slid = false;
    for (int k = 0; k < 100; ++k) {
      const double before = simulation.state().x[0];
      const FirstOrderReport& report = simulation.step();
      const double x = simulation.state().x[0], l = simulation.state().lambda[0];
      const double y = x * x * x + 0.1 * l;
      ASSERT_NEAR(x, before + dt * (0.2 + l * (1.0 + x * x)), 1e-12);
      ASSERT_NEAR(l, std::clamp(l - y, -1.0, 1.0), 1e-12) << k;
      ASSERT_LE(report.iterations, derivatives ? 8 : 12);
      slid = slid || std::abs(l) < 1.0;
    }
    EXPECT_TRUE(slid);
    EXPECT_NEAR(simulation.state().lambda[0] * (1.0 + std::pow(simulation.state().x[0], 2)), -0.2, 1e-2);
  }
}

TEST(FirstOrder, LawsOfAllKindsActInOneModel) {
  const DS system = linear(
      vec({1.0, -1.0, 0.5, 0.0}),
      matrix({{-1.0, 0.2, 0.0, 0.1}, {0.0, -2.0, 0.3, 0.0}, {0.1, 0.0, -0.5, 0.2}, {0.0, 0.4, 0.0, -1.0}}),
      vec({0.5, -0.5, 1.0, 0.3}));
  FirstOrderSystem model({system});
  model.link(relation(matrix({{1.0, 0.0, 0.0, 0.0}}), matrix({{1.0}, {0.0}, {0.0}, {0.0}})), relay_laws(1),
             *system);
  model.link(relation(matrix({{0.0, 1.0, 0.0, 0.0}}), matrix({{0.0}, {1.0}, {0.0}, {0.0}})),
             complementarity_laws(1), *system);
  model.link(relation(matrix({{0.0, 0.0, 1.0, -1.0}}), matrix({{0.0}, {0.0}, {1.0}, {-1.0}})),
             equality_laws(1), *system);
  auto simulation = simulate(model, {1.0}, 1e-2);
  for (int k = 0; k < 300; ++k) {
    simulation.step();
    const Vec &y = simulation.state().y, &l = simulation.state().lambda;
    ASSERT_NEAR(l[0], std::clamp(l[0] - y[0], -1.0, 1.0), 1e-12);
    ASSERT_NEAR(std::min(y[1], l[1]), 0.0, 1e-12);
    ASSERT_NEAR(y[2], 0.0, 1e-13);
    ASSERT_NEAR(simulation.state().x[2], simulation.state().x[3], 1e-13);
  }
  const BoxLaws mixed = mixed_complementarity_laws(1, 2);
  EXPECT_EQ(mixed.lower[0], -BoxLaws::unbounded);
  EXPECT_EQ(mixed.lower[1], 0.0);
  EXPECT_EQ(mixed.rows(), 3);
}

TEST(FirstOrder, AStepThatFailsLeavesTheStateAlone) {
  const DS system = linear(vec({1.0}), {});
  FirstOrderSystem model({system});  // y = −1 whatever λ is
  model.link(relation(matrix({{0.0}}), matrix({{0.0}}), {}, vec({-1.0})), complementarity_laws(1), *system);
  auto simulation = simulate(model, {1.0}, 0.1);
  try {
    simulation.run(1.0);
    FAIL() << "a law without a solution must not be solved";
  } catch (const SimulationError& error) {
    EXPECT_EQ(error.report().status, StepStatus::solver_failed);
    EXPECT_EQ(error.step(), 1);
    EXPECT_NE(std::string(error.what()).find("no λ that satisfies the laws"), std::string::npos)
        << error.what();
  }
  EXPECT_EQ(simulation.state().x[0], 1.0);
  EXPECT_EQ(simulation.state().t, 0.0);

  auto singular = simulate(FirstOrderSystem({linear(vec({1.0}), matrix({{10.0}}))}), {1.0}, 0.1);
  EXPECT_THROW(singular.step(), SimulationError);  // 1 − θ Δt a = 0
  auto diverging =
      simulate(FirstOrderSystem({std::make_shared<Given>(1.0, [](double, double x) { return x * x; })}),
               {1.0}, 0.5);  // x = 1 + x²/2 has no solution
  EXPECT_THROW(diverging.step(), SimulationError);
}

TEST(FirstOrder, RunsRepeatToTheBit) {
  const auto run = [] {
    auto simulation = simulate(DiodeCircuit().model(-1.0), {0.5}, 1e-2);
    simulation.run(10.0);
    return simulation.state().x;
  };
  EXPECT_EQ(run(), run());
}

TEST(FirstOrder, BadInputIsRefused) {
  const DS one = linear(vec({1.0}), {}), two = linear(vec({1.0, 2.0}), {});
  EXPECT_THROW(linear(Vec(), {}), std::invalid_argument);
  EXPECT_THROW(linear(vec({1.0}), Matrix::Zero(2, 2)), std::invalid_argument);
  EXPECT_THROW(linear(vec({NAN}), {}), std::invalid_argument);
  EXPECT_THROW(relation(Matrix::Zero(1, 2), Matrix::Zero(1, 2)), std::invalid_argument);
  EXPECT_THROW(relation(Matrix::Zero(1, 2), Matrix::Zero(2, 1), Matrix::Zero(2, 2)), std::invalid_argument);
  EXPECT_THROW(relay_laws(1, 1.0, -1.0), std::invalid_argument);
  EXPECT_THROW(relay_laws(1, -BoxLaws::unbounded, 1.0), std::invalid_argument);
  EXPECT_THROW(complementarity_laws(0), std::invalid_argument);
  EXPECT_THROW(FirstOrderSystem({}), std::invalid_argument);
  EXPECT_THROW(FirstOrderSystem({one, one}), std::invalid_argument);
  FirstOrderSystem model({one});
  const auto r = relation(matrix({{1.0}}), matrix({{1.0}}));
  EXPECT_THROW(model.link(r, complementarity_laws(2), *one), std::invalid_argument);
  EXPECT_THROW(model.link(r, complementarity_laws(1), *two), std::invalid_argument);
  EXPECT_THROW(model.link(relation(Matrix::Zero(1, 2), Matrix::Zero(2, 1)), complementarity_laws(1), *one),
               std::invalid_argument);
  model.link(r, complementarity_laws(1), *one, nullptr, "diode");
  EXPECT_THROW(model.link(r, complementarity_laws(1), *one, nullptr, "diode"), std::invalid_argument);
  EXPECT_THROW(simulate(model, {1.5}, 0.1), std::invalid_argument);
  EXPECT_THROW(simulate(model, {1.0, -0.1}, 0.1), std::invalid_argument);
  EXPECT_THROW(simulate(model, {1.0}, 0.0), std::invalid_argument);
  const auto pole = std::make_shared<Given>(0.0, [](double, double x) { return 1.0 / x; });
  EXPECT_THROW(simulate(FirstOrderSystem({pole}), {1.0}, 0.1), std::invalid_argument);
}

}  // namespace
}  // namespace saltus::test
