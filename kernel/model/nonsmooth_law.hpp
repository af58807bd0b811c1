#pragma once
#include <vector>

#include "saltus/numerics/contact_problem.hpp"

namespace saltus {

/// The law of an interaction: which set each row's force obeys, and how velocities jump.
/// A law is data: to add one, describe it by contact sets and restitution coefficients.
struct NonSmoothLaw {
  std::vector<ContactSet> sets;  ///< in the order of the relation's rows
  Vec restitution;               ///< (size) [-]: xi = γ⁺ + ε γ⁻ at impacts, (57); ε_N, then ε_T
  int gaps = 1;                  ///< leading rows that have a gap [m]
  bool bilateral = false;        ///< always closed, whatever the gap

  int size() const { return static_cast<int>(restitution.size()); }
};

/// Unilateral contact without friction, Newton's impact law (6).
struct NewtonImpactNSL : NonSmoothLaw {
  /// @param e  restitution ε_N in [0, 1]
  /// @throws std::invalid_argument if e is outside
  explicit NewtonImpactNSL(double e);
};

/// Unilateral contact with Coulomb friction (4), Newton's impact law in both directions (6)-(7).
struct NewtonImpactFrictionNSL : NonSmoothLaw {
  /// @param en, et  restitution ε_N, ε_T in [0, 1]
  /// @param mu      friction coefficient >= 0
  /// @param dim     rows: 2 in the plane, 3 in space
  /// @throws std::invalid_argument if a value is outside its range
  NewtonImpactFrictionNSL(double en, double et, double mu, int dim);
};

/// A bilateral constraint g = 0 of n rows.
struct EqualityConditionNSL : NonSmoothLaw {
  /// @throws std::invalid_argument if n < 1
  explicit EqualityConditionNSL(int n);
};

}  // namespace saltus
