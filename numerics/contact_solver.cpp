#include "saltus/numerics/contact_solver.hpp"

#include <algorithm>

namespace saltus {

std::string_view to_string(SolveStatus status) {
  switch (status) {
    case SolveStatus::solved: return "solved";
    case SolveStatus::ray: return "ray";
    case SolveStatus::iteration_limit: return "iteration-limit";
    case SolveStatus::breakdown: break;
  }
  return "breakdown";
}

bool keep_if_better(const ContactProblem& problem, const double* trial, double* xi, SolveReport& report,
                    double* P) {
  const Certificate certificate = certify(problem, trial, xi);
  const bool solved = certificate.within(problem.tolerance);
  if (solved || certificate.better_than(report.certificate)) {
    report.certificate = certificate;
    std::copy_n(trial, problem.rows(), P);
  }
  return solved;
}

}  // namespace saltus
