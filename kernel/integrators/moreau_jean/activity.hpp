#pragma once
#include <vector>

#include "saltus/kernel/assembly/configuration.hpp"

namespace saltus {

/// The contacts of a Moreau-Jean step: bilateral ones, and those that a part of the step, half of it unless
/// told, would close at the velocity of its start, g + part Δt γ_N <= 0 (33): up to the rounding of g, and to
/// what a hundred steps make of a closed gap whose velocities are right to the tolerance of the contact
/// problems, 100 Δt tol max_i Σ_j |W_ij v_j|. Else rounding would decide whether contacts at rest are active.
/// @param v            (n) at the start
/// @param[out] gamma   (rows of all contacts) Wᵀv at the start [m/s]
/// @param[out] active  in ascending order
/// @return false if a relative velocity is not finite: it would count as open
bool predict_active(const Layout& layout, Configuration& start, const Vec& v, double dt, Vec& gamma,
                    std::vector<int>& active, double part = 0.5);

}  // namespace saltus
