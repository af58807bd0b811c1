#pragma once
#include <functional>

#include "saltus/kernel/model/model_function.hpp"

namespace saltus {

/// The force of an element as a function of its length l and the rate l̇, positive where it lengthens:
///   f = −k (l − l0) − c l̇ + u(t, l, l̇).
/// A law is data: to add one, fill these. Where l is an angle, units are those of a torque.
struct ForceLaw {
  using Function = std::function<double(double t, double length, double rate)>;

  double stiffness = 0.0;    ///< k [N/m]
  double damping = 0.0;      ///< c [N s/m]
  double rest_length = 0.0;  ///< l0 [m]
  double constant = 0.0;     ///< added to u [N]
  Function function;         ///< u [N], none: zero

  /// Derivatives of the force.
  struct Slopes {
    double length;  ///< ∂f/∂l [N/m]
    double rate;    ///< ∂f/∂l̇ [N s/m]
  };

  /// f [N] at l [m] and l̇ [m/s]
  double force(double t, double length, double rate) const;
  /// Exact but for u, whose derivatives are taken by differences.
  Slopes slopes(double t, double length, double rate) const;
  /// Are the slopes constant?
  bool time_invariant() const { return !function; }
  /// ½ k (l − l0)² [J]. Dampers and u store nothing: what they do is work.
  double potential_energy(double length) const;
};

/// Linear spring and damper in parallel, f = −k (l − l0) − c l̇.
struct SpringDamper : ForceLaw {
  /// @param k   stiffness, of either sign: a negative one pushes away from l0 [N/m]
  /// @param c   damping >= 0 [N s/m]
  /// @param l0  length without force [m]
  /// @throws std::invalid_argument if a value is not finite, or c is negative
  explicit SpringDamper(double k, double c = 0.0, double l0 = 0.0);
};

/// A given force f = u(t, l, l̇): an actuator, or a spring that is not linear.
struct Actuator : ForceLaw {
  /// @param force  constant [N]
  /// @throws std::invalid_argument if it is not finite
  explicit Actuator(double force);
  /// @throws std::invalid_argument if there is no function
  explicit Actuator(Function u);
  /// @param u           called with n = 1, q = l, v = l̇; out (1): the force
  /// @param parameters  handed on to the function
  /// @throws std::invalid_argument if there is no function, or a parameter is not finite
  explicit Actuator(ModelFunction u, Vec parameters = {});
};

}  // namespace saltus
