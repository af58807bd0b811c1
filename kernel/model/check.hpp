#pragma once
#include <string>
#include <vector>

#include "saltus/kernel/model/nonsmooth_dynamical_system.hpp"

namespace saltus {

/// One comparison of what a model says with what follows from its other functions.
struct CheckItem {
  std::string subject;   ///< "system 0", or the name of an interaction or a force element
  std::string quantity;  ///< what was compared
  double deviation;      ///< largest difference, in the quantity's own unit
  double tolerance;      ///< 1e-6 of its size, and the error of the differences
  std::string note;      ///< values at t0
  bool advisory;         ///< a deviation is worth a look, but may be meant
  bool ok() const { return advisory || deviation <= tolerance; }
};

/// Checks a model at its initial state, by central differences around it:
///   mass       finite, symmetric, positive definite
///   forces     finite; where M depends on q, the part even in v equals −(Ṁv − ½ ∂(vᵀMv)/∂q)
///   potential  −∂V/∂q equals the part of h at v = 0, where V is known: advisory
///   jacobian   normal rows equal ∂g/∂q; all rows finite
///   bilateral  gap and velocity vanish
///   curvature  equals (dWᵀ/dt) v, where it is defined
///   elements   the Jacobian equals ∂l/∂q; the force is finite
/// and notes gaps and relative velocities at t0.
std::vector<CheckItem> check(const NonSmoothDynamicalSystem& model);

}  // namespace saltus
