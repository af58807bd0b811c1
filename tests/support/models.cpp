#include "support/models.hpp"

#include <cmath>

#include "support/runs.hpp"

namespace saltus::test {
namespace {

using Terms = LagrangianLinearTIDS::Terms;

std::shared_ptr<LagrangianLinearTIDS> body(Vec q0, Vec v0, Vec masses, Terms terms = {}) {
  const Matrix M = masses.asDiagonal();
  return std::make_shared<LagrangianLinearTIDS>(std::move(q0), std::move(v0), M, std::move(terms));
}

const Matrix normal_and_tangent = (Matrix(2, 2) << 0.0, 1.0, 1.0, 0.0).finished();

}  // namespace

Vec vec(std::initializer_list<double> values) {
  Vec x(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), x.data());
  return x;
}

std::shared_ptr<const Interaction> linear_contact(Matrix H, Vec b, NonSmoothLaw law, std::string name) {
  return std::make_shared<Interaction>(std::make_shared<LagrangianLinearTIR>(std::move(H), std::move(b)),
                                       std::move(law), std::move(name));
}

NonSmoothDynamicalSystem make_ball(double height, double velocity, double restitution, double mass) {
  auto ball = body(vec({height}), vec({velocity}), vec({mass}), {.external_force = vec({-mass * gravity})});
  NonSmoothDynamicalSystem model({ball});
  model.link(linear_contact(Matrix::Identity(1, 1), vec({0.0}), NewtonImpactNSL(restitution), "floor"),
             *ball);
  return model;
}

NonSmoothDynamicalSystem make_block(double velocity, double mu, double angle, double gap) {
  const double m = 2.0;
  const Vec weight = m * gravity * vec({std::sin(angle), -std::cos(angle)});
  auto block = body(vec({0.0, gap}), vec({velocity, 0.0}), vec({m, m}), {.external_force = weight});
  NonSmoothDynamicalSystem model({block});
  model.link(
      linear_contact(normal_and_tangent, Vec::Zero(2), NewtonImpactFrictionNSL(0.0, 0.0, mu, 2), "plane"),
      *block);
  return model;
}

NonSmoothDynamicalSystem make_friction_oscillator(double x0, double mu, double stiffness) {
  const double m = 2.0;
  auto block = body(
      vec({x0, -1e-4}), Vec::Zero(2), vec({m, m}),
      {.stiffness = Matrix(vec({stiffness, 0.0}).asDiagonal()), .external_force = vec({0.0, -m * gravity})});
  NonSmoothDynamicalSystem model({block});
  model.link(
      linear_contact(normal_and_tangent, Vec::Zero(2), NewtonImpactFrictionNSL(0.0, 0.0, mu, 2), "plane"),
      *block);
  return model;
}

NonSmoothDynamicalSystem make_sphere(Vec q0, Vec v0, double restitution, double mu, double radius) {
  const double m = 2.0;
  auto sphere = body(std::move(q0), std::move(v0), vec({m, m, 0.4 * m * radius * radius}),
                     {.external_force = vec({0.0, -m * gravity, 0.0})});
  NonSmoothDynamicalSystem model({sphere});
  const Matrix H = (Matrix(2, 3) << 0.0, 1.0, 0.0, 1.0, 0.0, radius).finished();
  model.link(linear_contact(H, Vec::Zero(2), NewtonImpactFrictionNSL(restitution, 0.0, mu, 2), "floor"),
             *sphere);
  return model;
}

NonSmoothDynamicalSystem make_two_balls(double m1, double m2, double v1, double v2, double restitution,
                                        double distance) {
  auto left = body(vec({0.0}), vec({v1}), vec({m1}));
  auto right = body(vec({distance}), vec({v2}), vec({m2}));
  NonSmoothDynamicalSystem model({left, right});
  const Matrix H = (Matrix(1, 2) << -1.0, 1.0).finished();
  model.link(linear_contact(H, vec({0.0}), NewtonImpactNSL(restitution), "touch"), *left, right.get());
  return model;
}

NonSmoothDynamicalSystem make_stack(double height, double restitution) {
  auto lower = body(vec({height}), vec({0.0}), vec({1.0}), {.external_force = vec({-gravity})});
  auto upper = body(vec({2.5 * height}), vec({0.0}), vec({3.0}), {.external_force = vec({-3.0 * gravity})});
  NonSmoothDynamicalSystem model({lower, upper});
  const NonSmoothLaw law = NewtonImpactNSL(restitution);
  model.link(linear_contact(Matrix::Identity(1, 1), vec({0.0}), law, "floor"), *lower);
  model.link(linear_contact((Matrix(1, 2) << -1.0, 1.0).finished(), vec({0.0}), law, "between"), *lower,
             upper.get());
  return model;
}

NonSmoothDynamicalSystem make_oscillator(double omega, double x0, double v0, double damping) {
  return NonSmoothDynamicalSystem({body(vec({x0}), vec({v0}), vec({1.0}),
                                        {.stiffness = Matrix(Matrix::Constant(1, 1, omega * omega)),
                                         .damping = Matrix(Matrix::Constant(1, 1, damping))})});
}

void DoublePendulum::mass(const In& q, OutMatrix M) const {
  M(0, 0) = 2.0;
  M(0, 1) = M(1, 0) = std::cos(q[0] - q[1]);
  M(1, 1) = 1.0;
}

void DoublePendulum::forces(double, const In& q, const In& v, Out h) const {
  const double s = std::sin(q[0] - q[1]);
  h[0] = -s * v[1] * v[1] - 2.0 * gravity * std::sin(q[0]);
  h[1] = s * v[0] * v[0] - gravity * std::sin(q[1]);
}

