#pragma once
#include <vector>

#include "saltus/kernel/model/bodies/body_pair.hpp"
#include "saltus/kernel/model/relation.hpp"

namespace saltus {

/// A joint between two bodies, or one and the ground, for EqualityConditionNSL(size). It is told where it is
/// in space while the bodies are at their initial positions; that is where it is closed.
///
/// Each row is one of
///   g = e·(a − b)    points a and b of the bodies, e fixed in body b [m]
///   g = f·e          directions f and e, at right angles, fixed in body a and b [1]
class Joint final : public Relation {
 public:
  /// All freedoms are taken, 6 rows; 3 in the plane.
  static Joint weld(const Vec3& at, const LagrangianDS& a, const LagrangianDS* b = nullptr);
  /// Bodies turn about an axis, 5 rows; in the plane about e_z, 2 rows.
  static Joint pivot(const Vec3& at, const Vec3& axis, const LagrangianDS& a,
                     const LagrangianDS* b = nullptr);
  /// A point is common, 3 rows; 2 in the plane.
  static Joint ball(const Vec3& at, const LagrangianDS& a, const LagrangianDS* b = nullptr);
  /// Bodies slide along an axis and do not turn, 5 rows; 2 in the plane.
  static Joint slider(const Vec3& at, const Vec3& axis, const LagrangianDS& a,
                      const LagrangianDS* b = nullptr);
  // Of all these:
  // @param at    a point of the joint in space [m]
  // @param axis  of any length but 0
  // @throws std::invalid_argument if a value is not finite, does not lie in the plane of plane bodies, or a
  // system is no rigid body

  void require_dimensions(int coordinates, int freedoms) const override;
  void require_start(const In& q0) const override;
  void gap(const In& q, Out g) const override;
  void jacobian(const In& q, OutMatrix J) const override;
  void curvature(const In& q, const In& v, Out c) const override;
  bool has_curvature() const override { return true; }
  ContactPlace place(const In& q) const override;

 private:
  struct Row {
    bool of_points;  // else of directions
    Vec3 on_a;       // f, in the frame of a
    Vec3 on_b;       // e, in the frame of b
  };
  Joint(std::vector<Row> rows, const Vec3& point_a, const Vec3& point_b, Vec made_at, bool planar);
  struct Maker;

  std::vector<Row> rows_;
  Vec3 point_a_, point_b_;  // in the frames of the bodies
  Vec made_at_;             // initial positions of the bodies
  bool planar_;
};

}  // namespace saltus
