#pragma once
#include <optional>
#include <variant>

#include "saltus/kernel/model/lagrangian_ds.hpp"

namespace saltus {

/// Linear time-invariant system: M v̇ + C v + K q = f + W λ, with a force f that is constant, or, in a derived
/// class, a function of time. If one of the matrices is sparse, none is stored
/// densely, and a step costs what their non-zeros cost.
class LagrangianLinearTIDS : public LagrangianDS {
 public:
  using Term = std::variant<Matrix, Eigen::SparseMatrix<double>>;  ///< (n, n)

  /// What is left out is zero.
  struct Terms {
    std::optional<Term> stiffness;      ///< K (n, n) [N/m]
    std::optional<Term> damping;        ///< C (n, n) [N s/m]
    std::optional<Vec> external_force;  ///< f (n) [N]
  };

  /// @param mass  M (n, n), symmetric positive definite
  /// @throws std::invalid_argument if a shape is wrong, a value is not finite, or M is not symmetric
  ///         positive definite
  LagrangianLinearTIDS(Vec q0, Vec v0, Term mass, Terms terms);
  LagrangianLinearTIDS(Vec q0, Vec v0, Term mass)
      : LagrangianLinearTIDS(std::move(q0), std::move(v0), std::move(mass), Terms{}) {}

  void mass(const In& q, OutMatrix M) const override;
  void forces(double t, const In& q, const In& v, Out h) const override;
  bool constant_mass() const override { return true; }
  /// −K and −C
  bool force_jacobians(double t, const In& q, const In& v, OutMatrix dh_dq, OutMatrix dh_dv) const override;
  bool time_invariant() const override { return true; }
  const SparseTerms* sparse_terms() const override { return std::get_if<SparseTerms>(&matrices_); }
  /// ½ qᵀKq − fᵀq, without the second term if f is a function of time
  double potential_energy(const In& q) const override;

 protected:
  /// f(t). @param[in,out] f  (n) [N], zero at the call
  virtual void external_force(double t, Out f) const;
  /// Is f a function of time?
  virtual bool driven() const { return false; }
  bool has_external_force() const { return external_force_.has_value(); }

 private:
  struct DenseTerms {
    Matrix mass;
    std::optional<Matrix> stiffness, damping;
  };

  std::variant<DenseTerms, SparseTerms> matrices_;
  std::optional<Vec> external_force_;
};

}  // namespace saltus
