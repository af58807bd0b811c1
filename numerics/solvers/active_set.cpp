#include "saltus/numerics/solvers/active_set.hpp"

#include <algorithm>

namespace saltus {

bool ActiveSet::accepts(const ContactProblem& problem) {
  return std::all_of(problem.sets.begin(), problem.sets.end(), [](const ContactSet& set) {
    const auto* law = std::get_if<Coulomb>(&set);
    return !law || law->dim == 2;
  });
}

void ActiveSet::reserve(int rows) {
  modes_.reserve(rows);
  unknowns_.reserve(rows);
  linear_.reserve(rows);
}

void ActiveSet::solve(const ContactProblem& problem, double* P) {
  unknowns_.clear();
  int row = 0;
  for (int k = 0; k < problem.contacts(); ++k) {
    const auto* law = std::get_if<Coulomb>(&problem.sets[k]);
    if (modes_[k] == Mode::closed) {
      unknowns_.push_back({row, 0.0});
      if (law) unknowns_.push_back({row + 1, 0.0});
    } else if (modes_[k] != Mode::open) {
      unknowns_.push_back({row, modes_[k] == Mode::slip_plus ? law->mu : -law->mu});
    }
    row += rows_of(problem.sets[k]);
  }
  const int n = static_cast<int>(unknowns_.size());
  linear_.resize(n);
  for (int i = 0; i < n; ++i) {
    const double* G = problem.G.row(unknowns_[i].row);
    for (int j = 0; j < n; ++j) {
      const auto [column, slip] = unknowns_[j];
      linear_.A()(i, j) = slip == 0.0 ? G[column] : G[column] + slip * G[column + 1];
    }
    linear_.y()[i] = -problem.b[unknowns_[i].row];
    linear_.start()[i] = P[unknowns_[i].row];
  }
  const double* x = linear_.solve();
  std::fill_n(P, problem.rows(), 0.0);
  for (int j = 0; j < n; ++j) {
    const auto [column, slip] = unknowns_[j];
    P[column] = x[j];
    if (slip != 0.0) P[column + 1] = slip * x[j];
  }
}

}  // namespace saltus
