#include "saltus/kernel/model/bodies/body_pair.hpp"

#include <Eigen/Geometry>
#include <stdexcept>

namespace saltus {
namespace {

constexpr int of_plane = 3;

}  // namespace

Pose Pose::of(const double* q, bool planar) {
  if (!planar) return {Vec3(q[0], q[1], q[2]), rotation_of(q + 3), false};
  return {Vec3(q[0], q[1], 0.0), Eigen::AngleAxisd(q[2], Vec3::UnitZ()).toRotationMatrix(), true};
}

BodyPair::BodyPair(const In& q) {
  const bool planar = q.size() == of_plane || q.size() == 2 * of_plane;
  const int size = planar ? of_plane : NewtonEulerDS::coordinates_of_body;
  a = Pose::of(q.data(), planar);
  grounded = q.size() == size;
  if (!grounded) b = Pose::of(q.data() + size, planar);
}

Twist Twist::of(const double* v, const Pose& pose) {
  if (pose.planar) return {Vec3(v[0], v[1], 0.0), Vec3(0.0, 0.0, v[2])};
  return {Vec3(v[0], v[1], v[2]), pose.R * Vec3(v[3], v[4], v[5])};
}

TwistPair::TwistPair(const BodyPair& pair, const In& v) : a(Twist::of(v.data(), pair.a)) {
  if (!pair.grounded) b = Twist::of(v.data() + pair.freedoms(), pair.b);
}

PointPair::PointPair(const BodyPair& pair, const TwistPair& twists, const Vec3& on_a, const Vec3& on_b) {
  const Vec3 arm_a = pair.a.R * on_a, arm_b = pair.b.R * on_b;
  d = pair.a.x + arm_a - pair.b.x - arm_b;
  rate = twists.a.at(arm_a) - twists.b.at(arm_b);
  acceleration = twists.a.centripetal(arm_a) - twists.b.centripetal(arm_b);
}

void add_to_row(const Pose& body, const Vec3& force, const Vec3& moment, double* row) {
  row[0] += force[0];
  row[1] += force[1];
  if (body.planar) {
    row[2] += moment[2];
    return;
  }
  row[2] += force[2];
  const Vec3 own = body.R.transpose() * moment;  // v has Ω in the body's frame
  for (int i = 0; i < 3; ++i) row[3 + i] += own[i];
}

void add_to_row(const BodyPair& pair, const Vec3& force, const Vec3& moment_a, const Vec3& moment_b,
                double* row) {
  add_to_row(pair.a, force, moment_a, row);
  if (!pair.grounded) add_to_row(pair.b, -force, moment_b, row + pair.freedoms());
}

void require_bodies(int coordinates, int freedoms, const std::string& what) {
  const bool planar = (coordinates == of_plane || coordinates == 2 * of_plane) && freedoms == coordinates;
  const bool spatial =
      (coordinates == NewtonEulerDS::coordinates_of_body && freedoms == NewtonEulerDS::freedoms_of_body) ||
      (coordinates == 2 * NewtonEulerDS::coordinates_of_body &&
       freedoms == 2 * NewtonEulerDS::freedoms_of_body);
  if (!planar && !spatial)
    throw std::invalid_argument(
        what +
        " acts on plane bodies of 3 freedoms, (x, y, angle), or on NewtonEulerDS, one or two of the same "
        "kind, got " +
        std::to_string(coordinates) + " coordinates and " + std::to_string(freedoms) + " freedoms");
}

}  // namespace saltus
