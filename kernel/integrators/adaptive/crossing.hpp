#pragma once
#include <optional>

namespace saltus {

/// The cubic Hermite polynomial of a gap over a step: values g and rates ġ at both ends.
struct GapCurve {
  double g0, rate0;  ///< at the start [m], [m/s]
  double g1, rate1;  ///< at the end
  double dt;         ///< length of the step [s]
};

/// Where the curve first falls through a level.
/// @param level  [m]; at most g0
/// @return x in (0, dt] after the start [s], or nothing
std::optional<double> first_fall(const GapCurve& curve, double level);

}  // namespace saltus
