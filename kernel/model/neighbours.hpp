#pragma once
#include <array>
#include <vector>

#include "saltus/numerics/pool.hpp"

namespace saltus {

/// The broad phase of contact detection: pairs of discs or spheres whose surfaces are near each other,
///   |c_i − c_j| − r_i − r_j <= within,
/// found by a uniform grid with cells as wide as the largest sphere and its neighbourhood: O(n log n + pairs)
/// if sizes are alike.
/// @param centres  (n, 1 to 3) c [m]
/// @param radii    (n) r >= 0 [m]
/// @param within   [m], also below zero
/// @return (i, j) with i < j, in ascending order
/// @throws std::invalid_argument if shapes disagree, a value is not finite or a radius is negative
std::vector<std::array<int, 2>> neighbours(const Matrix& centres, const Vec& radii, double within);

}  // namespace saltus
