#include "saltus/numerics/linear/largest_eigenvector.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include "saltus/numerics/linear/sparse_factor.hpp"

namespace saltus {
namespace {

constexpr int few = 40;           // a complete decomposition takes below a millisecond
constexpr int most_vectors = 64;  // of a Krylov space
constexpr int vectors_between_looks = 8;
constexpr double tolerance = 1e-10;

constexpr int most_steps = 200;  // of the iteration that keeps no vectors

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

// x <- L⁻¹ A L⁻ᵀ x with M = L Lᵀ
class Product {
 public:
  Product(const Matrix& A, const Matrix& M) : A_(A.sparseView()) {
    if (M.isDiagonal(0.0))
      inverse_root_ = M.diagonal().cwiseSqrt().cwiseInverse();
    else
      factor_.compute(M);
  }
  bool defined() const {
    return inverse_root_.size() ? inverse_root_.allFinite() : factor_.info() == Eigen::Success;
  }
  void apply(Vec& x) const {
    to_mode(x);
    x = (A_ * x).eval();
    if (inverse_root_.size())
      x = x.cwiseProduct(inverse_root_);
    else
      factor_.matrixL().solveInPlace(x);
  }
  /// x <- L⁻ᵀ x
  void to_mode(Vec& x) const {
    if (inverse_root_.size())
      x = x.cwiseProduct(inverse_root_);
    else
      factor_.matrixU().solveInPlace(x);
  }

 private:
  Eigen::SparseMatrix<double> A_;  // most large ones couple neighbours only
  Vec inverse_root_;               // of a diagonal M
  Eigen::LLT<Columns> factor_;
};

// Lanczos iteration with full orthogonalisation; looks at the value every few vectors
Vec lanczos(const Product& product, Eigen::Index n) {
  Columns V = Columns::Zero(n, most_vectors), T = Columns::Zero(most_vectors, most_vectors);
  Vec x = start(n), top;
  double last = 0.0, size = x.norm();
  for (int k = 1; k <= most_vectors; ++k) {
    V.col(k - 1) = x / size;
    x = V.col(k - 1);
    product.apply(x);
    T(k - 1, k - 1) = x.dot(V.col(k - 1));
    for (int pass = 0; pass < 2; ++pass) x -= V.leftCols(k) * (V.leftCols(k).transpose() * x);
    size = x.norm();
    const bool complete = k == most_vectors || size <= tolerance * T.topLeftCorner(k, k).norm();
    if (complete || k % vectors_between_looks == 0) {
      const Eigen::SelfAdjointEigenSolver<Columns> small(T.topLeftCorner(k, k));
      const double value = small.eigenvalues()[k - 1];
      top = V.leftCols(k) * small.eigenvectors().col(k - 1);
      if (complete || std::abs(value - last) <= tolerance * std::abs(value)) break;
      last = value;
    }
    T(k, k - 1) = T(k - 1, k) = size;
  }
  product.to_mode(top);
  return top;
}

// Lanczos iteration for M⁻¹A in the inner product of M, by its recurrence of three terms. What rounding costs
// is orthogonality, and so copies of eigenvalues: the largest one stays right.
class Recurrence {
 public:
  Recurrence(const SparseEntries& A, const SparseEntries& M) : A_(A), M_(M) {
    defined_ = factor_.factorise_positive(M_.entries());
  }
  bool defined() const { return defined_; }
  /// The first vector.
  void begin() {
    last_.setZero(M_.entries().rows());
    x_ = start(M_.entries().rows());
    normalise(x_);
    coupling_ = 0.0;
  }
  const Vec& x() const { return x_; }
  /// The next one. @return the entry of the diagonal of the projected matrix
  double advance() {
    next_.setZero(x_.size());
    A_.add_product(1.0, x_.data(), next_.data());
    const double diagonal = next_.dot(x_);
    factor_.solve(next_.data());
    next_ -= diagonal * x_ + coupling_ * last_;
    coupling_ = normalise(next_);
    last_.swap(x_);
    x_.swap(next_);
    return diagonal;
  }
  /// The entry beside the diagonal, after advance().
  double coupling() const { return coupling_; }
  double normalise(Vec& x) const {
    const double size = std::sqrt(std::max(M_.form(x.data()), 0.0));
    if (size > 0.0) x /= size;
    return size;
  }

 private:
  SparseMatrix A_, M_;
  SparseFactor factor_;
  bool defined_;
  Vec last_, x_, next_;
  double coupling_ = 0.0;
};

// Coefficients of the wanted vector in those of the recurrence
Vec top_coefficients(Recurrence& recurrence) {
  std::vector<double> diagonal, beside;
  double last = 0.0;
  recurrence.begin();
  for (int k = 1;; ++k) {
    diagonal.push_back(recurrence.advance());
    const bool complete =
        k == most_steps || recurrence.coupling() <= tolerance * *std::ranges::max_element(diagonal);
    if (complete || k % vectors_between_looks == 0) {
      Eigen::SelfAdjointEigenSolver<Columns> small;
      small.computeFromTridiagonal(In(diagonal.data(), k), In(beside.data(), k - 1));
      const double value = small.eigenvalues()[k - 1];
      if (complete || std::abs(value - last) <= tolerance * std::abs(value))
        return small.eigenvectors().col(k - 1);
      last = value;
    }
    beside.push_back(recurrence.coupling());
  }
}

}  // namespace

Vec largest_eigenvector(const SparseEntries& A, const SparseEntries& M) {
  Recurrence recurrence(A, M);
  if (!recurrence.defined() || !std::isfinite(largest_entry(A))) return {};
  const Vec coefficients = top_coefficients(recurrence);
  Vec mode = Vec::Zero(A.rows());
  recurrence.begin();
  for (double coefficient : coefficients) {
    mode += coefficient * recurrence.x();
    recurrence.advance();
  }
  recurrence.normalise(mode);
  return mode;
}

Vec largest_eigenvector(const Matrix& A, const Matrix& M) {
  if (!A.allFinite()) return {};
  if (A.rows() == 1) return Vec::Constant(1, 1.0 / std::sqrt(M(0, 0)));
  if (A.rows() <= few)
    return Eigen::GeneralizedSelfAdjointEigenSolver<Columns>(A, M).eigenvectors().rightCols<1>();
  const Product product(A, M);
  return product.defined() ? lanczos(product, A.rows()) : Vec();
}

}  // namespace saltus
