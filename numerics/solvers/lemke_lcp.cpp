#include "saltus/numerics/solvers/lemke_lcp.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace saltus {
namespace {

// Values below this fraction of the largest are zero: a degenerate basis.
constexpr double value_tolerance = 1e-13;
// Ratios closer than this, relative to the larger one, are a tie.
constexpr double tie_tolerance = 1e-12;
constexpr int refactorisation_interval = 50;
// Paths are short as a rule, about one pivot a row, but exponential in the worst case.
constexpr int most_pivots = 10000;
constexpr int refinements = 2;
constexpr int scalings = 4;

// The power of two next to 1/x, 1 for 0
double scale_of(double x) { return x > 0.0 ? std::exp2(-std::round(std::log2(x))) : 1.0; }

}  // namespace

void LemkeLcp::reserve(int n) {
  M_.reserve(n, n);
  inverse_.reserve(n, n);
  for (PoolVec* x : {&q_, &x_, &column_, &scale_}) x->reserve(n);
  basis_.reserve(n);
}

void LemkeLcp::resize(int n) {
  n_ = n;
  M_.resize(n, n);
  inverse_.resize(n, n);
  for (PoolVec* x : {&q_, &x_, &column_, &scale_}) x->resize(n);
  basis_.resize(n);
}

// M <- D M D, q <- D q / |D q|, where D balances the largest entries of row and column i together
void LemkeLcp::scale() {
  auto M = M_.view();
  auto D = scale_.view();
  D.setOnes();
  for (int k = 0; k < scalings; ++k) {
    for (int i = 0; i < n_; ++i) {
      const double largest = std::max(M.row(i).cwiseAbs().maxCoeff(), M.col(i).cwiseAbs().maxCoeff());
      const double d = scale_of(std::sqrt(largest));
      D[i] *= d;
      M.row(i) *= d;
      M.col(i) *= d;
    }
  }
  q_.view().array() *= D.array();
  const double size = scale_of(q_.view().cwiseAbs().maxCoeff());
  q_.view() *= size;
  D /= size;
}

// The basis of all w: the inverse is the identity, the values are q.
void LemkeLcp::start() {
  inverse_.view().setIdentity();
  x_.view() = q_.view();
  for (int i = 0; i < n_; ++i) basis_[i] = i;
}

LcpOutcome LemkeLcp::solve(double* z, double pivot_tolerance) {
  least_pivot_ = pivot_tolerance;
  pivots_ = 0;
  std::fill_n(z, n_, 0.0);
  if (n_ == 0 || q_.view().minCoeff() >= 0.0) return LcpOutcome::solved;
  scale();
  start();
  // z0 enters; the row with the lexicographically smallest (q_i, e_i) leaves: the last of the smallest q_i
  enter(artificial());
  int row = 0;
  for (int i = 1; i < n_; ++i)
    if (q_[i] <= q_[row]) row = i;
  int entering = complement(basis_[row]);
  pivot(row, artificial());
  while (pivots_ < most_pivots + 10 * n_) {
    if (pivots_ % refactorisation_interval == 0) refactorise();
    enter(entering);
    row = leaving_row();
    if (row == none) return LcpOutcome::ray;
    const int leaving = basis_[row];
    pivot(row, entering);
    if (leaving == artificial() || artificial_vanished()) {
      read_solution(z);
      return LcpOutcome::solved;
    }
    entering = complement(leaving);
  }
  return LcpOutcome::iteration_limit;
}

// Columns of I w - M z - 1 z0 = q, expressed in the basis
void LemkeLcp::enter(int variable) {
  const auto inverse = inverse_.view();
  if (variable < n_)
    column_.view() = inverse.col(variable);
  else if (variable == artificial())
    column_.view() = -inverse.rowwise().sum();
  else
    column_.view().noalias() = -(inverse * M_.view().col(variable - n_));
}

// z0 that is basic with a value of rounding: a degenerate basis in which the problem is solved
bool LemkeLcp::artificial_vanished() const {
  const auto row = std::find(basis_.begin(), basis_.end(), artificial()) - basis_.begin();
  return x_[static_cast<int>(row)] <= value_tolerance * x_.view().cwiseAbs().maxCoeff();
}

