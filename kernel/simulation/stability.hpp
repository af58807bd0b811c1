#pragma once
#include <optional>
#include <string>

#include "saltus/kernel/integrators/one_step_integrator.hpp"

namespace saltus {

/// A free oscillation that a scheme lets grow.
struct Instability {
  double time_step;         ///< Δt [s]
  double omega;             ///< frequency ω of the mode without damping [rad/s]
  double decay;             ///< 2ζω, its damping [1/s]
  int system;               ///< that moves most in it
  double growth;            ///< factor in a period, or in a step if that is longer
  double largest_stable;    ///< Δt below which it does not grow [s]; 0 if it grows at small ones
  double largest_harmless;  ///< Δt below which it grows by less than 1 % in a period [s]; 0 if there is none

  /// A sentence that names all of these.
  std::string message(const std::string& scheme) const;
};

/// Tells whether Δt is beyond the stability limit of the scheme for the free motion of the model without its
/// contacts: of each group of linear time-invariant systems, coupled by force elements, the mode of the
/// highest frequency, and that of the strongest damping. A copy of the scheme takes one step of the test
/// oscillator
///   q̈ + 2ζω q̇ + ω² q = 0
/// from (1, 0) and from (0, ω): the spectral radius of this 2×2 matrix is the growth. Growth below 1 % in a
/// period is let pass. Systems that are not linear, or whose K or C is not symmetric, are not judged.
/// @return the worst, or nothing: also if the scheme cannot integrate the test oscillator
std::optional<Instability> find_instability(const NonSmoothDynamicalSystem& model,
                                            const OneStepIntegrator& scheme, double time_step);

}  // namespace saltus