double DoublePendulum::potential_energy(const In& q) const {
  return -gravity * (2.0 * std::cos(q[0]) + std::cos(q[1]));
}

NonSmoothDynamicalSystem make_double_pendulum() {
  return NonSmoothDynamicalSystem({std::make_shared<DoublePendulum>(vec({1.0, 0.5}), vec({0.5, -1.0}))});
}

State exact_double_pendulum(double until) {
  const Vec y = integrate_ode(
      [](double, const Vec& x) {  // M solved by Cramer's rule, not by the library
        const double c = std::cos(x[0] - x[1]), s = std::sin(x[0] - x[1]);
        const double h0 = -s * x[3] * x[3] - 2.0 * gravity * std::sin(x[0]);
        const double h1 = s * x[2] * x[2] - gravity * std::sin(x[1]);
        const double det = 2.0 - c * c;
        return vec({x[2], x[3], (h0 - c * h1) / det, (2.0 * h1 - c * h0) / det});
      },
      vec({1.0, 0.5, 0.5, -1.0}), until, 20000);
  return {until, y.head(2), y.tail(2)};
}

void Circle::gap(const In& q, Out g) const { g[0] = radius_ - std::hypot(q[0], q[1]); }

void Circle::jacobian(const In& q, OutMatrix J) const {
  const double r = std::hypot(q[0], q[1]);
  J(0, 0) = -q[0] / r;
  J(0, 1) = -q[1] / r;
  if (size() == 1) return;
  J(1, 0) = -q[1] / r;
  J(1, 1) = q[0] / r;
}

void Circle::curvature(const In& q, const In& v, Out c) const {
  const double r = std::hypot(q[0], q[1]);
  const double area_rate = q[0] * v[1] - q[1] * v[0];
  c[0] = -area_rate * area_rate / (r * r * r);
  if (size() == 1) return;
  c[1] = -area_rate * (q[0] * v[0] + q[1] * v[1]) / (r * r * r);
}

namespace {

constexpr double swing_mass = 2.0, swing_radius = 0.8, swing_start = 0.3, swing_rate = 3.0, bowl_depth = 1e-4;

// Angle from below and its rate, on a circle of radius r, with friction that opposes the motion
Vec swing(double start, double r, double mu, double until) {
  auto f = [&](double, const Vec& y) {
    const double pressure = r * y[1] * y[1] + gravity * std::cos(y[0]);
    return vec({y[1], -(gravity * std::sin(y[0]) + mu * pressure * (y[1] > 0.0 ? 1.0 : -1.0)) / r});
  };
  return integrate_ode(f, vec({start, swing_rate}), until, 20000);
}

Vec on_circle(double r, double angle) { return r * vec({std::sin(angle), -std::cos(angle)}); }
Vec along_circle(double r, double angle, double rate) {
  return r * rate * vec({std::cos(angle), std::sin(angle)});
}

NonSmoothDynamicalSystem make_on_circle(double start, double r, NonSmoothLaw law) {
  auto point = body(on_circle(r, start), along_circle(r, start, swing_rate), Vec::Constant(2, swing_mass),
                    {.external_force = vec({0.0, -swing_mass * gravity})});
  NonSmoothDynamicalSystem model({point});
  const int size = law.size();
  model.link(
      std::make_shared<Interaction>(std::make_shared<Circle>(size, swing_radius), std::move(law), "circle"),
      *point);
  return model;
}

State exact_on_circle(double start, double r, double mu, double until) {
  const Vec y = swing(start, r, mu, until);
  return {until, on_circle(r, y[0]), along_circle(r, y[0], y[1])};
}

}  // namespace

NonSmoothDynamicalSystem make_pendulum() {
  return make_on_circle(swing_start, swing_radius, EqualityConditionNSL(1));
}

State exact_pendulum(double until) { return exact_on_circle(swing_start, swing_radius, 0.0, until); }

double pendulum_tension(double t) {
  const Vec y = swing(swing_start, swing_radius, 0.0, t);
  return swing_mass * (swing_radius * y[1] * y[1] + gravity * std::cos(y[0]));
}

NonSmoothDynamicalSystem make_bowl(double mu) {
  return make_on_circle(swing_start, swing_radius + bowl_depth, NewtonImpactFrictionNSL(0.0, 0.0, mu, 2));
}

State exact_bowl(double mu, double until) {
  return exact_on_circle(swing_start, swing_radius + bowl_depth, mu, until);
}

NonSmoothDynamicalSystem make_touching_bowl(double mu, double restitution) {
  return make_on_circle(0.0, swing_radius, NewtonImpactFrictionNSL(restitution, 0.0, mu, 2));
}

State exact_touching_bowl(double mu, double until) { return exact_on_circle(0.0, swing_radius, mu, until); }

NonSmoothDynamicalSystem make_block_before_wall(double dt, double restitution) {
  const double mass = 2.0, speed = 1.0;
  auto block = body(vec({10.5 * dt * speed, -1e-9}), vec({-speed, 0.0}), Vec::Constant(2, mass),
                    {.external_force = vec({0.0, -mass * gravity})});
  NonSmoothDynamicalSystem model({block});
  const char* names[] = {"wall", "floor"};
  for (int k : {0, 1})
    model.link(
        linear_contact(Matrix::Identity(2, 2).row(k), vec({0.0}), NewtonImpactNSL(restitution), names[k]),
        *block);
  return model;
}

examples::Guidance guidance_for(const std::string& scheme) {
  return scheme_properties(scheme).friction ? examples::Guidance::frictional
                                            : examples::Guidance::frictionless;
}

}  // namespace saltus::test
