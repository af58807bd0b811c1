// The theta scheme: orders, exact values, Newton's iteration.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <functional>

#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

std::unique_ptr<OneStepIntegrator> theta_scheme(double theta) {
  return make_integrator("MoreauJeanOSI", {{"theta", theta}});
}

double order_of(const std::vector<double>& dt, const std::function<double(double)>& error) {
  std::vector<double> errors;
  for (double h : dt) errors.push_back(error(h));
  return slope(dt, errors);
}

TEST(MoreauJean, OrderOneAndTwoOnLinearMotion) {
  const double omega = 5.0, damping = 0.4, rate = damping / 2;
  const double damped = std::sqrt(omega * omega - rate * rate);
  const double exact = std::exp(-rate) * (std::cos(damped) + rate / damped * std::sin(damped));
  auto error = [&](double theta) {
    return [=](double dt) {
      return std::abs(run_to(make_oscillator(omega, 1.0, 0.0, damping), *theta_scheme(theta), dt, 1.0).q[0] -
                      exact);
    };
  };
  const std::vector<double> dt = {4e-3, 2e-3, 1e-3};
  EXPECT_NEAR(order_of(dt, error(1.0)), 1.0, 0.1);
  EXPECT_NEAR(order_of(dt, error(0.5)), 2.0, 0.05);
}

TEST(MoreauJean, OrderOneAndTwoWithAVariableMass) {
  const Vec exact = exact_double_pendulum(0.5).q;
  auto error = [&](double theta) {
    return [&exact, theta](double dt) {
      return (run_to(make_double_pendulum(), *theta_scheme(theta), dt, 0.5).q - exact).cwiseAbs().maxCoeff();
    };
  };
  const std::vector<double> dt = {4e-3, 2e-3, 1e-3};
  EXPECT_NEAR(order_of(dt, error(1.0)), 1.0, 0.1);
  EXPECT_NEAR(order_of(dt, error(0.5)), 2.0, 0.1);
}

// θ = ½ keeps the energy of a linear oscillator whatever the step: here 100 times the explicit limit
TEST(MoreauJean, TheMidpointIsStableAndConservative) {
  TimeStepping simulation(make_oscillator(1e3, 1.0, 0.0), *theta_scheme(0.5), 0.2);
  for (int k = 0; k < 1000; ++k) simulation.step();
  const State& state = simulation.state();
  EXPECT_NEAR(state.v[0] * state.v[0] + 1e6 * state.q[0] * state.q[0], 1e6, 1e-4);
}

// One step written out: (M + θΔtC + θ²Δt²K) v⁺ = M v − Δt(1−θ)Cv − ΔtKq − θ(1−θ)Δt²Kv + Δt f
TEST(MoreauJean, OneStepOfALinearSystem) {
  const double theta = 0.7, dt = 0.1;
  Matrix M(2, 2), K(2, 2), C(2, 2);
  M << 2, 0.5, 0.5, 1;
  K << 30, -10, -10, 20;
  C << 1, 0.2, 0.2, 0.5;
  const Vec q = vec({0.1, -0.2}), v = vec({1.0, 0.5}), f = vec({3.0, -1.0});
  auto ds = std::make_shared<LagrangianLinearTIDS>(
      q, v, M, LagrangianLinearTIDS::Terms{.stiffness = K, .damping = C, .external_force = f});
  TimeStepping simulation(NonSmoothDynamicalSystem({ds}), *theta_scheme(theta), dt);
  simulation.step();
  const Matrix A = M + theta * dt * C + theta * theta * dt * dt * K;
  const Vec right =
      M * v - dt * (1 - theta) * (C * v) - dt * (K * q) - theta * (1 - theta) * dt * dt * (K * v) + dt * f;
  const Vec expected = A.fullPivLu().solve(right);
  EXPECT_LE((simulation.state().v - expected).cwiseAbs().maxCoeff(), 1e-15);
  const Vec position = q + dt * (theta * expected + (1 - theta) * v);
  EXPECT_LE((simulation.state().q - position).cwiseAbs().maxCoeff(), 1e-15);
}

// Ball on a floor: with a constant force the scheme is v⁺ = v − Δt g until the forecast closes, then −e v.
TEST(MoreauJean, BouncingBallStepByStep) {
  for (double theta : {0.5, 1.0}) {
    const double dt = 5e-3, e = 0.9;
    TimeStepping simulation(make_ball(1.0, 0.0, e), *theta_scheme(theta), dt);
    double q = 1.0, v = 0.0;
    for (int k = 0; k < 2000; ++k) {
      double next = v - dt * gravity;
      if (q + 0.5 * dt * v <= 0.0) next = std::max(next, -e * v);
      q += dt * (theta * next + (1 - theta) * v);
      v = next;
      simulation.step();
      ASSERT_NEAR(simulation.state().q[0], q, 1e-11) << k;
      ASSERT_NEAR(simulation.state().v[0], v, 1e-11) << k;
    }
  }
}

TEST(MoreauJean, UserJacobiansAndDifferencesGiveTheSame) {
  class Hidden final : public LagrangianDS {  // a Duffing oscillator, with or without its Jacobians
   public:
    explicit Hidden(bool known) : LagrangianDS(vec({1.0}), vec({0.0})), known_(known) {}
    void mass(const In&, OutMatrix M) const override { M(0, 0) = 1.0; }
    void forces(double, const In& q, const In& v, Out h) const override {
      h[0] = -100.0 * q[0] * q[0] * q[0] - 0.3 * v[0];
    }
    bool force_jacobians(double, const In& q, const In&, OutMatrix dq, OutMatrix dv) const override {
      dq(0, 0) = -300.0 * q[0] * q[0];
      dv(0, 0) = -0.3;
      return known_;
    }

   private:
    bool known_;
  };
  auto end = [](bool known) {
    return run_to(NonSmoothDynamicalSystem({std::make_shared<Hidden>(known)}), *theta_scheme(0.5), 1e-2, 2.0);
  };
  EXPECT_NEAR(end(true).q[0], end(false).q[0], 1e-10);
}

TEST(MoreauJean, ThetaOutsideIsRefused) {
  for (double theta : {-0.1, 1.1, std::nan("")}) EXPECT_THROW(theta_scheme(theta), std::invalid_argument);
  EXPECT_THROW(make_integrator("MoreauJeanOSI", {{"theta", "half"}}), std::invalid_argument);
}

}  // namespace
}  // namespace saltus::test
