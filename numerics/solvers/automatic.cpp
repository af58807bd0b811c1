#include "saltus/numerics/solvers/automatic.hpp"

#include <algorithm>

namespace saltus {

void Automatic::reserve(int rows) {
  newton_.reserve(rows);
  enumeration_.reserve(rows);
  sweeps_.reserve(rows);
  trial_.reserve(rows);
  xi_.reserve(rows);
}

// One contact alone has a closed form.
SolveReport Automatic::solve_single(const ContactProblem& problem, double* P) {
  xi_.resize(problem.rows());
  SolveReport report{.iterations = 1, .solver = "single-contact"};
  const bool found =
      solve_one_contact(problem.sets[0], problem.G.row(0), problem.rows(), problem.b.data(), P);
  report.certificate = certify(problem, P, xi_.data());
  if (!found || !report.certificate.within(default_tolerance)) report.status = SolveStatus::breakdown;
  return report;
}

SolveReport Automatic::solve(const ContactProblem& problem, double* P) {
  SolveReport best = problem.contacts() == 1 ? solve_single(problem, P) : newton_.solve(problem, P);
  if (best.status == SolveStatus::solved) return best;

  const int rows = problem.rows();
  trial_.resize(rows);
  auto improved_by = [&](ContactSolver& method) {
    const SolveReport report = method.solve(problem, trial_.data());
    if (report.status == SolveStatus::solved || report.certificate.residual < best.certificate.residual) {
      best = report;
      std::copy_n(trial_.data(), rows, P);
    }
    return best.status == SolveStatus::solved;
  };
  std::fill_n(trial_.data(), rows, 0.0);
  if (improved_by(newton_)) return best;
  if (enumeration_.accepts(problem) && improved_by(enumeration_)) return best;
  std::fill_n(trial_.data(), rows, 0.0);
  if (improved_by(sweeps_)) return best;
  improved_by(newton_);  // from where the sweeps ended
  return best;
}

}  // namespace saltus
