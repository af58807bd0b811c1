#pragma once

#include "saltus/numerics/linear/sparse_matrix.hpp"

namespace saltus {

/// What a linear system has instead of dense matrices, where they would be mostly zeros: M, K = −∂h/∂q,
/// C = −∂h/∂v, (n, n), all constant. Without entries K and C may be empty.
struct SparseTerms {
  SparseMatrix mass, stiffness, damping;
};

/// A mechanical system in generalised coordinates: q̇ = v, M(q) v̇ = h(t, q, v) + W λ, (1)-(2).
/// Derive from it and implement mass() and forces(); both write into storage that starts as zero.
class LagrangianDS {
 public:
  /// @param q0  (n) initial position
  /// @param v0  (n) initial velocity
  /// @throws std::invalid_argument if the sizes differ, are zero, or a value is not finite
  LagrangianDS(Vec q0, Vec v0);
  virtual ~LagrangianDS() = default;

  int dimension() const { return static_cast<int>(q0_.size()); }
  const Vec& q0() const { return q0_; }
  const Vec& v0() const { return v0_; }

  /// M(q), symmetric positive definite. @param[out] M (n, n) [kg, kg m, kg m²]
  virtual void mass(const In& q, OutMatrix M) const = 0;
  /// The right-hand side h(t, q, v) of (2): every force but those of the interactions.
  /// @param[out] h (n) [N, N m]
  virtual void forces(double t, const In& q, const In& v, Out h) const = 0;
  /// True if M does not depend on q: it is then evaluated and factorised once.
  virtual bool constant_mass() const { return false; }
  /// ∂h/∂q and ∂h/∂v for implicit schemes, (n, n) each, starting as zero.
  /// @return false if they are not defined: finite differences take their place
  virtual bool force_jacobians(double t, const In& q, const In& v, OutMatrix dh_dq, OutMatrix dh_dv) const;
  /// True if M, ∂h/∂q and ∂h/∂v are constant: implicit schemes then factorise once.
  virtual bool time_invariant() const { return false; }
  /// The matrices of a time-invariant system if they are sparse, else nullptr. Where they are given, nothing
  /// asks for dense ones.
  virtual const SparseTerms* sparse_terms() const { return nullptr; }
  /// Potential energy of the forces in h [J], NaN if unknown. Only reported, never integrated.
  virtual double potential_energy(const In& q) const;

 private:
  Vec q0_, v0_;
};

}  // namespace saltus
