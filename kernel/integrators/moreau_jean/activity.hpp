#pragma once
#include <vector>

#include "saltus/kernel/assembly/configuration.hpp"

namespace saltus {

/// The contacts of a Moreau-Jean step: bilateral ones, and those that half a step of free motion would
/// close, g + ½ Δt γ_N <= 0 (33).
/// @param gamma        (rows of all contacts) Wᵀv at the start [m/s]
/// @param[out] active  in ascending order
void predict_active(const Layout& layout, const Configuration& start, const Vec& gamma, double dt,
                    std::vector<int>& active);

}  // namespace saltus
