#include "saltus/numerics/solvers/nsgs.hpp"

#include "saltus/numerics/solvers/one_contact.hpp"

namespace saltus {

SolveReport Nsgs::solve(const ContactProblem& problem, double* P) {
  xi_.resize(problem.rows());
  SolveReport report{.solver = name()};
  for (;; ++report.iterations) {
    report.certificate = certify(problem, P, xi_.data());
    if (report.certificate.within(problem.tolerance)) return report;
    if (report.iterations == sweeps_) break;
    int row = 0;
    for (const ContactSet& set : problem.sets) {
      const int rows = rows_of(set);
      double c[3] = {0.0, 0.0, 0.0};  // xi of this contact without its own P
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
