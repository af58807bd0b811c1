#include "saltus/numerics/contact_solver.hpp"

#include <algorithm>
#include <stdexcept>

#include "saltus/numerics/text.hpp"

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

void ContactSolver::set_tolerance(double tolerance) {
  if (!(tolerance > 0.0 && tolerance < 1.0))
    throw std::invalid_argument("the tolerance of contact problems must be in (0, 1), got " +
                                number(tolerance));
  tolerance_ = tolerance;
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
