#include "saltus/numerics/solvers/semismooth_newton.hpp"

#include <algorithm>
#include <cmath>

namespace saltus {
namespace {

// Regular problems take two to five iterations; a path this long is a cycle.
constexpr int most_iterations = 40;

// Argument of the projection in (32) outside the disc: the derivative of y -> radius y/|y| is radius/|y|
// times the projection across y.
Mode mode_in_space(const Coulomb& law, double d, const double* P, const double* xi, Slip& slip) {
  const double first = d * P[1] - xi[1], second = d * P[2] - xi[2];
  const double length = std::hypot(first, second);
  const double radius = law.mu * d * std::max(P[0], 0.0);
  if (length <= radius) return Mode::closed;
  slip = {{first / length, second / length}, radius / length, d * (1.0 - radius / length)};
  return Mode::slip_space;
}

Mode mode_of(const ContactSet& set, double d, const double* P, const double* xi, Slip& slip) {
  if (std::holds_alternative<Equality>(set)) return Mode::closed;
  if (!(d * P[0] - xi[0] > 0.0)) return Mode::open;  // argument of the projection in (31)
  const auto* law = std::get_if<Coulomb>(&set);
  if (!law) return Mode::closed;
  if (law->dim == 3) return mode_in_space(*law, d, P, xi, slip);
  const double tangential = d * P[1] - xi[1];  // argument of the projection in (32)
  if (std::abs(tangential) <= law->mu * d * std::max(P[0], 0.0)) return Mode::closed;
  return tangential > 0.0 ? Mode::slip_plus : Mode::slip_minus;
}

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
    const double d = contact_scale(problem.G, row, rows);
    next_[k] = mode_of(problem.sets[k], d, P + row, xi_.data() + row, active_.slips()[k]);
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
