#include "saltus/kernel/model/bodies/contacts.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "saltus/numerics/text.hpp"

namespace saltus {
namespace {

void require_finite(const Vec3& x, const char* what) {
  if (!x.allFinite()) throw std::invalid_argument(std::string(what) + " must be finite, got NaN or infinity");
}

double not_negative(double radius) {
  if (!(radius >= 0.0) || !std::isfinite(radius))
    throw std::invalid_argument("radius must be finite and not negative, got " + number(radius));
  return radius;
}

// x, at right angles to `from`, turned the shortest way from there to `to`
Vec3 turned(const Vec3& x, const Vec3& from, const Vec3& to) {
  return x - x.dot(to) / std::max(1.0 + from.dot(to), std::numeric_limits<double>::epsilon()) * (from + to);
}

// Two unit vectors that make a right-handed frame with n, e_x and e_y for n = e_z. Contact problems take W at
// two positions, so that a jump of the frame between them would turn friction round. It cannot be smooth
// everywhere: the one direction where it is not, −p, is one that no model prefers.
void tangents(const Vec3& n, Vec3& t1, Vec3& t2) {
  static const Vec3 p = Vec3(0.3871, 0.5923, 0.7067).normalized();
  static const Vec3 at_p = turned(Vec3::UnitX(), Vec3::UnitZ(), p);
  t1 = turned(at_p, p, n);
  t1 = (t1 - n.dot(t1) * n).normalized();
  t2 = n.cross(t1);
}

}  // namespace

BodyContact::BodyContact(int size) : Relation(size) {
  if (size > 3)
    throw std::invalid_argument("size of a contact must be 1, 2 in the plane or 3 in space, got " +
                                std::to_string(size));
}

void BodyContact::require_dimensions(int coordinates, int freedoms) const {
  require_bodies(coordinates, freedoms, "this contact");
  const bool planar = coordinates == freedoms;
  const int with_friction = planar ? 2 : 3;
  if (size() != 1 && size() != with_friction)
    throw std::invalid_argument(std::string("size of a contact of ") + (planar ? "plane" : "spatial") +
                                " bodies must be 1 or " + std::to_string(with_friction) + ", got " +
                                std::to_string(size()));
}

void BodyContact::gap(const In& q, Out g) const { g[0] = closest(BodyPair(q)).gap; }

void BodyContact::directions(const BodyPair& bodies, const Vec3& normal, Vec3 (&along)[3]) const {
  along[0] = normal;
  if (bodies.a.planar) {
    along[1] = normal.cross(Vec3::UnitZ());
  } else if (size() == 3) {  // those of a plane or a face are fixed in its body
    tangents(bodies.b.R.transpose() * normal, along[1], along[2]);
    for (int i : {1, 2}) along[i] = bodies.b.R * along[i];
  }
}

void BodyContact::jacobian(const In& q, OutMatrix J) const {
  const BodyPair bodies(q);
  const Closest at = closest(bodies);
  Vec3 along[3];
  directions(bodies, at.normal, along);
  const Vec3 arm_a = at.on_a - bodies.a.x, arm_b = at.on_b - bodies.b.x;
  for (int i = 0; i < size(); ++i)
    add_to_row(bodies, along[i], arm_a.cross(along[i]), -arm_b.cross(along[i]), J.row(i).data());
}

ContactPlace BodyContact::place(const In& q) const {
  const BodyPair bodies(q);
  const Closest at = closest(bodies);
  ContactPlace place{.point = at.on_a, .forces = size()};
  directions(bodies, at.normal, place.directions);
  return place;
}

SpherePlane::SpherePlane(int size, double radius, const Vec3& centre, const Vec3& point, const Vec3& normal)
    : BodyContact(size), radius_(not_negative(radius)), centre_(centre), point_(point), normal_(normal) {
  require_finite(centre, "centre");
  require_finite(point, "point");
  require_finite(normal, "normal");
  if (normal.isZero(0.0)) throw std::invalid_argument("normal must have a length, got zero");
  normal_ /= normal_.cwiseAbs().maxCoeff();  // squares of its entries could be too large or too small
  normal_.normalize();
}

void SpherePlane::require_dimensions(int coordinates, int freedoms) const {
  BodyContact::require_dimensions(coordinates, freedoms);
  if (coordinates == freedoms && normal_[2] != 0.0)
    throw std::invalid_argument("normal of a line in the plane must have z = 0, got " + number(normal_[2]) +
                                " at length 1");
}

Closest SpherePlane::closest(const BodyPair& bodies) const {
  const Vec3 n = bodies.b.R * normal_, centre = bodies.a.in_space(centre_);
  const double height = n.dot(centre - bodies.b.in_space(point_));
  return {height - radius_, n, centre - radius_ * n, centre - height * n};
}

// g = n·d − r with n fixed in b: ġ = n·ḋ + ṅ·d, g̈ = n·d̈ + 2 ṅ·ḋ + n̈·d
void SpherePlane::curvature(const In& q, const In& v, Out c) const {
  const BodyPair bodies(q);
  const TwistPair twists(bodies, v);
  const Vec3 n = bodies.b.R * normal_;
  const PointPair points(bodies, twists, centre_, point_);
  c[0] = n.dot(points.acceleration) + 2.0 * twists.b.omega.cross(n).dot(points.rate) +
         twists.b.centripetal(n).dot(points.d);
}

SphereSphere::SphereSphere(int size, double radius_a, double radius_b, const Vec3& centre_a,
                           const Vec3& centre_b)
    : BodyContact(size), radius_a_(radius_a), radius_b_(radius_b), centre_a_(centre_a), centre_b_(centre_b) {
  require_finite(centre_a, "centre1");
  require_finite(centre_b, "centre2");
  for (double radius : {radius_a, radius_b})
    if (!std::isfinite(radius)) throw std::invalid_argument("radius must be finite, got " + number(radius));
}

void SphereSphere::require_dimensions(int coordinates, int freedoms) const {
  BodyContact::require_dimensions(coordinates, freedoms);
  for (const Vec3* centre : {&centre_a_, &centre_b_})
    if (coordinates == freedoms && (*centre)[2] != 0.0)
      throw std::invalid_argument("centres of discs in the plane must have z = 0, got " +
                                  number((*centre)[2]));
}

Closest SphereSphere::closest(const BodyPair& bodies) const {
  const Vec3 a = bodies.a.in_space(centre_a_), b = bodies.b.in_space(centre_b_);
  const double distance = (a - b).norm();
  const Vec3 n = (a - b) / distance;
  return {distance - radius_a_ - radius_b_, n, a - radius_a_ * n, b + radius_b_ * n};
}

// g = |d| − r: ġ = n·ḋ, g̈ = n·d̈ + (|ḋ|² − ġ²) / |d|
void SphereSphere::curvature(const In& q, const In& v, Out c) const {
  const BodyPair bodies(q);
  const PointPair points(bodies, TwistPair(bodies, v), centre_a_, centre_b_);
  const double distance = points.d.norm(), closing = points.d.dot(points.rate) / distance;
  c[0] = (points.d.dot(points.acceleration) + points.rate.squaredNorm() - closing * closing) / distance;
}

SphereBox::SphereBox(int size, double radius, const Vec3& centre, const Vec3& half_lengths,
                     const Vec3& box_centre)
    : BodyContact(size),
      radius_(not_negative(radius)),
      centre_(centre),
      half_(half_lengths),
      box_centre_(box_centre) {
  require_finite(centre, "centre");
  require_finite(half_lengths, "half_lengths");
  require_finite(box_centre, "box_centre");
  if (!(half_lengths.minCoeff() > 0.0))
    throw std::invalid_argument("half_lengths must be positive, got " + number(half_lengths.minCoeff()));
}

Closest SphereBox::closest(const BodyPair& bodies) const {
  const Vec3 centre = bodies.a.in_space(centre_), local = bodies.b.in_body(centre) - box_centre_;
  const int axes = bodies.a.planar ? 2 : 3;
  Vec3 nearest = local;
  int deepest = 0;  // the face that is nearest from inside
  bool inside = true;
  for (int i = 0; i < axes; ++i) {
    nearest[i] = std::clamp(local[i], -half_[i], half_[i]);
    inside = inside && nearest[i] == local[i];
    if (half_[i] - std::abs(local[i]) < half_[deepest] - std::abs(local[deepest])) deepest = i;
  }
  Vec3 normal;
  double distance;  // of the centre from the surface
  if (inside) {
    normal = std::copysign(1.0, local[deepest]) * Vec3::Unit(deepest);
    distance = std::abs(local[deepest]) - half_[deepest];
    nearest[deepest] = std::copysign(half_[deepest], local[deepest]);
  } else {
    distance = (local - nearest).norm();
    normal = (local - nearest) / distance;
  }
  const Vec3 n = bodies.b.R * normal;
  return {distance - radius_, n, centre - radius_ * n, bodies.b.in_space(nearest + box_centre_)};
}

}  // namespace saltus
