#include "saltus/numerics/solvers/prox_fixed_point.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace saltus {
namespace {

constexpr int window = 40;
constexpr double shrinking = 0.5, growing = 1.2;

double or_one(double scale) { return scale > 0.0 ? scale : 1.0; }

double relative_velocity(const ContactProblem& problem, int row, const double* P) {
  const double* G = problem.G.row(row);
  double sum = problem.b[row];
  for (int j = 0; j < problem.rows(); ++j) sum += G[j] * P[j];
  return sum;
}

}  // namespace

void ProxFixedPoint::reserve(int rows) {
  scales_.reserve(rows);
  xi_.reserve(rows);
  best_.reserve(rows);
}

void ProxFixedPoint::measure(const ContactProblem& problem) {
  scales_.clear();
  int row = 0;
  for (const ContactSet& set : problem.sets) {
    const int end = row + rows_of(set);
    double tangential = 0.0;
    for (int i = row + 1; i < end; ++i) {
      double sum = 0.0;
      for (int j = row + 1; j < end; ++j) sum += std::abs(problem.G(i, j));
      tangential = std::max(tangential, sum);
    }
    scales_.push_back({or_one(std::abs(problem.G(row, row))), or_one(tangential)});
    row = end;
  }
}

void ProxFixedPoint::sweep(const ContactProblem& problem, double omega, double* P) const {
  int row = 0;
  for (int k = 0; k < problem.contacts(); ++k) {
    const ContactSet& set = problem.sets[k];
    const double r_N = omega / scales_[k].normal, r_T = omega / scales_[k].tangential;
    P[row] -= r_N * relative_velocity(problem, row, P);
    if (!std::holds_alternative<Equality>(set)) P[row] = std::max(P[row], 0.0);  // (69), (71)
    if (const auto* law = std::get_if<Coulomb>(&set)) {
      double xi[2] = {0.0, 0.0}, length = 0.0;
      for (int i = 1; i < law->dim; ++i) xi[i - 1] = relative_velocity(problem, row + i, P);
      for (int i = 1; i < law->dim; ++i) {
        P[row + i] -= r_T * xi[i - 1];
        length = std::hypot(length, P[row + i]);
      }
      const double radius = law->mu * P[row];
      if (length > radius)  // (70), (72)
        for (int i = 1; i < law->dim; ++i) P[row + i] *= radius / length;
    }
    row += rows_of(set);
  }
}

SolveReport ProxFixedPoint::solve(const ContactProblem& problem, double* P) {
  const int rows = problem.rows();
  xi_.resize(rows);
  best_.resize(rows);
  std::copy_n(P, rows, best_.data());  // where all residuals overflow the start is as good as any
  measure(problem);
  SolveReport report{.solver = name()};
  double omega = 1.0, best = std::numeric_limits<double>::infinity();
  for (;; ++report.iterations) {
    report.certificate = certify(problem, P, xi_.data());
    if (report.certificate.within(problem.tolerance)) return report;
    if (report.iterations % window == 0) {
      if (report.certificate.residual < best) {
        best = report.certificate.residual;
        std::copy_n(P, rows, best_.data());
        omega = std::min(1.0, growing * omega);
      } else {
        std::copy_n(best_.data(), rows, P);
        omega *= shrinking;
      }
    }
    if (report.iterations == sweeps_) break;
    sweep(problem, omega, P);
  }
  std::copy_n(best_.data(), rows, P);
  report.certificate = certify(problem, P, xi_.data());
  report.status = SolveStatus::iteration_limit;
  return report;
}

}  // namespace saltus
