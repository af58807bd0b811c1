#pragma once
#include "saltus/numerics/linear/sparse_matrix.hpp"

namespace saltus {

/// Eigenvector of the largest eigenvalue of the symmetric pair A φ = λ M φ, with φᵀMφ = 1: by a complete
/// decomposition of small matrices, of larger ones by Lanczos iteration, which comes near from below.
/// @param A  (n, n) symmetric
/// @param M  (n, n) symmetric positive definite
/// @return (n), empty if A is not finite
Vec largest_eigenvector(const Matrix& A, const Matrix& M);
/// The same of sparse matrices, by a Lanczos iteration without storage of its vectors: at most 200 products
/// and solutions, twice. For the 1000 elements of a bar the eigenvalue is then right to 1e-3, and never too
/// large.
/// @return likewise, also empty if M is not positive definite
Vec largest_eigenvector(const SparseEntries& A, const SparseEntries& M);

}  // namespace saltus
