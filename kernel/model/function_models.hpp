#pragma once
// Models whose formulas are functions of one C signature: of a plugin, of a just-in-time compiler, of any
// language.
#include <optional>

#include "saltus/kernel/model/lagrangian_ds.hpp"
#include "saltus/kernel/model/model_function.hpp"
#include "saltus/kernel/model/relation.hpp"

namespace saltus {

/// A mechanical system made of functions, with q̇ = v.
class FunctionDS : public LagrangianDS {
 public:
  struct Functions {
    ModelFunction mass;              ///< out (n, n): M(q), unless a constant mass is given
    ModelFunction forces;            ///< out (n): h(t, q, v)
    ModelFunction force_jacobians;   ///< out (2, n, n): ∂h/∂q, then ∂h/∂v; optional
    ModelFunction potential_energy;  ///< out (1): of q [J]; optional
    std::optional<Matrix> constant_mass;
  };

  /// @param parameters  handed on to every function
  /// @throws std::invalid_argument if sizes differ, forces or mass are missing, both a function and a
  /// constant mass are given,
  ///         or the constant mass is not symmetric positive definite
  FunctionDS(Vec q0, Vec v0, Functions functions, Vec parameters = {});

  void mass(const In& q, OutMatrix M) const override;
  void forces(double t, const In& q, const In& v, Out h) const override;
  bool constant_mass() const override { return functions_.constant_mass.has_value(); }
  bool force_jacobians(double t, const In& q, const In& v, OutMatrix dh_dq, OutMatrix dh_dv) const override;
  double potential_energy(const In& q) const override;

 protected:
  /// For derived classes that bring the missing functions as overrides, also of a velocity map.
  struct Incomplete {};
  FunctionDS(Incomplete, Vec q0, Vec v0, Functions functions, Vec parameters);
  const Functions& functions() const { return functions_; }

 private:
  Functions functions_;
  FunctionArguments arguments_;
};

/// A relation made of functions.
class FunctionRelation : public Relation {
 public:
  struct Functions {
    ModelFunction gap;        ///< out (1) for a contact, (size) for an equality
    ModelFunction jacobian;   ///< out (size, n)
    ModelFunction curvature;  ///< out (size): (dWᵀ/dt) v; optional
  };

  /// @throws std::invalid_argument if size < 1, or gap or jacobian are missing
  FunctionRelation(int size, Functions functions, Vec parameters = {});

  void require_dimensions(int coordinates, int freedoms) const override;
  void gap(const In& q, Out g) const override;
  void jacobian(const In& q, OutMatrix J) const override;
  void curvature(const In& q, const In& v, Out c) const override;
  bool has_curvature() const override { return static_cast<bool>(functions_.curvature); }

 protected:
  /// For derived classes that bring the missing functions as overrides.
  struct Incomplete {};
  FunctionRelation(Incomplete, int size, Functions functions, Vec parameters);
  const Functions& functions() const { return functions_; }

 private:
  Functions functions_;
  FunctionArguments arguments_;
};

}  // namespace saltus
