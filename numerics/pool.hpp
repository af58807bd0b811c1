#pragma once
// Arrays that change size in every step without touching the heap.
#include <Eigen/Core>
#include <vector>

namespace saltus {

/// Vectors and matrices of the whole library: double, matrices row by row, as numpy stores them.
using Vec = Eigen::VectorXd;
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

/// Views of contiguous storage: what models read and write.
using In = Eigen::Map<const Vec>;
using Out = Eigen::Map<Vec>;
using InMatrix = Eigen::Map<const Matrix>;
using OutMatrix = Eigen::Map<Matrix>;

/// xᵀ y. For the few freedoms of a mechanism a plain loop costs a third of Eigen's, for many three times as
/// much.
inline double dot(const Vec& x, const Vec& y) {
  if (x.size() > 32) return x.dot(y);
  double sum = 0.0;
  for (Eigen::Index i = 0, n = x.size(); i < n; ++i) sum += x.data()[i] * y.data()[i];
  return sum;
}

/// Is every entry finite? Likewise.
inline bool all_finite(const Vec& x) {
  if (x.size() > 32) return (0.0 * x).sum() == 0.0;
  double sum = 0.0;  // NaN as soon as one is not
  for (Eigen::Index i = 0, n = x.size(); i < n; ++i) sum += 0.0 * x.data()[i];
  return sum == 0.0;
}

/// y <- y + a x, likewise.
inline void add_scaled(double a, const Vec& x, Vec& y) {
  const double* from = x.data();
  double* to = y.data();
  for (Eigen::Index i = 0, n = y.size(); i < n; ++i) to[i] += a * from[i];
}

/// A vector whose storage only grows: resizing within the reserved size allocates nothing.
class PoolVec {
 public:
  PoolVec() = default;
  PoolVec(const Vec& values) : data_(values.data(), values.data() + values.size()) {}

  void reserve(int size) { data_.reserve(size); }
  /// Contents are unspecified afterwards where the size changed.
  void resize(int size) { data_.resize(size); }
  int size() const { return static_cast<int>(data_.size()); }
  double* data() { return data_.data(); }
  const double* data() const { return data_.data(); }
  double& operator[](int i) { return data_[i]; }
  double operator[](int i) const { return data_[i]; }
  Out view() { return {data_.data(), size()}; }
  In view() const { return {data_.data(), size()}; }

 private:
  std::vector<double> data_;
};

/// A row-major matrix whose storage only grows.
class PoolMatrix {
 public:
  PoolMatrix() = default;
  PoolMatrix(const Matrix& values)
      : rows_(static_cast<int>(values.rows())),
        cols_(static_cast<int>(values.cols())),
        data_(values.data(), values.data() + values.size()) {}

  void reserve(int rows, int cols) { data_.reserve(static_cast<std::size_t>(rows) * cols); }
  /// Contents are unspecified afterwards where the size changed.
  void resize(int rows, int cols) {
    data_.resize(static_cast<std::size_t>(rows) * cols);
    rows_ = rows;
    cols_ = cols;
  }
  int rows() const { return rows_; }
  int cols() const { return cols_; }
  double* row(int i) { return data_.data() + static_cast<std::size_t>(i) * cols_; }
  const double* row(int i) const { return data_.data() + static_cast<std::size_t>(i) * cols_; }
  double& operator()(int i, int j) { return row(i)[j]; }
  double operator()(int i, int j) const { return row(i)[j]; }
  OutMatrix view() { return {data_.data(), rows_, cols_}; }
  InMatrix view() const { return {data_.data(), rows_, cols_}; }

 private:
  int rows_ = 0;
  int cols_ = 0;
  std::vector<double> data_;
};

}  // namespace saltus
