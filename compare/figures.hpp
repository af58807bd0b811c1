#pragma once
#include <vector>

#include "saltus/compare/sampled_run.hpp"

namespace saltus {

/// Steps, of the coarser run, that a jump is smeared over: v is not compared there, and impacts that are
/// closer to each other are one.
inline constexpr double resolution_steps = 3.0;
/// Two impacts can be the same if they are at most this many coarser steps apart, or this fraction of the
/// run.
inline constexpr double window_steps = 20.0;
inline constexpr double window_fraction = 0.01;
/// Impacts that are smaller than this fraction of the largest one need no partner.
inline constexpr double small_impact = 0.01;

/// How far a run is from the reference. NaN is what cannot be told.
///
/// Scaled differences: each component of q (v) over the range that it covers in the reference, but at least a
/// thousandth of the range of the component that moves most.
struct Figures {
  long common_times = 0;    ///< samples of the run at which there is the reference, t0 excepted
  double end = 0.0;         ///< the last of them [s]
  double error_q = 0.0;     ///< largest scaled difference of q over the common times
  double error_v = 0.0;     ///< likewise of v, where no jump is near
  double spectral = 0.0;    ///< spectral norm of the (n, common times) matrix of differences of q
  double normalised = 0.0;  ///< spectral / √common_times, of which orders are taken
  /// Largest difference of T + V − Σ (work of λ and Λ), over the reference's largest T
  double energy_drift = 0.0;
  long impacts = 0, reference_impacts = 0;  ///< those that are not small
  long unmatched = 0;                       ///< of both, if more than a window before the end
  double impact_time_error = 0.0;           ///< largest of the pairs [s]
  double impulse_error = 0.0;  ///< largest of the pairs, an impact without partner as a whole, over the
                               ///< reference's largest
};

/// Compares at the times that both have, as described above.
/// @param start  t0 [s]
/// @throws std::invalid_argument if they have no time in common
Figures compare_runs(const SampledRun& run, const SampledRun& reference, double start);

}  // namespace saltus
