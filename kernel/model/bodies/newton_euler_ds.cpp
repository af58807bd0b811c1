#include "saltus/kernel/model/bodies/newton_euler_ds.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "saltus/kernel/model/requirements.hpp"
#include "saltus/numerics/text.hpp"

namespace saltus {
namespace {

constexpr double length_tolerance = 1e-6;

Vec with_unit_quaternion(Vec q0) {
  if (q0.size() != NewtonEulerDS::coordinates_of_body)
    throw std::invalid_argument("q0 of a rigid body must have 7 entries, position and quaternion, got " +
                                std::to_string(q0.size()));
  const double length = q0.tail<4>().norm();
  if (!(std::abs(length - 1.0) <= length_tolerance))
    throw std::invalid_argument("the quaternion q0[3:7] must have length 1, got " + number(length));
  q0.tail<4>() /= length;
  return q0;
}

bool only_force(const BodyLoads& loads) {
  return loads.moment.isZero(0.0) && loads.body_force.isZero(0.0) && loads.body_moment.isZero(0.0);
}

}  // namespace

Mat3 rotation_of(const double* p) {
  return Eigen::Quaterniond(p[0], p[1], p[2], p[3]).normalized().toRotationMatrix();
}

NewtonEulerDS::NewtonEulerDS(Vec q0, Vec v0, double mass, const Mat3& inertia, BodyLoads loads)
    : LagrangianDS(WithVelocityMap{}, with_unit_quaternion(std::move(q0)), std::move(v0)),
      mass_(mass),
      inertia_(inertia),
      constant_(loads) {
  if (dimension() != freedoms_of_body)
    throw std::invalid_argument(
        "v0 of a rigid body must have 6 entries, velocity and angular velocity, got " +
        std::to_string(dimension()));
  if (!(mass > 0.0) || !std::isfinite(mass))
    throw std::invalid_argument("mass must be positive and finite, got " + number(mass));
  require_mass(Matrix(inertia), 3, "inertia");
  for (const Vec3* load : {&loads.force, &loads.moment, &loads.body_force, &loads.body_moment})
    if (!load->allFinite())
      throw std::invalid_argument("forces and moments must be finite, got NaN or infinity");
}

void NewtonEulerDS::loads(double, const In&, const In&, BodyLoads&) const {}

void NewtonEulerDS::position_rate(const In& q, const In& v, Out rate) const {
  const double *p = q.data() + 3, *omega = v.data() + 3;
  rate.head<3>() = v.head<3>();
  rate[3] = 0.5 * (-p[1] * omega[0] - p[2] * omega[1] - p[3] * omega[2]);
  rate[4] = 0.5 * (p[0] * omega[0] + p[2] * omega[2] - p[3] * omega[1]);
  rate[5] = 0.5 * (p[0] * omega[1] + p[3] * omega[0] - p[1] * omega[2]);
  rate[6] = 0.5 * (p[0] * omega[2] + p[1] * omega[1] - p[2] * omega[0]);
}

void NewtonEulerDS::normalise(Out q) const { q.tail<4>() /= q.tail<4>().norm(); }

void NewtonEulerDS::mass(const In&, OutMatrix M) const {
  M.setZero();
  M.diagonal().head<3>().setConstant(mass_);
  M.bottomRightCorner<3, 3>() = inertia_;
}

void NewtonEulerDS::forces(double t, const In& q, const In& v, Out h) const {
  BodyLoads now = constant_;
  loads(t, q, v, now);
  const Mat3 R = rotation_of(q.data() + 3);
  const Vec3 omega = v.tail<3>();
  h.head<3>() = now.force + R * now.body_force;
  h.tail<3>() = R.transpose() * now.moment + now.body_moment - omega.cross(inertia_ * omega);
}

double NewtonEulerDS::potential_energy(const In& q) const {
  if (varying_loads() || !only_force(constant_)) return std::numeric_limits<double>::quiet_NaN();
  return -constant_.force.dot(q.head<3>());
}

}  // namespace saltus
