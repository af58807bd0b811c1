#pragma once
#include <string>
#include <vector>

#include "saltus/kernel/model/nonsmooth_dynamical_system.hpp"

namespace saltus {

/// One comparison of what a model says with what follows from its other functions.
struct CheckItem {
  std::string subject;   ///< "system 0" or the interaction's name
  std::string quantity;  ///< what was compared
  double deviation;      ///< largest difference, relative to the size of the terms
  double tolerance;
  std::string note;  ///< values at t0, or why the item was left out
  bool ok() const { return deviation <= tolerance; }
};

/// Checks a model at its initial state, by central differences around it:
///   mass       finite, symmetric, positive definite
///   forces     finite; the part even in v equals −(Ṁv − ½ ∂(vᵀMv)/∂q), which M determines
///   potential  −∂V/∂q equals the part of h at v = 0, where V is known
///   jacobian   normal rows equal ∂g/∂q; all rows finite
///   curvature  equals (dWᵀ/dt) v, where it is defined
/// and notes gaps and relative velocities at t0.
std::vector<CheckItem> check(const NonSmoothDynamicalSystem& model);

}  // namespace saltus
