#include "saltus/numerics/linear/spd_factor.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace saltus {
namespace {

// Mechanisms have few freedoms: sizes known to the compiler make the factorisation several times faster.
template <class Function>
auto with_size(int n, Function function) {
  switch (n) {
    case 2: return function.template operator()<2>();
    case 3: return function.template operator()<3>();
    case 6: return function.template operator()<6>();
    default: return function.template operator()<Eigen::Dynamic>();
  }
}

template <int N>
using Square = Eigen::Matrix<double, N, N>;

}  // namespace

// Sized rather than reserved: a copy of a vector keeps its size, not its capacity.
void SpdFactor::reserve(int n) { values_.resize(static_cast<std::size_t>(n) * n); }

bool SpdFactor::factorise(const InMatrix& M) {
  n_ = static_cast<int>(M.rows());
  diagonal_ = n_ == 1;
  if (diagonal_) {
    values_.assign(1, 1.0 / M(0, 0));
    return M(0, 0) > 0.0 && std::isfinite(M(0, 0)) && std::isfinite(values_[0]);
  }
  values_.resize(static_cast<std::size_t>(n_) * n_);
  return with_size(n_, [&]<int N>() {
    Eigen::Map<Square<N>> L(values_.data(), n_, n_);
    L = Eigen::Map<const Eigen::Matrix<double, N, N, Eigen::RowMajor>>(M.data(), n_, n_);
    Eigen::LLT<Eigen::Ref<Square<N>>> in_place(L);
    double product = 1.0;  // LLT lets a NaN pass: the comparison with zero is false for it
    for (int i = 0; i < n_; ++i) {
      product *= L(i, i) > 0.0 && std::isfinite(L(i, i)) ? 1.0 : 0.0;
      L(i, i) = 1.0 / L(i, i);
    }
    return in_place.info() == Eigen::Success && product > 0.0;
  });
}

bool SpdFactor::factorise_constant(const InMatrix& M) {
  if (!M.isDiagonal(0.0)) return factorise(M);
  n_ = static_cast<int>(M.rows());
  diagonal_ = true;
  values_.resize(n_);
  bool positive = true;
  for (int i = 0; i < n_; ++i) {
    values_[i] = 1.0 / M(i, i);
    positive = positive && M(i, i) > 0.0 && std::isfinite(M(i, i)) && std::isfinite(values_[i]);
  }
  return positive;
}

// L y = x, then Lᵀ x = y
void SpdFactor::substitute(double* x) const {
  with_size(n_, [&]<int N>() {
    const int n = N == Eigen::Dynamic ? n_ : N;
    const double* column = values_.data();
    for (int j = 0; j < n; ++j, column += n) {
      x[j] *= column[j];
      for (int i = j + 1; i < n; ++i) x[i] -= column[i] * x[j];
    }
    for (int j = n - 1; j >= 0; --j) {
      column -= n;
      for (int i = j + 1; i < n; ++i) x[j] -= column[i] * x[i];
      x[j] *= column[j];
    }
  });
}

}  // namespace saltus
