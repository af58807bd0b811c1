#include "saltus/numerics/solvers/nsgs.hpp"

#include <cmath>

#include "saltus/numerics/solvers/active_set.hpp"

namespace saltus {
namespace {

// Plane Coulomb contact: open, stick or slip, each tried in turn.
bool solve_one_coulomb(double mu, const double* G, int stride, const double* c, double* P) {
  if (c[0] >= 0.0) {
    P[0] = P[1] = 0.0;
    return true;
  }
  const double* T = G + stride;
  const double det = G[0] * T[1] - G[1] * T[0];
  if (det != 0.0) {
    const double normal = (-c[0] * T[1] + G[1] * c[1]) / det;
    const double tangential = (-c[1] * G[0] + T[0] * c[0]) / det;
    if (normal >= 0.0 && std::abs(tangential) <= mu * normal) {
      P[0] = normal;
      P[1] = tangential;
      return true;
    }
  }
  for (const double slip : {mu, -mu}) {
    const double effective = G[0] + slip * G[1];
    if (!(effective > 0.0)) continue;
    const double normal = -c[0] / effective;
    const double xi_T = (T[0] + slip * T[1]) * normal + c[1];
    if (slip * xi_T > 0.0) continue;  // friction must oppose the sliding
    P[0] = normal;
    P[1] = slip * normal;
    return true;
  }
  return false;
}

}  // namespace

bool solve_one_contact(const ContactSet& set, const double* G, int stride, const double* c, double* P) {
  if (const auto* law = std::get_if<Coulomb>(&set)) return solve_one_coulomb(law->mu, G, stride, c, P);
  if (std::holds_alternative<NonNegative>(set) && c[0] >= 0.0) {
    P[0] = 0.0;
    return true;
  }
  if (!(G[0] > 0.0)) return false;
  P[0] = -c[0] / G[0];
  return true;
}

bool Nsgs::accepts(const ContactProblem& problem) const { return ActiveSet::accepts(problem); }

SolveReport Nsgs::solve(const ContactProblem& problem, double* P) {
  xi_.resize(problem.rows());
  SolveReport report{.solver = name()};
  for (;; ++report.iterations) {
    report.certificate = certify(problem, P, xi_.data());
    if (report.certificate.within(default_tolerance)) return report;
    if (report.iterations == sweeps_) break;
    int row = 0;
    for (const ContactSet& set : problem.sets) {
      const int rows = rows_of(set);
      double c[2] = {0.0, 0.0};  // xi of this contact without its own P
      for (int i = 0; i < rows; ++i) {
        const double* G = problem.G.row(row + i);
        c[i] = problem.b[row + i];
        for (int j = 0; j < problem.rows(); ++j)
          if (j < row || j >= row + rows) c[i] += G[j] * P[j];
      }
      solve_one_contact(set, problem.G.row(row) + row, problem.rows(), c, P + row);
      row += rows;
    }
  }
  report.status = SolveStatus::iteration_limit;
  return report;
}

}  // namespace saltus
