#include "saltus/numerics/solvers/nsgs.hpp"

#include <algorithm>

#include "saltus/numerics/solvers/one_contact.hpp"

namespace saltus {

void sweep(const ContactProblem& problem, double* P) {
  int row = 0;
  for (const ContactSet& set : problem.sets) {
    const int rows = rows_of(set);
    double c[3] = {0.0, 0.0, 0.0};  // xi of this contact without its own P
    double own[9];                  // its block of G
    for (int i = 0; i < rows; ++i) {
      c[i] = problem.b[row + i];
      std::fill_n(own + 3 * i, 3, 0.0);
      for_row(problem, row + i, [&](int j, double entry) {
        if (j >= row && j < row + rows)
          own[3 * i + j - row] = entry;
        else
          c[i] += entry * P[j];
      });
    }
    solve_one_contact(set, own, 3, c, P + row);
    row += rows;
  }
}

SolveReport Nsgs::solve(const ContactProblem& problem, double* P) {
  xi_.resize(problem.rows());
  SolveReport report{.solver = name()};
  for (;; ++report.iterations) {
    report.certificate = certify(problem, P, xi_.data());
    if (report.certificate.within(problem.tolerance)) return report;
    if (report.iterations == sweeps_) break;
    sweep(problem, P);
  }
  report.status = SolveStatus::iteration_limit;
  return report;
}

}  // namespace saltus
