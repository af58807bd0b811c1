#include "saltus/numerics/linear/largest_eigenvector.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace saltus {
namespace {

constexpr int few = 24;           // a complete decomposition takes below a millisecond
constexpr int most_vectors = 64;  // of a Krylov space
constexpr double tolerance = 1e-10;

using Columns = Eigen::MatrixXd;

// Deterministic, and orthogonal to no mode in particular.
Vec start(Eigen::Index n) {
  Vec x(n);
  double value = 0.5;
  for (Eigen::Index i = 0; i < n; ++i) {
    value = std::fmod(value * 1.6180339887498949 + 0.7548776662466927, 1.0);
    x[i] = value - 0.5;
  }
  return x;
}

// Lanczos iteration for B = L⁻¹ A L⁻ᵀ with full orthogonalisation
Vec lanczos(const Matrix& A, const Eigen::LLT<Columns>& M) {
  const Eigen::Index n = A.rows();
  const int most = static_cast<int>(std::min<Eigen::Index>(most_vectors, n));
  Columns V = Columns::Zero(n, most), T = Columns::Zero(most, most);
  Vec x = start(n), top;
  double last = 0.0;
  for (int k = 0; k < most; ++k) {
    const double size = x.norm();
    if (k > 0 && size <= tolerance * std::abs(last)) break;  // an invariant subspace
    if (k > 0) T(k, k - 1) = T(k - 1, k) = size;
    V.col(k) = x / size;
    x = M.matrixU().solve(Vec(V.col(k)));
    x = A * x;
    M.matrixL().solveInPlace(x);
    T(k, k) = x.dot(V.col(k));
    for (int pass = 0; pass < 2; ++pass) x -= V.leftCols(k + 1) * (V.leftCols(k + 1).transpose() * x);
    const Eigen::SelfAdjointEigenSolver<Columns> small(T.topLeftCorner(k + 1, k + 1));
    top = V.leftCols(k + 1) * small.eigenvectors().col(k);
    const double value = small.eigenvalues()[k];
    if (k > 0 && std::abs(value - last) <= tolerance * std::abs(value)) break;
    last = value;
  }
  M.matrixU().solveInPlace(top);
  return top;
}

}  // namespace

Vec largest_eigenvector(const Matrix& A, const Matrix& M) {
  if (!A.allFinite()) return {};
  const Eigen::LLT<Columns> factor(M);
  if (factor.info() != Eigen::Success) return {};
  if (A.rows() == 1) return Vec::Constant(1, 1.0 / std::sqrt(M(0, 0)));
  if (A.rows() > few) return lanczos(A, factor);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Columns> all(A, M);
  return all.eigenvectors().col(A.rows() - 1);
}

}  // namespace saltus
