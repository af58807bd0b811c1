#include <cmath>
#include <stdexcept>

#include "saltus/kernel/integrators/half_explicit/tableau.hpp"
#include "saltus/numerics/text.hpp"

namespace saltus {

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
  const auto n = b.size();
  Tableau t{std::move(name), Matrix::Zero(n, n), {}, {}, A.rowwise().sum()};
  t.Ac.topRows(n - 1) = A.bottomRows(n - 1);
  t.Ac.row(n - 1) = b.transpose();
  t.Av = t.Aq = t.Ac;
  return t;
}
Tableau heun_tableau() {
  Matrix A = Matrix::Zero(2, 2);
  A(1, 0) = 1;
  return runge_kutta("Heun", A, (Vec(2) << 0.5, 0.5).finished());
}
Tableau third_order_tableau() {
  Matrix A = Matrix::Zero(3, 3);
  A(1, 0) = 1.0 / 3;
  A(2, 0) = -1;
  A(2, 1) = 2;
  return runge_kutta("third-order", A, (Vec(3) << 0, 0.75, 0.25).finished());
}
Tableau kutta3_tableau() {
  Matrix A = Matrix::Zero(3, 3);
  A(1, 0) = 1.0 / 2;
  A(2, 0) = -1;
  A(2, 1) = 2;
  return runge_kutta("Kutta3", A, (Vec(3) << 1. / 6, 4. / 6, 1. / 6).finished());
}
Tableau rk4_tableau() {
  Matrix A = Matrix::Zero(4, 4);
  A(1, 0) = 0.5;
  A(2, 1) = 0.5;
  A(3, 2) = 1;
  return runge_kutta("RK4", A, (Vec(4) << 1. / 6, 1. / 3, 1. / 3, 1. / 6).finished());
}
Tableau hem5_tableau() {
  Matrix A = Matrix::Zero(8, 8);
  A.row(1).head(1) << 0.1;
  A.row(2).head(2) << 0.0375, 0.1125;
  A.row(3).head(3) << 0.3222169236216038, -1.188883322987607, 1.228145134023366;
  A.row(4).head(4) << -0.03501123898129943, 0.3725420601086163, -0.2721053535582034, 0.01993037578575077;
  A.row(5).head(5) << -0.5576547055042005, 1.367307289645883, -1.732236360460725, 0.4587772007467548,
      0.9638065755722880;
  A.row(6).head(6) << 0.08654517193566155, -0.08810082847945416, 0.1981275547329404, -0.4645422679331083,
      0.1615170091109488, 0.9064533606330119;
  A.row(7).head(7) << 0, 0, 0, 3.624477248753816, -0.4617724189181256, -3.198024628164272, 1.035319798328740;
  return runge_kutta("HEM5", A,
                     (Vec(8) << 0, 0, 0, 0.2467760667636791, 0.2106594087489728, 0.1769218149125021,
                      0.3064446444147922, 0.05919806516005373)
                         .finished());
}
TableauOrder order_of(const Tableau& t) {
  if (t.name == "Heun") return {2, 2};
  if (t.name == "RK4") return {4, 3};
  if (t.name == "HEM5") return {5, 5};
  return {3, 3};
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
      if (known < n && A->row(l - 1).tail(n - known).any()) refuse(row + " uses a stage that comes after it");
    }
    const double multiplier = t.Av(l - 1, l - 1);
    if (!(multiplier > 0.0)) refuse("a_{l,l-1} must be positive in " + row + ", got " + number(multiplier));
  }
}

}  // namespace saltus
