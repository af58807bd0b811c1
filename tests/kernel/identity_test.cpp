// The half-explicit scheme against the formulas of the paper written down once more, straight.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "saltus/kernel/integrators/half_explicit/half_explicit.hpp"
#include "slider_crank/slider_crank.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

using examples::Guidance;
using examples::SliderCrank;
using examples::SliderGuide;

const std::string half_explicit = "HalfExplicitTrapezoidalOSI";

TEST(Verlet, FreeFlightWithForcesOfThePositionIsVelocityVerlet) {
  // Constant mass, h = h(q): v_{½} = v + Δt/2 a(q), q⁺ = q + Δt v_{½}, v⁺ = v_{½} + Δt/2 a(q⁺).
  struct Duffing final : LagrangianDS {
    Duffing() : LagrangianDS(vec({1.0, -0.5}), vec({0.0, 2.0})) {}
    void mass(const In&, OutMatrix M) const override { M.diagonal() << 1.0, 2.0; }
    void forces(double, const In& q, const In&, Out h) const override {
      h[0] = -q[0] - q[0] * q[0] * q[0] + 0.5 * q[1];
      h[1] = -3.0 * q[1] + 0.5 * q[0];
    }
    bool constant_mass() const override { return true; }
  };
  const auto duffing = std::make_shared<Duffing>();
  const double dt = 0.01;
  TimeStepping simulation(NonSmoothDynamicalSystem({duffing}), *make_integrator(half_explicit), dt);
  auto acceleration = [&](const Vec& q) {
    Vec a(2);
    duffing->forces(0.0, In(q.data(), 2), In(q.data(), 2), Out(a.data(), 2));
    return vec({a[0], a[1] / 2.0});
  };
  Vec q = duffing->q0(), v = duffing->v0();
  for (int k = 0; k < 1000; ++k) {
    const Vec half = v + 0.5 * dt * acceleration(q);
    q += dt * half;
    v = half + 0.5 * dt * acceleration(q);
    simulation.step();
    ASSERT_LT((simulation.state().q - q).norm() + (simulation.state().v - v).norm(), 1e-14 * (k + 10)) << k;
  }
}

// The slider crank without closed contacts or with equality constraints: then the conditions are linear
// equations.
class Straight {
 public:
  Straight(const SliderCrank& crank, const SliderGuide* guide, double dt)
      : crank_(crank), guide_(guide), dt_(dt) {}

  Vec q = vec({0.0, 0.0, 0.0}), v = vec({150.0, -75.0, 0.0});
  Vec lambda_plus = Vec::Zero(2), lambda_minus = Vec::Zero(2);

  void step_on_velocity_level() {  // (62)-(72)
    const Matrix M0 = mass(q), W0 = jacobian(q).transpose();
    const Vec a0 = M0.inverse() * forces(q, v);
    const Matrix predicted = jacobian(q + dt_ * v);
    const Matrix X0 = M0.inverse() * W0;
    // (69): W(q̂)ᵀ (v + Δt M⁻¹(h + W λ⁺)) = 0
    lambda_plus = solve(dt_ * predicted * X0, predicted * (v + dt_ * a0));
    const Vec v1 = v + dt_ * (a0 + X0 * lambda_plus);  // (66)
    const Vec q1 = q + 0.5 * dt_ * (v + v1);           // (63) = (64)
    const Matrix M1 = mass(q1), W1 = jacobian(q1).transpose();
    const Vec a1 = M1.inverse() * forces(q1, v1);
    const Matrix X1 = M1.inverse() * W1;
    const Vec free = v + 0.5 * dt_ * (a0 + X0 * lambda_plus + a1);
    lambda_minus = solve(0.5 * dt_ * W1.transpose() * X1, W1.transpose() * free);  // (71)
    v = free + 0.5 * dt_ * X1 * lambda_minus;                                      // (67)
    q = q1;
  }

  void step_on_acceleration_level() {  // (43)-(61)
    const Matrix M0 = mass(q), W0 = jacobian(q).transpose();
    const Vec a0 = M0.inverse() * forces(q, v);
    const Matrix X0 = M0.inverse() * W0;
    lambda_plus = solve(W0.transpose() * X0, curvature(q, v) + W0.transpose() * a0);  // (49) with (40)
    const Vec v1 = v + dt_ * (a0 + X0 * lambda_plus);                                 // (47)
    const Vec q1 = q + 0.5 * dt_ * (v + v1);                                          // (44)
    const Matrix M1 = mass(q1), W1 = jacobian(q1).transpose();
    const Vec a1 = M1.inverse() * forces(q1, v1);
    const Matrix X1 = M1.inverse() * W1;
    lambda_minus = solve(W1.transpose() * X1, curvature(q1, v1) + W1.transpose() * a1);  // (50) with (40)
    v += 0.5 * dt_ * (a0 + X0 * lambda_plus + a1 + X1 * lambda_minus);                   // (54)
    q = q1;
  }

