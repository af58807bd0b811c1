#pragma once
#include <vector>

#include "saltus/kernel/model/nonsmooth_dynamical_system.hpp"

namespace saltus {

/// One freedom that stands for a mode φ of M q̈ + C q̇ + K q = 0, with φᵀMφ = 1.
struct Mode {
  double stiffness = 0.0;  ///< φᵀKφ = ω² [1/s²]
  double damping = 0.0;    ///< φᵀCφ = 2ζω [1/s]
  int system = 0;          ///< that has the largest part of φᵀMφ
};

/// Of the linear time-invariant systems of a model, with the force elements that couple them: the mode of the
/// largest ω² of (M, K), and that of the largest eigenvalue of (M, C). Groups of coupled systems that are not
/// all of this kind, or whose K or C is not symmetric, are left out, and modes that nothing drives back or
/// damps.
std::vector<Mode> fastest_modes(const NonSmoothDynamicalSystem& model);

}  // namespace saltus
