#pragma once
#include <optional>

#include "saltus/numerics/pool.hpp"

namespace saltus {

/// Output and input of one or two first-order systems with state x = [x1; x2]:
///   y = h(t, x, λ),  r = g(t, x, λ),
/// between which a law acts on y and λ. Derive from it and implement output() and input(); all write into
/// storage that starts as zero. Jacobians that are not defined are found by differences.
class FirstOrderRelation {
 public:
  /// @param size  entries of y and of λ
  /// @throws std::invalid_argument if size < 1
  explicit FirstOrderRelation(int size);
  virtual ~FirstOrderRelation() = default;
  int size() const { return size_; }

  /// @throws std::invalid_argument if the relation cannot act on systems that have n states together
  virtual void require_dimension(int n) const;
  /// @param lambda  (size); @param[out] y  (size)
  virtual void output(double t, const In& x, const In& lambda, Out y) const = 0;
  /// @param[out] r  (n)
  virtual void input(double t, const In& x, const In& lambda, Out r) const = 0;
  /// C = ∂h/∂x (size, n). @return false if it is not defined, likewise below
  virtual bool output_dx(double t, const In& x, const In& lambda, OutMatrix C) const;
  /// D = ∂h/∂λ (size, size)
  virtual bool output_dlambda(double t, const In& x, const In& lambda, OutMatrix D) const;
  /// K = ∂g/∂x (n, n)
  virtual bool input_dx(double t, const In& x, const In& lambda, OutMatrix K) const;
  /// B = ∂g/∂λ (n, size)
  virtual bool input_dlambda(double t, const In& x, const In& lambda, OutMatrix B) const;
  /// Are all four constant?
  virtual bool time_invariant() const { return false; }

 private:
  int size_;
};

/// y = C(t) x + D(t) λ + e(t), r = B(t) λ, constant unless a derived class overrides them; such a relation is
/// for one thread at a time.
class FirstOrderLinearR : public FirstOrderRelation {
 public:
  /// What is left out is zero.
  struct Terms {
    std::optional<Matrix> D;  ///< (size, size)
    std::optional<Vec> e;     ///< (size)
  };

  /// @param C  (size, n)
  /// @param B  (n, size)
  /// @throws std::invalid_argument if shapes disagree or a value is not finite
  FirstOrderLinearR(Matrix C, Matrix B, Terms terms);

  virtual void C(double t, OutMatrix C) const;
  virtual void D(double t, OutMatrix D) const;
  virtual void e(double t, Out e) const;
  virtual void B(double t, OutMatrix B) const;

  void require_dimension(int n) const override;
  void output(double t, const In& x, const In& lambda, Out y) const final;
  void input(double t, const In& x, const In& lambda, Out r) const final;
  bool output_dx(double t, const In& x, const In& lambda, OutMatrix C) const final;
  bool output_dlambda(double t, const In& x, const In& lambda, OutMatrix D) const final;
  bool input_dx(double t, const In& x, const In& lambda, OutMatrix K) const final;
  bool input_dlambda(double t, const In& x, const In& lambda, OutMatrix B) const final;

 private:
  Matrix C_, B_;
  std::optional<Matrix> D_;
  std::optional<Vec> e_;
  mutable Matrix C_now_, D_now_, B_now_;  // at a time, of a class that overrides them
};

/// The same with constant matrices.
class FirstOrderLinearTIR final : public FirstOrderLinearR {
 public:
  using FirstOrderLinearR::FirstOrderLinearR;
  bool time_invariant() const override { return true; }
};

}  // namespace saltus
