#pragma once

#include "saltus/numerics/linear/sparse_matrix.hpp"

namespace saltus {

/// What a linear system has instead of dense matrices, where they would be mostly zeros: M, K = −∂h/∂q,
/// C = −∂h/∂v, (n, n), all constant. Without entries K and C may be empty.
struct SparseTerms {
  SparseMatrix mass, stiffness, damping;
};

/// A mechanical system in generalised coordinates: q̇ = Y(q) v, (74), M(q) v̇ = h(t, q, v) + W λ, (2).
/// Derive from it and implement mass() and forces(); both write into storage that starts as zero. Y is the
/// identity unless a class says otherwise: v may then have fewer entries than q, as of bodies whose attitude
/// is a quaternion, and M, h, W and all below are those of v.
class LagrangianDS {
 public:
  /// @param q0  (n) initial position
  /// @param v0  (n) initial velocity
  /// @throws std::invalid_argument if the sizes differ, are zero, or a value is not finite
  LagrangianDS(Vec q0, Vec v0);
  virtual ~LagrangianDS() = default;

  /// Number of freedoms, the entries of v.
  int dimension() const { return static_cast<int>(v0_.size()); }
  /// Number of coordinates, the entries of q.
  int coordinates() const { return static_cast<int>(q0_.size()); }
  const Vec& q0() const { return q0_; }
  const Vec& v0() const { return v0_; }

  /// Is Y something else than the identity?
  virtual bool has_velocity_map() const { return false; }
  /// q̇ = Y(q) v, (74); asked for if there is a velocity map. @param[out] rate (coordinates) starts as zero
  virtual void position_rate(const In& q, const In& v, Out rate) const;
  /// Brings coordinates back to those that are allowed, such as a quaternion to unit length, at the end of
  /// steps of systems with a velocity map.
  virtual void normalise(Out) const {}

  /// M(q), symmetric positive definite. @param[out] M (n, n) [kg, kg m, kg m²]
  virtual void mass(const In& q, OutMatrix M) const = 0;
  /// The right-hand side h(t, q, v) of (2): every force but those of the interactions.
  /// @param[out] h (n) [N, N m]
  virtual void forces(double t, const In& q, const In& v, Out h) const = 0;
  /// True if M does not depend on q: it is then evaluated and factorised once.
  virtual bool constant_mass() const { return false; }
  /// ∂h/∂q Y and ∂h/∂v for implicit schemes, (n, n) each, starting as zero.
  /// @return false if they are not defined: finite differences take their place
  virtual bool force_jacobians(double t, const In& q, const In& v, OutMatrix dh_dq, OutMatrix dh_dv) const;
  /// True if M, ∂h/∂q and ∂h/∂v are constant: implicit schemes then factorise once.
  virtual bool time_invariant() const { return false; }
  /// The matrices of a time-invariant system if they are sparse, else nullptr. Where they are given, nothing
  /// asks for dense ones.
  virtual const SparseTerms* sparse_terms() const { return nullptr; }
  /// Potential energy of the forces in h [J], NaN if unknown. Only reported, never integrated.
  virtual double potential_energy(const In& q) const;

 protected:
  /// For classes with a velocity map.
  struct WithVelocityMap {};
  /// @throws std::invalid_argument if one of them is empty or not finite
  LagrangianDS(WithVelocityMap, Vec q0, Vec v0);

 private:
  Vec q0_, v0_;
};

}  // namespace saltus
