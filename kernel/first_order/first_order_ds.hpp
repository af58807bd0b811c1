#pragma once
#include <optional>
#include <string>

#include "saltus/numerics/pool.hpp"

namespace saltus {

/// A first-order system M ẋ = f(t, x) + r, r the input of relations. Derive from it and implement f(), which
/// writes into storage that starts as zero. M is constant, the identity if left out; it may be singular, as
/// in the equations of a circuit, if M − θ Δt ∂f/∂x is not.
class FirstOrderDS {
 public:
  /// @param x0  (n) initial state
  /// @param M   (n, n)
  /// @throws std::invalid_argument if x0 is empty, a shape is wrong or a value is not finite
  explicit FirstOrderDS(Vec x0, std::optional<Matrix> M = std::nullopt);
  virtual ~FirstOrderDS() = default;

  int dimension() const { return static_cast<int>(x0_.size()); }
  const Vec& x0() const { return x0_; }
  const std::optional<Matrix>& M() const { return M_; }

  /// @param[out] f  (n)
  virtual void f(double t, const In& x, Out f) const = 0;
  /// @param[out] J  (n, n) ∂f/∂x
  /// @return false if it is not defined: finite differences take its place
  virtual bool jacobian(double t, const In& x, OutMatrix J) const;
  /// Is ∂f/∂x constant?
  virtual bool time_invariant() const { return false; }

 private:
  Vec x0_;
  std::optional<Matrix> M_;
};

/// M ẋ = A(t) x + b(t) + r. A and b are constant unless a derived class overrides them; such a system is for
/// one thread at a time.
class FirstOrderLinearDS : public FirstOrderDS {
 public:
  /// What is left out is zero, of M the identity.
  struct Terms {
    std::optional<Matrix> A;  ///< (n, n)
    std::optional<Vec> b;     ///< (n)
    std::optional<Matrix> M;  ///< (n, n)
  };

  /// @throws std::invalid_argument as FirstOrderDS, also of A and b
  FirstOrderLinearDS(Vec x0, Terms terms);

  /// @param[out] A  (n, n), starts as zero
  virtual void A(double t, OutMatrix A) const;
  /// @param[out] b  (n), starts as zero
  virtual void b(double t, Out b) const;

  void f(double t, const In& x, Out f) const final;
  bool jacobian(double t, const In& x, OutMatrix J) const final;

 private:
  std::optional<Matrix> A_;
  std::optional<Vec> b_;
  mutable Matrix now_;  // A(t) of a class that overrides it
};

/// The same with constant A, b and M.
class FirstOrderLinearTIDS final : public FirstOrderLinearDS {
 public:
  using FirstOrderLinearDS::FirstOrderLinearDS;
  bool time_invariant() const override { return true; }
};

}  // namespace saltus
