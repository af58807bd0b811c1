#pragma once
#include "saltus/kernel/integrators/half_explicit/tableau.hpp"

namespace saltus {

/// Where the stages of a D⁻ scheme lie; with one or two of them both are the same.
enum class StagePoints {
  lobatto,    ///< zeros of the derivative of Legendre's polynomial, and both ends
  chebyshev,  ///< c_l = (1 − cos(π l/s))/2
};

/// Coefficients of (B.1)-(B.8) for stages 0..s: Aq (and Ac) integrates the polynomial through the velocities
/// of all stages, Av that through the accelerations of the stages 0..s−1; the output row has that of all of
/// them.
/// @param s  1, 2 or 3
Tableau d_minus_tableau(int s, StagePoints points);

}  // namespace saltus
