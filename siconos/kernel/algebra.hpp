#pragma once
// Vectors and matrices as C++ programs written for Siconos use them.
#include <memory>
#include <string>
#include <vector>

#include "saltus/numerics/pool.hpp"

namespace saltus::siconos::kernel {

/// A vector; zero unless it is filled.
class SiconosVector {
 public:
  explicit SiconosVector(unsigned size, double value = 0.0) : values_(Vec::Constant(size, value)) {}
  explicit SiconosVector(const std::vector<double>& values)
      : values_(Eigen::Map<const Vec>(values.data(), static_cast<Eigen::Index>(values.size()))) {}

  unsigned size() const { return static_cast<unsigned>(values_.size()); }
  double operator()(unsigned i) const { return values_[i]; }
  double& operator()(unsigned i) { return values_[i]; }
  double getValue(unsigned i) const { return values_[i]; }
  void setValue(unsigned i, double value) { values_[i] = value; }
  double* getArray() { return values_.data(); }
  void zero() { values_.setZero(); }
  void fill(double value) { values_.setConstant(value); }
  double norm2() const { return values_.norm(); }
  double normInf() const { return values_.lpNorm<Eigen::Infinity>(); }
  const Vec& values() const { return values_; }
  Vec& values() { return values_; }

 private:
  Vec values_;
};

/// Positions of the linked systems, one after the other.
using BlockVector = SiconosVector;

/// A matrix, column by column; zero unless it is filled.
class SimpleMatrix {
 public:
  SimpleMatrix(unsigned rows, unsigned columns) : values_(Eigen::MatrixXd::Zero(rows, columns)) {}

  /// Rows for 0, columns for 1.
  unsigned size(unsigned axis) const {
    return static_cast<unsigned>(axis == 0 ? values_.rows() : values_.cols());
  }
  double operator()(unsigned i, unsigned j) const { return values_(i, j); }
  double& operator()(unsigned i, unsigned j) { return values_(i, j); }
  double getValue(unsigned i, unsigned j) const { return values_(i, j); }
  void setValue(unsigned i, unsigned j, double value) { values_(i, j) = value; }
  double* getArray() { return values_.data(); }
  void zero() { values_.setZero(); }
  void eye() { values_.setIdentity(); }
  /// Entries that are in both sizes stay.
  void resize(unsigned rows, unsigned columns) {
    values_.conservativeResizeLike(Eigen::MatrixXd::Zero(rows, columns));
  }
  const Eigen::MatrixXd& values() const { return values_; }
  Eigen::MatrixXd& values() { return values_; }

 private:
  Eigen::MatrixXd values_;
};

using SiconosMatrix = SimpleMatrix;

namespace ioMatrix {

/// Writes the rows as text, with every digit, after a line with their numbers unless `form` is "noDim".
/// @throws std::invalid_argument if the mode is not "ascii" or the file cannot be written
void write(const std::string& file, const std::string& mode, const SiconosMatrix& matrix,
           const std::string& form = "dim");

/// The largest difference from a matrix that was written with "noDim", -1 if there is none of that size.
double compareRefFile(const SiconosMatrix& matrix, const std::string& file, double tolerance = 1e-12);

}  // namespace ioMatrix

namespace SP {
using SiconosVector = std::shared_ptr<kernel::SiconosVector>;
using SimpleMatrix = std::shared_ptr<kernel::SimpleMatrix>;
using SiconosMatrix = std::shared_ptr<kernel::SiconosMatrix>;
}  // namespace SP

}  // namespace saltus::siconos::kernel
