#pragma once
#include "saltus/numerics/pool.hpp"

namespace saltus {

/// Eigenvector of the largest eigenvalue of the symmetric pair A φ = λ M φ, with φᵀMφ = 1: by a complete
/// decomposition of small matrices, of larger ones by Lanczos iteration, which comes near from below.
/// @param A  (n, n) symmetric
/// @param M  (n, n) symmetric positive definite
/// @return (n), empty if A is not finite
Vec largest_eigenvector(const Matrix& A, const Matrix& M);

}  // namespace saltus
