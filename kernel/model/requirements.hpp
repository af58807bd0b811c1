#pragma once
#include <string>

#include "saltus/numerics/linear/sparse_matrix.hpp"

namespace saltus {

/// @throws std::invalid_argument naming `what` unless A is a finite (n, n)
void require_square(const Matrix& A, int n, const std::string& what);
void require_square(const SparseEntries& A, int n, const std::string& what);

/// @throws std::invalid_argument naming `what` unless M is a finite symmetric positive definite (n, n)
void require_mass(const Matrix& M, int n, const std::string& what);
/// Likewise, by a sparse factorisation: it costs what its non-zeros cost.
void require_mass(const SparseEntries& M, int n, const std::string& what);

/// For relations that are linear in q.
/// @throws std::invalid_argument unless H (rows, n) acts on systems of n freedoms with q̇ = v
void require_columns(const Matrix& H, int coordinates, int freedoms);

/// Smallest eigenvalue of a symmetric matrix; -infinity if an entry is not finite.
double smallest_eigenvalue(const Matrix& A);

}  // namespace saltus
