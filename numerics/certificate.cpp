#include "saltus/numerics/certificate.hpp"

#include <algorithm>
#include <cmath>

namespace saltus {
namespace {

double tangential_residual(double d, double radius, const double* P, const double* xi, int count) {
  double arg[2] = {0.0, 0.0};
  double length = 0.0;
  for (int k = 0; k < count; ++k) {
    arg[k] = d * P[k] - xi[k];
    length = std::hypot(length, arg[k]);
  }
  const double shrink = length <= radius ? 1.0 : radius / length;  // proj_{C_T}, (34)-(35); NaN stays
  double residual = 0.0;
  for (int k = 0; k < count; ++k) residual = std::hypot(residual, d * P[k] - shrink * arg[k]);
  return residual;
}

}  // namespace

double contact_scale(const ContactProblem& problem, int row, int rows) {
  double d = 0.0;
  for (int k = row; k < row + rows; ++k) d = std::max(d, std::abs(entry(problem, k, k)));
  return d > 0.0 ? d : 1.0;
}

Certificate certify(const ContactProblem& problem, const double* P, double* xi) {
  const int rows = problem.rows();
  Certificate certificate;
  for (int i = 0; i < rows; ++i) {
    double sum = problem.b[i];
    double size = std::abs(sum);
    for_row(problem, i, [&](int j, double entry) {
      sum += entry * P[j];
      size += std::abs(entry * P[j]);
    });
    xi[i] = sum;
    certificate.scale = std::max(certificate.scale, size);
  }
  // A NaN must not get lost, neither the new one nor the old one.
  auto take = [&](double value) {
    if (!std::isnan(certificate.residual) && !(value <= certificate.residual)) certificate.residual = value;
  };
  int row = 0;
  for (const ContactSet& set : problem.sets) {
    const int count = rows_of(set);
    if (std::holds_alternative<Equality>(set)) {
      take(std::abs(xi[row]));
    } else {
      const double d = contact_scale(problem, row, count);
      take(std::abs(std::min(xi[row], d * P[row])));
      if (std::isnan(xi[row] + P[row])) take(xi[row] + P[row]);
      if (const auto* law = std::get_if<Coulomb>(&set)) {
        const double radius = law->mu * (d * std::max(P[row], 0.0));  // no infinity times zero
        take(tangential_residual(d, radius, P + row + 1, xi + row + 1, count - 1));
      }
    }
    row += count;
  }
  return certificate;
}

}  // namespace saltus
