#include "saltus/kernel/model/requirements.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "saltus/numerics/linear/sparse_factor.hpp"
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

void require_shape(Eigen::Index rows, Eigen::Index cols, int n, const std::string& what) {
  const std::string size = std::to_string(n);
  if (rows != n || cols != n)
    throw std::invalid_argument(what + " must be (" + size + ", " + size + ") as q0 has " + size +
                                " entries, got (" + std::to_string(rows) + ", " + std::to_string(cols) + ")");
}

void require_finite(bool finite, const std::string& what) {
  if (!finite) throw std::invalid_argument(what + " must be finite, got NaN or infinity");
}

void require_symmetric(double asymmetry, double size, const std::string& what) {
  if (asymmetry > symmetry_tolerance * size)
    throw std::invalid_argument(what + " must be symmetric, got entries that differ by " + number(asymmetry));
}

}  // namespace

void require_columns(const Matrix& H, int coordinates, int freedoms) {
  if (coordinates != freedoms)
    throw std::invalid_argument(
        "a relation that is linear in q needs systems with as many coordinates as "
        "freedoms, got " +
        std::to_string(coordinates) + " and " + std::to_string(freedoms));
  if (H.cols() != freedoms)
    throw std::invalid_argument("H must have " + std::to_string(freedoms) +
                                " columns as the linked systems have freedoms, got " +
                                std::to_string(H.cols()));
}

double smallest_eigenvalue(const Matrix& A) {
  if (!A.allFinite()) return -std::numeric_limits<double>::infinity();
  return Eigen::SelfAdjointEigenSolver<Matrix>(A, Eigen::EigenvaluesOnly).eigenvalues()[0];
}

void require_square(const Matrix& A, int n, const std::string& what) {
  require_shape(A.rows(), A.cols(), n, what);
  require_finite(A.allFinite(), what);
}

void require_square(const SparseEntries& A, int n, const std::string& what) {
  require_shape(A.rows(), A.cols(), n, what);
  const double* values = A.valuePtr();
  require_finite(std::all_of(values, values + A.nonZeros(), [](double x) { return std::isfinite(x); }), what);
}

void require_mass(const Matrix& M, int n, const std::string& what) {
  require_square(M, n, what);
  require_symmetric((M - M.transpose()).cwiseAbs().maxCoeff(), M.cwiseAbs().maxCoeff(), what);
  if (!positive_definite(M))
    throw std::invalid_argument(what + " must be positive definite, its smallest eigenvalue is " +
                                number(smallest_eigenvalue(M)));
}

void require_mass(const SparseEntries& M, int n, const std::string& what) {
  require_square(M, n, what);
  require_symmetric(asymmetry(M), largest_entry(M), what);
  const Vec diagonal = M.diagonal();
  if (!(diagonal.minCoeff() > 0.0))
    throw std::invalid_argument(what + " must be positive definite, its smallest diagonal entry is " +
                                number(diagonal.minCoeff()));
  const Vec scale = diagonal.cwiseSqrt().cwiseInverse();
  SparseFactor factor;
  if (!factor.factorise_positive(scale.asDiagonal() * M * scale.asDiagonal()) ||
      factor.smallest_pivot() <= singular)
    throw std::invalid_argument(what +
                                " must be positive definite, scaled to unit diagonal it has a pivot of " +
                                number(factor.smallest_pivot()));
}

}  // namespace saltus
