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
