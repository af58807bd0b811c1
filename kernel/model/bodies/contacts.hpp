#pragma once
#include "saltus/kernel/model/bodies/body_pair.hpp"
#include "saltus/kernel/model/relation.hpp"

namespace saltus {

/// How near the surfaces of two bodies are.
struct Closest {
  double gap;       ///< [m]
  Vec3 normal;      ///< unit, from body b towards body a
  Vec3 on_a, on_b;  ///< the points of the surfaces, in space [m]
};

/// A contact of two bodies, or of one and the ground. Rows of Wᵀ are the velocity of the point of a relative
/// to that of b, along
///   n, t        plane bodies, size 1 or 2: t is n turned by −90°
///   n, t1, t2   spatial ones, size 1 or 3; where n is e_z of b's frame, t1 and t2 are its e_x and e_y
class BodyContact : public Relation {
 public:
  /// @param size  1 without friction, 2 in the plane, 3 in space
  /// @throws std::invalid_argument if it is something else
  explicit BodyContact(int size);
  virtual Closest closest(const BodyPair& bodies) const = 0;
  void require_dimensions(int coordinates, int freedoms) const override;
  void gap(const In& q, Out g) const final;
  void jacobian(const In& q, OutMatrix J) const final;
  /// On the surface of the first body.
  ContactPlace place(const In& q) const final;

 private:
  /// n, and the tangents that rows have
  void directions(const BodyPair& bodies, const Vec3& normal, Vec3 (&along)[3]) const;
};

/// A sphere, or a disc in the plane, on a plane (line) that belongs to the second body or to the ground. Of
/// radius 0 it is a point: the corner of a box.
class SpherePlane final : public BodyContact {
 public:
  /// @param radius  >= 0 [m]
  /// @param centre  of the sphere in the frame of its body [m]
  /// @param point   of the plane, in its body's frame [m]
  /// @param normal  of the plane likewise, of any length but 0, towards the sphere
  /// @throws std::invalid_argument if a value is wrong
  SpherePlane(int size, double radius, const Vec3& centre, const Vec3& point, const Vec3& normal);
  /// @throws std::invalid_argument also if a plane body is given a normal that leaves the plane
  void require_dimensions(int coordinates, int freedoms) const override;
  Closest closest(const BodyPair& bodies) const override;
  void curvature(const In& q, const In& v, Out c) const override;
  bool has_curvature() const override { return size() == 1; }

 private:
  double radius_;
  Vec3 centre_, point_, normal_;
};

/// Two spheres, or discs in the plane: g = |d| − r_a − r_b. Without radii it is the distance of two points of
/// bodies, for force elements and rods. Where the centres meet its normal is NaN.
class SphereSphere final : public BodyContact {
 public:
  /// @param radius_a, radius_b  their sum is taken from the distance; any number [m]
  /// @param centre_a, centre_b  in the frames of the bodies [m]
  /// @throws std::invalid_argument if a value is not finite
  SphereSphere(int size, double radius_a, double radius_b, const Vec3& centre_a, const Vec3& centre_b);
  void require_dimensions(int coordinates, int freedoms) const override;
  Closest closest(const BodyPair& bodies) const override;
  void curvature(const In& q, const In& v, Out c) const override;
  bool has_curvature() const override { return size() == 1; }

 private:
  double radius_a_, radius_b_;
  Vec3 centre_a_, centre_b_;
};

/// A sphere on a box that belongs to the second body or to the ground, its edges along that body's frame; in
/// the plane a disc on a rectangle. Inside of the box the nearest face counts.
class SphereBox final : public BodyContact {
 public:
  /// @param radius        >= 0 [m]
  /// @param centre        of the sphere in the frame of its body [m]
  /// @param half_lengths  of the box > 0 [m]; in the plane the third is not looked at
  /// @param box_centre    in the frame of its body [m]
  /// @throws std::invalid_argument if a value is wrong
  SphereBox(int size, double radius, const Vec3& centre, const Vec3& half_lengths, const Vec3& box_centre);
  Closest closest(const BodyPair& bodies) const override;

 private:
  double radius_;
  Vec3 centre_, half_, box_centre_;
};

}  // namespace saltus
