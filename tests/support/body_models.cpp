#include "support/body_models.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "saltus/kernel/model/bodies/contacts.hpp"
#include "saltus/kernel/model/bodies/joint.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

constexpr double g = 9.81;
constexpr int fine = 20000;  // steps of reference solutions

using Body = std::shared_ptr<const NewtonEulerDS>;

Vec joined(const Vec& a, const Vec& b) {
  Vec both(a.size() + b.size());
  both << a, b;
  return both;
}

Vec quaternion(double angle, const Vec3& axis) {
  const Vec3 n = std::sin(0.5 * angle) * axis.normalized();
  return vec({std::cos(0.5 * angle), n[0], n[1], n[2]});
}

// ṗ by the product of quaternions
Vec rate(const Vec& p, const Vec3& omega) {
  const Eigen::Quaterniond product =
      Eigen::Quaterniond(p[0], p[1], p[2], p[3]) * Eigen::Quaterniond(0.0, omega[0], omega[1], omega[2]);
  return 0.5 * vec({product.w(), product.x(), product.y(), product.z()});
}

const Vec3 inertia(1.0, 2.0, 3.5), spin(0.3, 2.0, -0.4);

// The top: its tip is at −l e_z of the body's frame
constexpr double length = 0.5;
const Vec3 top_inertia(0.05, 0.06, 0.02), top_spin(0.5, -0.3, 25.0);
Vec top_attitude() { return quaternion(0.4, Vec3::UnitX()); }
Vec3 top_arm() { return {0.0, 0.0, length}; }

State top_state(double t, const Vec& p, const Vec3& omega) {
  const Mat3 R = rotation_of(p.data());
  return {t, joined(R * top_arm(), p), joined(R * omega.cross(top_arm()), omega)};
}

// The skidding body: its point in its own frame
const Vec3 skid_point(0.05, 0.02, -0.3), skid_inertia(0.02, 0.02, 0.01);
constexpr double depth = -1e-4;

Body skidding_body() {
  const Vec p = quaternion(0.6, Vec3::UnitY());
  const double height = depth - (rotation_of(p.data()) * skid_point)[2];
  return std::make_shared<NewtonEulerDS>(joined(vec({0.0, 0.0, height}), p), vec({3, 1, 0, 0, 0, 0}), 1.0,
                                         Mat3(skid_inertia.asDiagonal()), BodyLoads{.force = {0.0, 0.0, -g}});
}

SpherePlane skid_contact(int size) { return {size, 0.0, skid_point, Vec3::Zero(), Vec3::UnitZ()}; }

}  // namespace

NonSmoothDynamicalSystem make_tumbling_body() {
  return NonSmoothDynamicalSystem({std::make_shared<NewtonEulerDS>(
      vec({0, 0, 0, 1, 0, 0, 0}), joined(vec({0.1, 0.0, 0.2}), spin), 2.0, Mat3(inertia.asDiagonal()))});
}

State exact_tumbling_body(double until) {
  const auto f = [](double, const Vec& y) {
    const Vec3 omega = y.tail<3>();
    const Vec3 angular = inertia.cwiseProduct(omega);
    return joined(rate(y.head(4), omega), -omega.cross(angular).cwiseQuotient(inertia));
  };
  const Vec y = integrate_ode(f, joined(vec({1, 0, 0, 0}), spin), until, fine);
  return {until, joined(until * vec({0.1, 0.0, 0.2}), y.head(4)), joined(vec({0.1, 0.0, 0.2}), y.tail(3))};
}

NonSmoothDynamicalSystem make_top() {
  const State start = top_state(0.0, top_attitude(), top_spin);
  const auto top = std::make_shared<NewtonEulerDS>(start.q, start.v, 1.0, Mat3(top_inertia.asDiagonal()),
                                                   BodyLoads{.force = {0.0, 0.0, -g}});
  NonSmoothDynamicalSystem model({top});
  model.link(std::make_shared<Interaction>(std::make_shared<Joint>(Joint::ball(Vec3::Zero(), *top)),
                                           EqualityConditionNSL(3), "tip"),
             *top);
  return model;
}

