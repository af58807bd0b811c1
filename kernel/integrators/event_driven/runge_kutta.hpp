#pragma once
#include <exception>
#include <memory>

#include "saltus/numerics/pool.hpp"

namespace saltus {

/// A differential equation y' = f(t, y) on a manifold.
class Ode {
 public:
  virtual ~Ode() = default;
  /// @param y          (size)
  /// @param[out] rate  (size)
  /// @return false if there is no finite rate at y; the step is then tried again in a smaller size
  virtual bool rate(double t, const double* y, double* rate) = 0;
  /// Brings y back to the manifold after a step. @return as rate()
  virtual bool project(double t, double* y) = 0;
};

/// Error-controlled steps of Verner's explicit Runge-Kutta pair of order 6(5), by ARKODE of SUNDIALS. The
/// error is the largest of the first entries of y, each relative to its size: the others are integrals,
/// which no rate depends on, and systems that do not touch each other do not change each other's steps.
class RungeKutta {
 public:
  /// @param size        entries of y
  /// @param controlled  so many of them decide the step size
  /// @param rtol        of a step
  RungeKutta(Ode& ode, int size, int controlled, double rtol);
  ~RungeKutta();
  RungeKutta(const RungeKutta&) = delete;
  RungeKutta& operator=(const RungeKutta&) = delete;

  /// Begins at (t, y). A method of one step needs no memory: this costs nothing.
  /// @param h  [s] first step size to be tried
  void start(double t, const Vec& y, double h);
  /// Takes one step, not beyond `until`. What f throws is thrown on.
  /// @return false if none is small enough: f is not finite, or the tolerance cannot be reached
  bool step(double until);

  double t() const { return t_; }
  const Vec& y() const { return y_; }
  /// Size to be tried next [s]
  double next_size() const { return h_; }
  long rejected() const { return rejected_; }

 private:
  struct Sundials;
  bool try_step(double until);

  Ode& ode_;
  std::unique_ptr<Sundials> sundials_;
  std::exception_ptr error_;  // thrown in a callback: C code must not see it
  Vec y_;
  double t_ = 0.0, h_ = 0.0;
  long rejected_ = 0;
};

}  // namespace saltus
