#include "saltus/numerics/solvers/semismooth_newton.hpp"

#include <cmath>

namespace saltus {
namespace {

// Regular problems take two to five iterations; a path this long is a cycle.
constexpr int most_iterations = 40;

Mode mode_of(const ContactSet& set, double d, const double* P, const double* xi) {
  if (std::holds_alternative<Equality>(set)) return Mode::closed;
  if (!(d * P[0] - xi[0] > 0.0)) return Mode::open;  // argument of the projection in (31)
  const auto* law = std::get_if<Coulomb>(&set);
  if (!law) return Mode::closed;
  const double tangential = d * P[1] - xi[1];  // argument of the projection in (32)
  if (std::abs(tangential) <= law->mu * d * std::max(P[0], 0.0)) return Mode::closed;
  return tangential > 0.0 ? Mode::slip_plus : Mode::slip_minus;
}

}  // namespace

void SemismoothNewton::reserve(int rows) {
  active_.reserve(rows);
  next_.reserve(rows);
  xi_.reserve(rows);
}

void SemismoothNewton::read_modes(const ContactProblem& problem, const double* P,
                                  std::vector<Mode>& modes) const {
  modes.resize(problem.contacts());
  int row = 0;
  for (int k = 0; k < problem.contacts(); ++k) {
    const int rows = rows_of(problem.sets[k]);
    const double d = contact_scale(problem.G, row, rows);
    modes[k] = mode_of(problem.sets[k], d, P + row, xi_.data() + row);
    row += rows;
  }
}

SolveReport SemismoothNewton::solve(const ContactProblem& problem, double* P) {
  xi_.resize(problem.rows());
  SolveReport report{.solver = name()};
  active_.modes().clear();
  for (;; ++report.iterations) {
    report.certificate = certify(problem, P, xi_.data());
    if (report.certificate.within(default_tolerance)) return report;
    if (report.iterations == most_iterations) {
      report.status = SolveStatus::iteration_limit;
      return report;
    }
    read_modes(problem, P, next_);
    if (next_ == active_.modes()) {  // the equations of these modes have no better P
      report.status = SolveStatus::breakdown;
      return report;
    }
    active_.modes().swap(next_);
    active_.solve(problem, P);
  }
}

}  // namespace saltus
