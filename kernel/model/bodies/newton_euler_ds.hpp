#pragma once
#include <Eigen/Core>

#include "saltus/kernel/model/lagrangian_ds.hpp"

namespace saltus {

/// Forces [N] act at the centre of mass, moments [N m] about it; in the frame of space, or of the body.
struct BodyLoads {
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  Vec3 body_force = Vec3::Zero(), body_moment = Vec3::Zero();
};

/// A rigid body in space, (74) with a unit quaternion:
///   q = (x, p)  position of the centre of mass (3) [m]; p = (w, x, y, z) turns the body's frame into space
///   v = (ẋ, Ω)  its velocity (3) [m/s]; angular velocity in the frame of the body (3) [rad/s]
///   m ẍ = f + R(p) f_b,   J Ω̇ = R(p)ᵀ m + m_b − Ω × J Ω,   ṗ = ½ p ∘ (0, Ω)
/// Derive from it for loads that vary.
class NewtonEulerDS : public LagrangianDS {
 public:
  static constexpr int coordinates_of_body = 7, freedoms_of_body = 6;

  /// @param q0       (7), the quaternion of unit length to 1e-6; it is then made so to rounding
  /// @param v0       (6)
  /// @param mass     > 0 [kg]
  /// @param inertia  J about the centre of mass in the body's frame, symmetric positive definite [kg m²]
  /// @param loads    constant ones: gravity is force = (0, 0, -m g)
  /// @throws std::invalid_argument if a size or a value is wrong
  NewtonEulerDS(Vec q0, Vec v0, double mass, const Mat3& inertia, BodyLoads loads = {});

  /// Loads at a state. @param[in,out] loads  the constant ones at the call
  virtual void loads(double t, const In& q, const In& v, BodyLoads& loads) const;
  /// Does loads() change them? Then the potential energy is not known.
  virtual bool varying_loads() const { return false; }

  double body_mass() const { return mass_; }
  const Mat3& inertia() const { return inertia_; }
  bool has_velocity_map() const final { return true; }
  void position_rate(const In& q, const In& v, Out rate) const final;
  void normalise(Out q) const final;
  void mass(const In& q, OutMatrix M) const final;
  bool constant_mass() const final { return true; }
  void forces(double t, const In& q, const In& v, Out h) const final;
  /// −fᵀx of a constant force in space, if there are no other loads
  double potential_energy(const In& q) const override;

 private:
  double mass_;
  Mat3 inertia_;
  BodyLoads constant_;
};

/// The rotation R(p) of a quaternion (w, x, y, z) of any length but 0.
Mat3 rotation_of(const double* p);

}  // namespace saltus
