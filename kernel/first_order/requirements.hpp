#pragma once
#include <string>

#include "saltus/numerics/pool.hpp"

namespace saltus {

/// @throws std::invalid_argument naming `what` unless it is a finite (rows, cols)
void require_matrix(const Matrix& A, Eigen::Index rows, Eigen::Index cols, const std::string& what);
/// @throws std::invalid_argument naming `what` unless it is a finite (size)
void require_vector(const Vec& x, Eigen::Index size, const std::string& what);

}  // namespace saltus