int LemkeLcp::leaving_row() const {
  const double largest = column_.view().cwiseAbs().maxCoeff();
  const double zero = value_tolerance * x_.view().cwiseAbs().maxCoeff();
  double least = 0.0;
  int best = none;
  for (int i = 0; i < n_; ++i) {
    if (!(column_[i] > least_pivot_ * largest)) continue;
    const double ratio = x_[i] > zero ? x_[i] / column_[i] : 0.0;
    if (best == none) {
      best = i;
      least = ratio;
      continue;
    }
    const bool tie = std::abs(ratio - least) <= tie_tolerance * std::max(std::abs(ratio), std::abs(least));
    const bool better =
        tie ? basis_[best] != artificial() && (basis_[i] == artificial() || lexicographically_less(i, best))
            : ratio < least;
    if (!better) continue;
    best = i;
    least = tie ? std::min(ratio, least) : ratio;
  }
  return best;
}

// Rows of the inverse over the entering column: the first entries that differ by more than rounding decide.
bool LemkeLcp::lexicographically_less(int a, int b) const {
  const auto left = inverse_.view().row(a) / column_[a];
  const auto right = inverse_.view().row(b) / column_[b];
  const double rounding = tie_tolerance * std::max(left.cwiseAbs().maxCoeff(), right.cwiseAbs().maxCoeff());
  for (int j = 0; j < n_; ++j)
    if (std::abs(left[j] - right[j]) > rounding) return left[j] < right[j];
  return false;
}

void LemkeLcp::pivot(int row, int entering) {
  const double reciprocal = 1.0 / column_[row];
  auto pivot_row = inverse_.view().row(row);
  pivot_row *= reciprocal;
  x_[row] *= reciprocal;
  for (int i = 0; i < n_; ++i) {
    if (i == row || column_[i] == 0.0) continue;
    inverse_.view().row(i) -= column_[i] * pivot_row;
    x_[i] -= column_[i] * x_[row];
  }
  basis_[row] = entering;
  ++pivots_;
}

// The inverse from M itself: what many updates have lost comes back.
void LemkeLcp::refactorise() {
  Matrix B(n_, n_);
  for (int i = 0; i < n_; ++i) {
    const int variable = basis_[i];
    if (variable < n_)
      B.col(i) = Vec::Unit(n_, variable);
    else if (variable == artificial())
      B.col(i).setConstant(-1.0);
    else
      B.col(i) = -M_.view().col(variable - n_);
  }
  const Eigen::PartialPivLU<Matrix> lu(B);
  const Matrix inverse = lu.inverse();
  if (!inverse.allFinite()) return;  // singular to rounding: the updated one is the better of the two
  inverse_.view() = inverse;
  x_.view().noalias() = inverse * q_.view();
}

// z of the final basis: M_BB z_B = -q_B, factorised afresh and refined
void LemkeLcp::read_solution(double* z) {
  std::vector<int> rows;
  for (int i = 0; i < n_; ++i)
    if (basis_[i] >= n_ && basis_[i] != artificial()) rows.push_back(basis_[i] - n_);
  std::sort(rows.begin(), rows.end());
  const Matrix A = M_.view()(rows, rows);
  const Vec right = -q_.view()(rows);
  const Eigen::PartialPivLU<Matrix> lu(A);
  Vec x = lu.solve(right);
  for (int k = 0; k < refinements; ++k) x += lu.solve(right - A * x);
  if (!x.allFinite()) {  // a singular basis: the values of the path are what there is
    x.setZero();
    for (int i = 0; i < n_; ++i) {
      const auto place = std::find(rows.begin(), rows.end(), basis_[i] - n_);
      if (basis_[i] >= n_ && place != rows.end()) x[place - rows.begin()] = x_[i];
    }
  }
  for (std::size_t k = 0; k < rows.size(); ++k)
    z[rows[k]] = scale_[rows[k]] * std::max(x[static_cast<int>(k)], 0.0);
}

}  // namespace saltus
