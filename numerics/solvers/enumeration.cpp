#include "saltus/numerics/solvers/enumeration.hpp"

#include <algorithm>

namespace saltus {
namespace {

constexpr long most_combinations = 1L << 16;
constexpr Mode normal_modes[] = {Mode::closed, Mode::open};
constexpr Mode coulomb_modes[] = {Mode::closed, Mode::slip_plus, Mode::slip_minus, Mode::open};

int choices(const ContactSet& set) {
  if (std::holds_alternative<Equality>(set)) return 1;
  return std::holds_alternative<NonNegative>(set) ? 2 : 4;
}

Mode choice(const ContactSet& set, long index) {
  return std::holds_alternative<Coulomb>(set) ? coulomb_modes[index] : normal_modes[index];
}

long combinations(const ContactProblem& problem) {
  long count = 1;
  for (const ContactSet& set : problem.sets) count = std::min(count * choices(set), 2 * most_combinations);
  return count;
}

}  // namespace

bool Enumeration::accepts(const ContactProblem& problem) const {
  return only_plane_friction(problem) && combinations(problem) <= most_combinations;
}

void Enumeration::reserve(int rows) {
  active_.reserve(rows);
  xi_.reserve(rows);
  trial_.reserve(rows);
}

SolveReport Enumeration::solve(const ContactProblem& problem, double* P) {
  const int rows = problem.rows();
  xi_.resize(rows);
  trial_.resize(rows);
  active_.modes().resize(problem.contacts());
  SolveReport report{.solver = name()};
  report.certificate = certify(problem, P, xi_.data());
  const long count = combinations(problem);
  for (long index = 0; index < count; ++index) {
    ++report.iterations;
    long rest = index;
    for (int k = 0; k < problem.contacts(); ++k) {
      active_.modes()[k] = choice(problem.sets[k], rest % choices(problem.sets[k]));
      rest /= choices(problem.sets[k]);
    }
    std::fill_n(trial_.data(), rows, 0.0);
    active_.solve(problem, trial_.data());
    if (keep_if_better(problem, trial_.data(), xi_.data(), report, P)) return report;
  }
  if (!report.certificate.within(problem.tolerance)) report.status = SolveStatus::breakdown;
  return report;
}

}  // namespace saltus