// Euler's equations about the tip
State exact_top(double until) {
  const Vec3 l = top_arm();
  const Mat3 about_tip =
      Mat3(top_inertia.asDiagonal()) + l.squaredNorm() * Mat3::Identity() - l * l.transpose();
  const auto f = [&](double, const Vec& y) {
    const Vec3 omega = y.tail<3>(), weight = rotation_of(y.data()).transpose() * Vec3(0.0, 0.0, -g);
    const Vec3 moment = l.cross(weight) - omega.cross(about_tip * omega);
    return joined(rate(y.head(4), omega), about_tip.inverse() * moment);
  };
  const Vec y = integrate_ode(f, joined(top_attitude(), top_spin), until, fine);
  return top_state(until, y.head(4), y.tail<3>());
}

NonSmoothDynamicalSystem make_skidding_body(double mu) {
  const auto body = skidding_body();
  NonSmoothDynamicalSystem model({body});
  const bool rough = mu > 0.0;
  const NonSmoothLaw law =
      rough ? NonSmoothLaw(NewtonImpactFrictionNSL(0.0, 0.0, mu, 3)) : NonSmoothLaw(NewtonImpactNSL(0.0));
  model.link(
      std::make_shared<Interaction>(std::make_shared<SpherePlane>(skid_contact(rough ? 3 : 1)), law, "skid"),
      *body);
  return model;
}

// λ_N from γ̇_N = 0, λ_T = −μ λ_N γ_T/|γ_T|: an ordinary differential equation while it slides
State exact_skidding_body(double mu, double until) {
  const auto body = skidding_body();
  const SpherePlane rough = skid_contact(3), smooth = skid_contact(1);
  Matrix M(6, 6);
  body->mass({nullptr, 0}, {M.data(), 6, 6});
  const Matrix inverse = M.inverse();
  const auto f = [&](double t, const Vec& y) {
    const In q(y.data(), 7), v(y.data() + 7, 6);
    Vec h(6), c(1), rates(7);
    Matrix J = Matrix::Zero(3, 6);
    body->forces(t, q, v, {h.data(), 6});
    body->position_rate(q, v, {rates.data(), 7});
    rough.jacobian(q, {J.data(), 3, 6});
    smooth.curvature(q, v, {c.data(), 1});
    const Vec gamma = J * v, tangential = gamma.tail(2) / gamma.tail(2).norm();
    const Vec W = J.row(0).transpose() - mu * J.bottomRows(2).transpose() * tangential;
    const double lambda = -(J.row(0).dot(inverse * h) + c[0]) / J.row(0).dot(inverse * W);
    return joined(rates, inverse * (h + W * lambda));
  };
  const Vec y = integrate_ode(f, joined(body->q0(), body->v0()), until, fine / 10);
  return {until, y.head(7), y.tail(6)};
}

NonSmoothDynamicalSystem make_chain(int links) {
  const double l = 0.1, mass = 0.1, tilt = 1.4;
  const Mat3 J = Vec3(mass * l * l / 12.0, mass * l * l / 12.0, 1e-5).asDiagonal();
  const Vec p = quaternion(tilt, Vec3::UnitY());
  const Vec3 along = rotation_of(p.data()) * Vec3(0.0, 0.0, -l);
  NonSmoothDynamicalSystem::Systems bodies;
  for (int k = 0; k < links; ++k)
    bodies.push_back(std::make_shared<NewtonEulerDS>(joined((k + 0.5) * along, p), Vec::Zero(6), mass, J,
                                                     BodyLoads{.force = {0.0, 0.0, -mass * g}}));
  NonSmoothDynamicalSystem model(bodies);
  for (int k = 0; k < links; ++k) {
    const LagrangianDS* before = k > 0 ? bodies[k - 1].get() : nullptr;
    auto joint = std::make_shared<Joint>(Joint::ball(k * along, *bodies[k], before));
    model.link(std::make_shared<Interaction>(std::move(joint), EqualityConditionNSL(3), ""), *bodies[k],
               before);
  }
  return model;
}

}  // namespace saltus::test
