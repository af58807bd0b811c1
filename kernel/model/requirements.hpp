#pragma once
#include <string>

#include "saltus/numerics/pool.hpp"

namespace saltus {

/// @throws std::invalid_argument naming `what` unless A is a finite (n, n)
void require_square(const Matrix& A, int n, const std::string& what);

/// @throws std::invalid_argument naming `what` unless M is a finite symmetric positive definite (n, n)
void require_mass(const Matrix& M, int n, const std::string& what);

/// Smallest eigenvalue of a symmetric matrix; -infinity if an entry is not finite.
double smallest_eigenvalue(const Matrix& A);

}  // namespace saltus
