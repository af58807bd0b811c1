#include <cmath>
#include <initializer_list>
#include <stdexcept>

#include "saltus/kernel/integrators/half_explicit/tableau.hpp"
#include "saltus/numerics/text.hpp"

namespace saltus {
namespace {

// Beyond these a run is nothing but rounding.
constexpr double least_weight = 1e-6, largest_entry = 1e3;

}  // namespace

Tableau trapezoidal_tableau() {
  Tableau t{"trapezoidal", Matrix(2, 2), Matrix(2, 2), Matrix(2, 2), Vec(2)};
  t.Ac << 1.0, 0.0,  // q_{i-1} + Δt v_{i-1}, only in W of (69)-(70), (A.2)
      0.5, 0.5;      // (64)
  t.Av << 1.0, 0.0,  // (66)
      0.5, 0.5;      // (67)
  t.Aq << 0.5, 0.5,  // (63)
      0.5, 0.5;      // (64)
  t.c << 0.0, 1.0;
  return t;
}

Tableau runge_kutta(std::string name, const Matrix& A, const Vec& b) {
  auto refuse = [&](const std::string& why) {
    throw std::invalid_argument("tableau '" + name + "': " + why);
  };
  const Eigen::Index n = b.size();
  if (n < 1) refuse("needs at least one stage");
  if (A.rows() != n || A.cols() != n)
    refuse("A must be (" + std::to_string(n) + ", " + std::to_string(n) + ") as b has " + std::to_string(n) +
           " entries, got (" + std::to_string(A.rows()) + ", " + std::to_string(A.cols()) + ")");
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!std::isfinite(b[i])) refuse("b[" + std::to_string(i) + "] must be finite, got " + number(b[i]));
    for (Eigen::Index j = 0; j < n; ++j) {
      const std::string entry = "A[" + std::to_string(i) + ", " + std::to_string(j) + "] must be ";
      if (!std::isfinite(A(i, j))) refuse(entry + "finite, got " + number(A(i, j)));
      if (j >= i && A(i, j) != 0.0)
        refuse(entry + "0, on or above the diagonal of an explicit method, got " + number(A(i, j)));
    }
  }
  Matrix rows(n, n);
  rows << A.bottomRows(n - 1), b.transpose();
  return {std::move(name), rows, rows, rows, A.rowwise().sum()};
}

namespace {

// Rows of A below the first, entries left of the diagonal one after the other, then b.
Tableau from_entries(std::string name, int stages, std::initializer_list<double> entries) {
  Matrix A = Matrix::Zero(stages, stages);
  auto next = entries.begin();
  for (int i = 1; i < stages; ++i)
    for (int j = 0; j < i; ++j) A(i, j) = *next++;
  return runge_kutta(std::move(name), A, Eigen::Map<const Vec>(next, stages));
}

}  // namespace

Tableau heun_tableau() { return from_entries("Heun", 2, {1.0, /**/ 0.5, 0.5}); }

Tableau third_order_tableau() {
  return from_entries("third-order", 3, {1.0 / 3, -1.0, 2.0, /**/ 0.0, 0.75, 0.25});
}

Tableau kutta3_tableau() {
  return from_entries("Kutta3", 3, {0.5, -1.0, 2.0, /**/ 1.0 / 6, 2.0 / 3, 1.0 / 6});
}

Tableau rk4_tableau() {
  return from_entries("RK4", 4, {0.5, 0.0, 0.5, 0.0, 0.0, 1.0, /**/ 1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6});
}

// Brasey, thesis, Geneva 1992; Brasey and Hairer, SIAM J. Numer. Anal. 30 (1993)
Tableau hem5_tableau() {
  // clang-format off
  return from_entries("HEM5", 8, {
      0.1,
      0.0375, 0.1125,
      0.3222169236216038, -1.188883322987607, 1.228145134023366,
      -0.03501123898129943, 0.3725420601086163, -0.2721053535582034, 0.01993037578575077,
      -0.5576547055042005, 1.367307289645883, -1.732236360460725, 0.4587772007467548, 0.9638065755722880,
      0.08654517193566155, -0.08810082847945416, 0.1981275547329404, -0.4645422679331083, 0.1615170091109488,
      0.9064533606330119,
      0.0, 0.0, 0.0, 3.624477248753816, -0.4617724189181256, -3.198024628164272, 1.035319798328740,
      // b
      0.0, 0.0, 0.0, 0.2467760667636791, 0.2106594087489728, 0.1769218149125021, 0.3064446444147922,
      0.05919806516005373});
  // clang-format on
}

void validate(const Tableau& t) {
  const int n = t.stages();
  auto refuse = [&](const std::string& why) {
    throw std::invalid_argument("tableau '" + t.name + "': " + why);
  };
  if (n < 1) refuse("needs at least one stage");
  for (const Matrix* A : {&t.Ac, &t.Av, &t.Aq})
    if (A->rows() != n || A->cols() != n)
      refuse("coefficients must be (" + std::to_string(n) + ", " + std::to_string(n) + "), got (" +
             std::to_string(A->rows()) + ", " + std::to_string(A->cols()) + ")");
  for (int l = 1; l <= n; ++l) {
    const std::string row = "row " + std::to_string(l);
    const double time = l < n ? t.c[l] : 1.0;
    for (const Matrix* A : {&t.Ac, &t.Av, &t.Aq}) {
      if (!(std::abs(A->row(l - 1).sum() - time) < 1e-12)) refuse(row + " must sum up to " + number(time));
      const int known = A == &t.Aq ? l + 1 : l;  // stages that a row may use: q_l may use v_l
      if (!t.coupled && known < n && A->row(l - 1).tail(n - known).any())
        refuse(row + " uses a stage that comes after it");
    }
    const double multiplier = t.Av(l - 1, l - 1);
    if (!(multiplier > 0.0)) refuse("a_{l,l-1} must be positive in " + row + ", got " + number(multiplier));
    if (multiplier < least_weight)
      refuse("a_{l,l-1} must be at least " + number(least_weight) + " in " + row + ", got " +
             number(multiplier));
    for (const Matrix* A : {&t.Ac, &t.Av, &t.Aq})
      if (const double largest = A->row(l - 1).cwiseAbs().maxCoeff(); !(largest <= largest_entry))
        refuse("entries must not exceed " + number(largest_entry) + ", got " + number(largest) + " in " +
               row);
  }
}

}  // namespace saltus
