#include "saltus/kernel/model/requirements.hpp"

#include <Eigen/Eigenvalues>
#include <limits>
#include <stdexcept>

#include "saltus/numerics/linear/spd_factor.hpp"
#include "saltus/numerics/text.hpp"

namespace saltus {
namespace {

// Larger than rounding in any assembly of M, smaller than any forgotten term.
constexpr double symmetry_tolerance = 1e-9;
// Of an M scaled to unit diagonal: what is below is a singular one with rounding.
constexpr double singular = 1e-14;
// Eigenvalues take n³ operations many times over: above this size Cholesky's word is enough.
constexpr int few = 64;

// Masses and inertias have different units: only their ratios after scaling tell whether M is singular.
bool positive_definite(const Matrix& M) {
  if (!(M.diagonal().minCoeff() > 0.0)) return false;
  const Vec scale = M.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix scaled = scale.asDiagonal() * M * scale.asDiagonal();
  if (M.rows() <= few) return smallest_eigenvalue(scaled) > singular;
  return SpdFactor().factorise({scaled.data(), scaled.rows(), scaled.cols()});
}

}  // namespace

double smallest_eigenvalue(const Matrix& A) {
  if (!A.allFinite()) return -std::numeric_limits<double>::infinity();
  return Eigen::SelfAdjointEigenSolver<Matrix>(A, Eigen::EigenvaluesOnly).eigenvalues()[0];
}

void require_square(const Matrix& A, int n, const std::string& what) {
  const std::string size = std::to_string(n);
  if (A.rows() != n || A.cols() != n)
    throw std::invalid_argument(what + " must be (" + size + ", " + size + ") as q0 has " + size +
                                " entries, got (" + std::to_string(A.rows()) + ", " +
                                std::to_string(A.cols()) + ")");
  if (!A.allFinite()) throw std::invalid_argument(what + " must be finite, got NaN or infinity");
}

void require_mass(const Matrix& M, int n, const std::string& what) {
  require_square(M, n, what);
  const double asymmetry = (M - M.transpose()).cwiseAbs().maxCoeff();
  if (asymmetry > symmetry_tolerance * M.cwiseAbs().maxCoeff())
    throw std::invalid_argument(what + " must be symmetric, got entries that differ by " + number(asymmetry));
  if (!positive_definite(M))
    throw std::invalid_argument(what + " must be positive definite, its smallest eigenvalue is " +
                                number(smallest_eigenvalue(M)));
}

}  // namespace saltus
