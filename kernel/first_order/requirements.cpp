#include "saltus/kernel/first_order/requirements.hpp"

#include <stdexcept>

namespace saltus {
namespace {

void require_finite(bool finite, const std::string& what) {
  if (!finite) throw std::invalid_argument(what + " must be finite, got NaN or infinity");
}

}  // namespace

void require_matrix(const Matrix& A, Eigen::Index rows, Eigen::Index cols, const std::string& what) {
  if (A.rows() != rows || A.cols() != cols)
    throw std::invalid_argument(what + " must be (" + std::to_string(rows) + ", " + std::to_string(cols) +
                                "), got (" + std::to_string(A.rows()) + ", " + std::to_string(A.cols()) +
                                ")");
  require_finite(A.allFinite(), what);
}

void require_vector(const Vec& x, Eigen::Index size, const std::string& what) {
  if (x.size() != size)
    throw std::invalid_argument(what + " must have " + std::to_string(size) + " entries, got " +
                                std::to_string(x.size()));
  require_finite(x.allFinite(), what);
}

}  // namespace saltus