 private:
  Matrix mass(const Vec& at) const {
    Matrix M = Matrix::Zero(3, 3);
    crank_.mass(In(at.data(), 3), OutMatrix(M.data(), 3, 3));
    return M;
  }
  Vec forces(const Vec& at, const Vec& with) const {
    Vec h = Vec::Zero(3);
    crank_.forces(0.0, In(at.data(), 3), In(with.data(), 3), Out(h.data(), 3));
    return h;
  }
  Matrix jacobian(const Vec& at) const {
    Matrix J = Matrix::Zero(2, 3);
    if (guide_) guide_->jacobian(In(at.data(), 3), OutMatrix(J.data(), 2, 3));
    return J;
  }
  Vec curvature(const Vec& at, const Vec& with) const {
    Vec c = Vec::Zero(2);
    if (guide_) guide_->curvature(In(at.data(), 3), In(with.data(), 3), Out(c.data(), 2));
    return c;
  }
  Vec solve(const Matrix& G, const Vec& b) const {
    return guide_ ? Vec(-G.inverse() * b) : Vec(Vec::Zero(2));
  }

  const SliderCrank& crank_;
  const SliderGuide* guide_;
  double dt_;
};

TEST(AppendixA, TheEngineIsSectionFourBeforeTheFirstImpact) {
  const auto model = examples::make_slider_crank(Guidance::frictional);
  const SliderCrank crank(Vec::Zero(3), Vec::Zero(3), {});
  const double dt = 1e-5;
  Straight straight(crank, nullptr, dt);
  TimeStepping simulation(model, *make_integrator(half_explicit), dt);
  long steps = 0;
  while (!simulation.step().impulsive) {
    straight.step_on_velocity_level();
    ++steps;
    ASSERT_LT((simulation.state().q - straight.q).norm(), 1e-12) << steps;
    ASSERT_LT((simulation.state().v - straight.v).norm(), 1e-12 * 200.0) << steps;
  }
  EXPECT_GT(steps, 20);
}

// W moves along the guide: a condition at the wrong place would show at once.
void expect_same_on_guide(const std::string& name, void (Straight::*step)()) {
  const auto model = examples::make_slider_crank(Guidance::equality);
  const SliderCrank crank(Vec::Zero(3), Vec::Zero(3), {});
  const SliderGuide guide({});
  const double dt = 1e-5;
  Straight straight(crank, &guide, dt);
  TimeStepping simulation(model, *make_integrator(name), dt);
  for (int k = 0; k < 1000; ++k) {
    (straight.*step)();
    simulation.step();
    ASSERT_LT((simulation.state().q - straight.q).norm(), 1e-12) << k;
    ASSERT_LT((simulation.state().v - straight.v).norm(), 1e-12 * 200.0) << k;
    const double size = 1.0 + straight.lambda_plus.norm();
    ASSERT_LT((simulation.reactions().lambda_plus - straight.lambda_plus).norm(), 1e-8 * size) << k;
    ASSERT_LT((simulation.reactions().lambda_minus - straight.lambda_minus).norm(), 1e-8 * size) << k;
  }
}

TEST(AppendixA, TheEngineIsSectionFourUnderConstraints) {
  expect_same_on_guide(half_explicit, &Straight::step_on_velocity_level);
}

TEST(AccelerationLevel, TheEngineIsSectionThreeUnderConstraints) {
  expect_same_on_guide("DMinusAccelerationOSI", &Straight::step_on_acceleration_level);
}

TEST(AppendixA, TheRegistryRunsTheTrapezoidalTableau) {
  const auto model = examples::make_slider_crank(Guidance::frictional);
  const HalfExplicit engine("here", trapezoidal_tableau(), HalfExplicitSettings{});
  EXPECT_EQ(engine.name(), "here");
  EXPECT_TRUE(same_bits(run_to(model, engine, 1e-4, 0.05).v,
                        run_to(model, *make_integrator(half_explicit), 1e-4, 0.05).v));
}

}  // namespace
}  // namespace saltus::test
