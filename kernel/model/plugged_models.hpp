#pragma once
// Models whose terms are functions with the signatures of Siconos's plugins: one function for each term,
// matrices column by column, and z at the end of all arguments.
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "saltus/kernel/model/lagrangian_ds.hpp"
#include "saltus/kernel/model/relation.hpp"
#include "saltus/numerics/plugin.hpp"

namespace saltus {

/// A function of a plugin, or none; it must have C linkage.
template <class Signature>
struct PluggedFunction {
  Signature* call = nullptr;
  std::shared_ptr<const void> owner;  ///< keeps it where it is

  PluggedFunction() = default;
  PluggedFunction(Signature* function, std::shared_ptr<const void> kept)
      : call(function), owner(std::move(kept)) {}
  /// @param library_and_function  "library:function"
  /// @throws std::invalid_argument as load_symbol()
  PluggedFunction(const std::string& library_and_function) {
    PluginSymbol symbol = load_symbol(library_and_function);
    call = reinterpret_cast<Signature*>(const_cast<void*>(symbol.address));
    owner = std::move(symbol.owner);
  }
  PluggedFunction(const char* library_and_function) : PluggedFunction(std::string(library_and_function)) {}
  explicit operator bool() const { return call != nullptr; }
};

/// M(q) v̇ + F_int(t, q, v) + F_gyr(q, v) + C v + K q = F_ext(t) + f + W λ.
class PluggedDS final : public LagrangianDS {
 public:
  using OfPosition = void(unsigned n, const double* q, double* out, unsigned size_z, double* z);
  using OfTime = void(double t, unsigned n, double* out, unsigned size_z, double* z);
  using OfState = void(unsigned n, const double* q, const double* v, double* out, unsigned size_z, double* z);
  using OfTimeAndState = void(double t, unsigned n, const double* q, const double* v, double* out,
                              unsigned size_z, double* z);

  /// What is left out is zero. Derivatives of forces whose functions are not all given are found by
  /// differences.
  struct Terms {
    PluggedFunction<OfPosition> mass;                          ///< M (n, n), unless it is constant
    PluggedFunction<OfTimeAndState> internal_force;            ///< F_int (n)
    PluggedFunction<OfState> gyroscopic_force;                 ///< F_gyr (n)
    PluggedFunction<OfTime> external_force;                    ///< F_ext (n)
    PluggedFunction<OfTimeAndState> internal_dq, internal_dv;  ///< ∂F_int/∂q, ∂F_int/∂v (n, n)
    PluggedFunction<OfState> gyroscopic_dq, gyroscopic_dv;     ///< ∂F_gyr/∂q, ∂F_gyr/∂v (n, n)
    std::optional<Matrix> constant_mass;                       ///< M (n, n)
    std::optional<Matrix> stiffness;                           ///< K (n, n)
    std::optional<Matrix> damping;                             ///< C (n, n)
    std::optional<Vec> constant_force;                         ///< f (n)
    Vec z = Vec::Zero(1);                                      ///< parameters of every function
  };

  /// @throws std::invalid_argument if a shape is wrong, a value is not finite, or mass is given twice or not
  /// at
  ///         all
  PluggedDS(Vec q0, Vec v0, Terms terms);

  void mass(const In& q, OutMatrix M) const override;
  void forces(double t, const In& q, const In& v, Out h) const override;
  bool constant_mass() const override { return terms_.constant_mass.has_value(); }
  bool force_jacobians(double t, const In& q, const In& v, OutMatrix dh_dq, OutMatrix dh_dv) const override;
  bool time_invariant() const override;

 private:
  Terms terms_;
};

/// y = h(q), of which the first row is the gap of a contact, and Wᵀ = H(q) = ∂h/∂q.
class PluggedRelation final : public Relation {
 public:
  /// For h and H; n freedoms of the linked systems.
  using OfPosition = void(unsigned n, const double* q, unsigned size, double* out, unsigned size_z,
                          double* z);
  /// For Ḣ.
  using OfState = void(unsigned n, const double* q, unsigned n_v, const double* v, double* out,
                       unsigned size_z, double* z);

  /// @param size  rows
  /// @param rate  Ḣ (size, n), only for schemes on acceleration level
  /// @throws std::invalid_argument if size < 1, or h or H is missing
  PluggedRelation(int size, PluggedFunction<OfPosition> h, PluggedFunction<OfPosition> jacobian,
                  PluggedFunction<OfState> rate = {});

  void require_dimensions(int coordinates, int freedoms) const override;
  void gap(const In& q, Out g) const override;
  void jacobian(const In& q, OutMatrix J) const override;
  void curvature(const In& q, const In& v, Out c) const override;
  bool has_curvature() const override { return static_cast<bool>(rate_); }

 private:
  PluggedFunction<OfPosition> h_, jacobian_;
  PluggedFunction<OfState> rate_;
};

/// y = h(t, q) likewise, with ∂h/∂t.
class PluggedRheonomousRelation final : public RheonomousRelation {
 public:
  using OfTimeAndPosition = void(unsigned n, const double* q, double t, unsigned size, double* out,
                                 unsigned size_z, double* z);

  /// @throws std::invalid_argument if size < 1, or one of the functions is missing
  PluggedRheonomousRelation(int size, PluggedFunction<OfTimeAndPosition> h,
                            PluggedFunction<OfTimeAndPosition> jacobian,
                            PluggedFunction<OfTimeAndPosition> motion);

  void require_dimensions(int coordinates, int freedoms) const override;
  void gap_at(double t, const In& q, Out g) const override;
  void jacobian_at(double t, const In& q, OutMatrix J) const override;
  void motion_at(double t, const In& q, Out w) const override;

 private:
  PluggedFunction<OfTimeAndPosition> h_, jacobian_, motion_;
};

}  // namespace saltus
