#pragma once
#include <cmath>

#include "saltus/numerics/contact_problem.hpp"

namespace saltus {

/// What can be said of an impulse P without believing the solver that found it.
struct Certificate {
  double residual = 0.0;  ///< largest entry of the natural map [m/s]
  double scale = 0.0;     ///< max_i (|b_i| + sum_j |G_ij P_j|) [m/s]: the size of the terms in G P + b

  /// Is the residual below the tolerance, relative to the terms that cancel in it?
  /// Never where a term has overflowed.
  bool within(double tolerance) const { return std::isfinite(scale) && residual <= tolerance * scale; }
  /// Has nothing overflowed?
  bool finite() const { return std::isfinite(scale) && std::isfinite(residual); }
  /// A smaller residual, or one without overflow where the other has one.
  bool better_than(const Certificate& other) const {
    return finite() && (!other.finite() || residual < other.residual);
  }
};

/// Residual of the laws at P, and xi = G P + b. Row by row, with d the contact's scale d = max_k G_kk,
/// so that d P is a velocity and the choice of r in (31)-(34) is r = 1/d:
///   Equality     |xi|
///   NonNegative  |min(xi, d P)|, which is |d P - proj_{>=0}(d P - xi)|
///   Coulomb      the same in the normal row, and |d P_T - proj_{C_T(mu d P_N)}(d P_T - xi_T)|
/// @param P        (rows) [N s]
/// @param[out] xi  (rows) [m/s]
Certificate certify(const ContactProblem& problem, const double* P, double* xi);

/// d = max_k |G_kk| over a contact's rows, 1 where the contact moves nothing.
double contact_scale(const ContactProblem& problem, int row, int rows);

}  // namespace saltus
