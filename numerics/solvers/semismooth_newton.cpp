#include "saltus/numerics/solvers/semismooth_newton.hpp"

#include <algorithm>
#include <cmath>

namespace saltus {
namespace {

// Regular problems take two to five iterations; a path this long is a cycle.
constexpr int most_iterations = 40;

// Do the modes alone determine the equations?
bool linear(const std::vector<Mode>& modes) {
  return std::find(modes.begin(), modes.end(), Mode::slip_space) == modes.end();
}

}  // namespace

void SemismoothNewton::reserve(int rows) {
  active_.reserve(rows);
  next_.reserve(rows);
  xi_.reserve(rows);
}

void SemismoothNewton::read_modes(const ContactProblem& problem, const double* P) {
  next_.resize(problem.contacts());
  active_.slips().resize(problem.contacts());
  int row = 0;
  for (int k = 0; k < problem.contacts(); ++k) {
    const int rows = rows_of(problem.sets[k]);
    const double d = contact_scale(problem, row, rows);
    next_[k] = read_mode(problem.sets[k], d, P + row, xi_.data() + row, active_.slips()[k]);
    row += rows;
  }
}

SolveReport SemismoothNewton::solve(const ContactProblem& problem, double* P) {
  xi_.resize(problem.rows());
  SolveReport report{.solver = name()};
  active_.modes().clear();
  for (;; ++report.iterations) {
    report.certificate = certify(problem, P, xi_.data());
    if (report.certificate.within(problem.tolerance)) return report;
    if (report.iterations == most_iterations) {
      report.status = SolveStatus::iteration_limit;
      return report;
    }
    read_modes(problem, P);
    if (next_ == active_.modes() && linear(next_)) {  // the equations of these modes have no better P
      report.status = SolveStatus::breakdown;
      return report;
    }
    active_.modes().swap(next_);
    active_.solve(problem, P);
  }
}

}  // namespace saltus
