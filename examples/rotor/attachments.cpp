#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <stdexcept>

#include "rotor/rotor.hpp"
#include "saltus/numerics/text.hpp"

namespace saltus::examples {
namespace {

constexpr int coordinates_of_body = NewtonEulerDS::coordinates_of_body;
constexpr int freedoms_of_body = NewtonEulerDS::freedoms_of_body;

// Adds to a row the derivatives of something by α, (w, u) and (w', u') at a station.
void add_to_axle(const Station& at, double alpha, const double* deflection, const double* slope,
                 double* row) {
  double* e = row + at.first;
  for (int end = 0; end < 2; ++end, e += 5) {
    e[0] += at.linear[end] * alpha;
    for (int direction = 0; direction < 2; ++direction)
      for (int k = 0; k < 2; ++k)
        e[1 + 2 * direction + k] +=
            at.cubic[2 * end + k] * deflection[direction] + at.slope[2 * end + k] * slope[direction];
  }
}

void require_not_negative(double value, const char* what) {
  if (!(value >= 0.0) || !std::isfinite(value))
    throw std::invalid_argument(std::string(what) + " must be finite and not negative, got " + number(value));
}

// The vector of a rotation: its angle up to π along its axis
Vec3 rotation_vector(const double* p) {
  const double sign = std::copysign(1.0, p[0]);
  const Vec3 part = sign * Vec3(p[1], p[2], p[3]);
  const double sine = part.norm();
  return sine > 0.0 ? Vec3((2.0 * std::atan2(sine, sign * p[0]) / sine) * part) : Vec3(2.0 * part);
}

}  // namespace

AxleWeld::AxleWeld(const Axle& axle, double s)
    : Relation(6), station_(axle.station(s)), freedoms_(axle.dimension()) {}

void AxleWeld::require_dimensions(int coordinates, int freedoms) const {
  if (coordinates != freedoms_ + coordinates_of_body || freedoms != freedoms_ + freedoms_of_body)
    throw std::invalid_argument("this weld acts on its axle and a NewtonEulerDS, got " +
                                std::to_string(coordinates) + " coordinates");
}

void AxleWeld::gap(const In& q, Out g) const {
  const Section section(station_, q.data());
  const Pose body = Pose::of(q.data() + freedoms_, false);
  g.head<3>() = body.x - section.x;
  g[3] = section.tangent.dot(body.R.col(1));
  g[4] = section.tangent.dot(body.R.col(2));
  g[5] = section.y.dot(body.R.col(2));
}

void AxleWeld::jacobian(const In& q, OutMatrix J) const {
  const Section at(station_, q.data());
  const Pose body = Pose::of(q.data() + freedoms_, false);
  const Vec3 turned = Vec3::UnitX().cross(at.x), tangent_turned = Vec3::UnitX().cross(at.tangent);
  const double none[2] = {0.0, 0.0};
  for (int i = 0; i < 3; ++i) {
    const double across[2] = {-at.y[i], -at.z[i]};
    add_to_axle(station_, -turned[i], across, none, J.row(i).data());
    add_to_row(body, Vec3::Unit(i), Vec3::Zero(), J.row(i).data() + freedoms_);
  }
  for (int i = 3; i < 5; ++i) {  // ṫ·b + t·(ω × b)
    const Vec3 b = body.R.col(i - 2);
    const double slopes[2] = {at.y.dot(b), at.z.dot(b)};
    add_to_axle(station_, tangent_turned.dot(b), none, slopes, J.row(i).data());
    add_to_row(body, Vec3::Zero(), b.cross(at.tangent), J.row(i).data() + freedoms_);
  }
  const Vec3 b = body.R.col(2);
  add_to_axle(station_, at.z.dot(b), none, none, J.row(5).data());
  add_to_row(body, Vec3::Zero(), b.cross(at.y), J.row(5).data() + freedoms_);
}

AxleWeld::State AxleWeld::held(const Axle& axle, double s) {
  const AxleWeld weld(axle, s);
  const int n = axle.dimension();
  const Section at(weld.station_, axle.q0().data());
  Mat3 R;  // b1 along t, b3 across e_y'
  R.col(0) = at.tangent.normalized();
  R.col(2) = R.col(0).cross(at.y).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  const Eigen::Quaterniond p(R);
  Vec q(n + coordinates_of_body);
  q << axle.q0(), at.x, p.w(), p.x(), p.y(), p.z();
  Matrix J = Matrix::Zero(6, n + freedoms_of_body);
  weld.jacobian(In(q.data(), q.size()), OutMatrix(J.data(), J.rows(), J.cols()));
  const Vec v = -J.rightCols(freedoms_of_body).partialPivLu().solve(J.leftCols(n) * axle.v0());
  return {q.tail(coordinates_of_body), v};
}

JournalContact::JournalContact(int size, double disc, double circle, double along)
    : BodyContact(size), disc_(disc), circle_(circle), centre_(along, 0.0, 0.0) {
  if (!(disc > 0.0 && circle > disc) || !std::isfinite(circle) || !std::isfinite(along))
    throw std::invalid_argument("a disc of positive radius must fit into the circle, got radii " +
                                number(disc) + " and " + number(circle));
}

Closest JournalContact::closest(const BodyPair& bodies) const {
  const Vec3 centre = bodies.a.in_space(centre_), axis = bodies.b.R.col(0);
  const Vec3 apart = centre - bodies.b.in_space(centre_);
  const Vec3 across = apart - apart.dot(axis) * axis;
  const double distance = across.norm();
  // Where the centres meet no direction is nearer than the others: a row of zeros, of an open contact.
  const Vec3 outward = distance > 0.0 ? Vec3(across / distance) : Vec3(Vec3::Zero());
  // The point of the bearing is taken as far along its axis as the disc: then its velocity counts the turning
  // of the axis, and the normal row is ∂g/∂q.
  const Vec3 wall = centre + (circle_ - distance) * outward;
  return {circle_ - disc_ - distance, -outward, centre + disc_ * outward, wall};
}

MountedBody::MountedBody(Vec q0, Vec v0, double mass, const Mat3& inertia, double stiffness, double damping,
                         double gravity)
    : NewtonEulerDS(std::move(q0), std::move(v0), mass, inertia,
                    {Vec3(0.0, 0.0, -mass * gravity), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}),
      stiffness_(stiffness),
      damping_(damping),
      gravity_(gravity) {
  require_not_negative(stiffness, "stiffness");
  require_not_negative(damping, "damping");
}

void MountedBody::loads(double, const In& q, const In& v, BodyLoads& loads) const {
  loads.force -= stiffness_ * q.head<3>() + damping_ * v.head<3>();
  loads.body_moment -= stiffness_ * rotation_vector(q.data() + 3) + damping_ * v.tail<3>();
}

double MountedBody::potential_energy(const In& q) const {
  const double turned = rotation_vector(q.data() + 3).squaredNorm();
  return 0.5 * stiffness_ * (q.head<3>().squaredNorm() + turned) + body_mass() * gravity_ * q[2];
}

}  // namespace saltus::examples
