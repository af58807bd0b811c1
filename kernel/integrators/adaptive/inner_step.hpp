#pragma once
#include "saltus/kernel/assembly/layout.hpp"

namespace saltus {

/// A step of a scheme that chooses steps of its own, as a function of the time in it: what a larger or a
/// smaller step of the simulation needs of it. Positions are the cubic Hermite polynomial of q and q̇ at both
/// ends, velocities the parabola with the same values at the ends and the same mean, λ a straight line.
struct InnerStep {
  double t = 0.0;     ///< start [s]
  double dt = 0.0;    ///< length [s]
  Vec q0, rate0, v0;  ///< at the start: q, q̇ (coordinates), v⁺ (n)
  Vec q1, rate1, v1;  ///< at the end: v⁻
  Vec mean_v;         ///< ∫v dt / dt (n)

  /// λ is known at two places, fractions of the step. (rows) [N]
  double place[2] = {0.0, 1.0};
  Vec lambda[2];

  /// Powers of h and of λ at three places [W], and ½ vᵀṀv over the whole step [J]
  double power_place[3] = {0.0, 0.5, 1.0};
  double power_forces[3] = {}, power_lambda[3] = {};
  double inertia_work = 0.0;

  void reserve(const Layout& layout);
  double end() const { return t + dt; }
  /// q and v at a time in the step. @param[out] q (coordinates) @param[out] v (n)
  void motion_at(double time, Vec& q, Vec& v) const;
  /// Makes λ of contacts whose line does not keep their law at both ends constant, the mean of the step.
  void keep_laws(const Layout& layout);
  /// λ at a time in the step. @param[out] lambda (rows) [N]
  void lambda_at(double time, Vec& lambda) const;
  /// sum <- sum + ∫λ dt over a part of the step (rows) [N s]
  void add_impulse(double from, double to, Vec& sum) const;
  /// Works over a part of the step [J]
  double work_forces(double from, double to) const;
  double work_lambda(double from, double to) const;

 private:
  double work(const double (&power)[3], double from, double to) const;
};

}  // namespace saltus
