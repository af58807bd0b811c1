#pragma once
#include "saltus/kernel/model/bodies/newton_euler_ds.hpp"

namespace saltus {

/// Where a rigid body is: of a plane one, q = (x, y, angle) and v = q̇, or of a spatial one, NewtonEulerDS.
struct Pose {
  Vec3 x = Vec3::Zero();      ///< [m]; a plane body has z = 0
  Mat3 R = Mat3::Identity();  ///< turns the body's frame into space
  bool planar = false;

  /// The pose of (3) or (7) coordinates.
  static Pose of(const double* q, bool planar);
  Vec3 in_space(const Vec3& point) const { return x + R * point; }
  Vec3 in_body(const Vec3& point) const { return R.transpose() * (point - x); }
};

/// The two bodies of a relation, or one and the ground, whose frame is that of space.
/// Sizes of q tell what they are: 3 or 6 coordinates for plane bodies, 7 or 14 for spatial ones.
struct BodyPair {
  Pose a, b;
  bool grounded;  ///< b is the ground

  explicit BodyPair(const In& q);
  int freedoms() const { return a.planar ? 3 : NewtonEulerDS::freedoms_of_body; }
};

/// Velocity of a body: of its centre [m/s], and angular in space [rad/s].
struct Twist {
  Vec3 v = Vec3::Zero(), omega = Vec3::Zero();

  /// Of a body's part of v (freedoms).
  static Twist of(const double* v, const Pose& pose);
  /// Of the point that is `arm` away from the centre; and its acceleration while v is constant, as Ω is then.
  Vec3 at(const Vec3& arm) const { return v + omega.cross(arm); }
  Vec3 centripetal(const Vec3& arm) const { return omega.cross(omega.cross(arm)); }
};

/// Both bodies' velocities.
struct TwistPair {
  Twist a, b;
  TwistPair(const BodyPair& pair, const In& v);
};

/// From a point of body b to one of body a: d = a − b, and its derivatives while v is constant.
struct PointPair {
  Vec3 d, rate, acceleration;  ///< [m], [m/s], [m/s²]
  /// @param on_a, on_b  in the frames of the bodies [m]
  PointPair(const BodyPair& pair, const TwistPair& twists, const Vec3& on_a, const Vec3& on_b);
};

/// row <- row + the coefficients of force · ẋ + moment · ω, for one body's part of a row of Wᵀ.
void add_to_row(const Pose& body, const Vec3& force, const Vec3& moment, double* row);
/// The same for both: `force` and a moment on a, the opposite force and another moment on b.
void add_to_row(const BodyPair& pair, const Vec3& force, const Vec3& moment_a, const Vec3& moment_b,
                double* row);

/// @throws std::invalid_argument naming `what` unless these are the sizes of one or two bodies of a kind
void require_bodies(int coordinates, int freedoms, const std::string& what);

}  // namespace saltus
