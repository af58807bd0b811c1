#include "saltus/kernel/model/bodies/joint.hpp"

#include <Eigen/Geometry>
#include <stdexcept>

#include "saltus/numerics/text.hpp"

namespace saltus {
namespace {

Vec start_of(const LagrangianDS& a, const LagrangianDS* b) {
  require_bodies(a.coordinates() + (b ? b->coordinates() : 0), a.dimension() + (b ? b->dimension() : 0),
                 "a joint");
  Vec q(a.coordinates() + (b ? b->coordinates() : 0));
  q.head(a.coordinates()) = a.q0();
  if (b) q.tail(b->coordinates()) = b->q0();
  return q;
}

}  // namespace

// Collects the rows, which are given in space.
struct Joint::Maker {
  Vec start;
  BodyPair bodies;
  Vec3 at;
  std::vector<Row> rows;

  Maker(const Vec3& point, const LagrangianDS& a, const LagrangianDS* b)
      : start(start_of(a, b)), bodies(In(start.data(), start.size())), at(point) {
    if (!at.allFinite()) throw std::invalid_argument("at must be finite, got NaN or infinity");
    if (bodies.a.planar && at[2] != 0.0)
      throw std::invalid_argument("at must lie in the plane for plane bodies, z = 0, got " + number(at[2]));
  }
  // Columns: the axis, and two directions across it
  Mat3 frame(const Vec3& axis) const {
    if (!axis.allFinite() || !(axis.norm() > 0.0))
      throw std::invalid_argument("axis must be finite and have a length, got NaN, infinity or zero");
    const Vec3 n = axis.normalized();
    if (bodies.a.planar && n[2] != 0.0)
      throw std::invalid_argument("axis must lie in the plane for plane bodies, z = 0, got " + number(n[2]));
    const Vec3 across = bodies.a.planar ? Vec3(Vec3::UnitZ().cross(n)) : n.unitOrthogonal();
    Mat3 axes;
    axes << n, across, n.cross(across);
    return axes;
  }
  void hold_point(const Vec3& direction) {
    rows.push_back({true, Vec3::Zero(), bodies.b.R.transpose() * direction});
  }
  void hold_angle(const Vec3& f, const Vec3& e) {
    rows.push_back({false, bodies.a.R.transpose() * f, bodies.b.R.transpose() * e});
  }
  void hold_all_points() {
    for (int i = 0; i < (bodies.a.planar ? 2 : 3); ++i) hold_point(Vec3::Unit(i));
  }
  void hold_attitude() {
    hold_angle(Vec3::UnitX(), Vec3::UnitY());
    if (bodies.a.planar) return;
    hold_angle(Vec3::UnitY(), Vec3::UnitZ());
    hold_angle(Vec3::UnitZ(), Vec3::UnitX());
  }
  Joint make() {
    return Joint(std::move(rows), bodies.a.in_body(at), bodies.b.in_body(at), start, bodies.a.planar);
  }
};

Joint::Joint(std::vector<Row> rows, const Vec3& point_a, const Vec3& point_b, Vec made_at, bool planar)
    : Relation(static_cast<int>(rows.size())),
      rows_(std::move(rows)),
      point_a_(point_a),
      point_b_(point_b),
      made_at_(std::move(made_at)),
      planar_(planar) {}

Joint Joint::weld(const Vec3& at, const LagrangianDS& a, const LagrangianDS* b) {
  Maker maker(at, a, b);
  maker.hold_all_points();
  maker.hold_attitude();
  return maker.make();
}

Joint Joint::pivot(const Vec3& at, const Vec3& axis, const LagrangianDS& a, const LagrangianDS* b) {
  Maker maker(at, a, b);
  maker.hold_all_points();
  if (maker.bodies.a.planar) {
    if (!(axis.head<2>().norm() == 0.0 && axis[2] != 0.0))
      throw std::invalid_argument("axis of a pivot of plane bodies must be (0, 0, 1), got (" +
                                  number(axis[0]) + ", " + number(axis[1]) + ", " + number(axis[2]) + ")");
    return maker.make();
  }
  const Mat3 axes = maker.frame(axis);
  maker.hold_angle(axes.col(0), axes.col(1));
  maker.hold_angle(axes.col(0), axes.col(2));
  return maker.make();
}

Joint Joint::ball(const Vec3& at, const LagrangianDS& a, const LagrangianDS* b) {
  Maker maker(at, a, b);
  maker.hold_all_points();
  return maker.make();
}

Joint Joint::slider(const Vec3& at, const Vec3& axis, const LagrangianDS& a, const LagrangianDS* b) {
  Maker maker(at, a, b);
  const Mat3 axes = maker.frame(axis);
  maker.hold_point(axes.col(1));
  if (!maker.bodies.a.planar) maker.hold_point(axes.col(2));
  maker.hold_attitude();
  return maker.make();
}

void Joint::require_dimensions(int coordinates, int freedoms) const {
  require_bodies(coordinates, freedoms, "a joint");
  if ((coordinates == freedoms) != planar_)
    throw std::invalid_argument("a joint was made for other bodies than it is linked to");
}

void Joint::require_start(const In& q0) const {
  if (q0.size() != made_at_.size() || q0 != made_at_)
    throw std::invalid_argument(
        "a joint is linked to the bodies that it was made for, in the same order, got others");
}

void Joint::gap(const In& q, Out g) const {
  const BodyPair bodies(q);
  const Vec3 d = bodies.a.in_space(point_a_) - bodies.b.in_space(point_b_);
  for (int i = 0; i < size(); ++i) {
    const Vec3 e = bodies.b.R * rows_[i].on_b;
    g[i] = rows_[i].of_points ? e.dot(d) : (bodies.a.R * rows_[i].on_a).dot(e);
  }
}

// ġ = e·(ȧ − ḃ) + (ω_b × e)·(a − b): b turns e as if a were its own point; and ġ = (ω_a − ω_b)·(f × e)
void Joint::jacobian(const In& q, OutMatrix J) const {
  const BodyPair bodies(q);
  const Vec3 a = bodies.a.in_space(point_a_);
  const Vec3 arm_a = a - bodies.a.x, arm_b = a - bodies.b.x;
  for (int i = 0; i < size(); ++i) {
    const Vec3 e = bodies.b.R * rows_[i].on_b;
    double* row = J.row(i).data();
    if (rows_[i].of_points) {
      add_to_row(bodies, e, arm_a.cross(e), -arm_b.cross(e), row);
    } else {
      const Vec3 axis = (bodies.a.R * rows_[i].on_a).cross(e);
      add_to_row(bodies, Vec3::Zero(), axis, -axis, row);
    }
  }
}

// Rows of points come first.
ContactPlace Joint::place(const In& q) const {
  const BodyPair bodies(q);
  ContactPlace place{.point = bodies.a.in_space(point_a_)};
  for (const Row& row : rows_)
    if (row.of_points) place.directions[place.forces++] = bodies.b.R * row.on_b;
  return place;
}

// Of points e·d̈ + 2 ė·ḋ + ë·d; of directions f̈·e + 2 ḟ·ė + f·ë; at constant v
void Joint::curvature(const In& q, const In& v, Out c) const {
  const BodyPair bodies(q);
  const TwistPair twists(bodies, v);
  const PointPair points(bodies, twists, point_a_, point_b_);
  for (int i = 0; i < size(); ++i) {
    const Vec3 e = bodies.b.R * rows_[i].on_b, turned = twists.b.omega.cross(e);
    const Vec3 curved = twists.b.centripetal(e);
    if (rows_[i].of_points) {
      c[i] = e.dot(points.acceleration) + 2.0 * turned.dot(points.rate) + curved.dot(points.d);
    } else {
      const Vec3 f = bodies.a.R * rows_[i].on_a;
      c[i] = twists.a.centripetal(f).dot(e) + 2.0 * twists.a.omega.cross(f).dot(turned) + f.dot(curved);
    }
  }
}

}  // namespace saltus
