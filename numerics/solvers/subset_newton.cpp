#include "saltus/numerics/solvers/subset_newton.hpp"

#include <algorithm>
#include <bit>

namespace saltus {
namespace {

constexpr int most_contacts = 10;

int unilateral(const ContactProblem& problem) {
  const auto bilateral = std::count_if(problem.sets.begin(), problem.sets.end(), [](const ContactSet& set) {
    return std::holds_alternative<Equality>(set);
  });
  return problem.contacts() - static_cast<int>(bilateral);
}

}  // namespace

bool SubsetNewton::accepts(const ContactProblem& problem) const {
  return unilateral(problem) <= most_contacts;
}

void SubsetNewton::reserve(int rows) {
  newton_.reserve(rows);
  part_.G.reserve(rows, rows);
  part_.b.reserve(rows);
  part_.sets.reserve(rows);
  rows_.reserve(rows);
  for (PoolVec* x : {&part_P_, &trial_, &xi_}) x->reserve(rows);
}

SolveReport SubsetNewton::solve(const ContactProblem& problem, double* P) {
  const int rows = problem.rows(), contacts = unilateral(problem);
  xi_.resize(rows);
  trial_.resize(rows);
  SolveReport report{.solver = name()};
  report.certificate = certify(problem, P, xi_.data());
  for (int open = 0; open <= contacts; ++open) {
    for (unsigned subset = 0; subset < 1u << contacts; ++subset) {
      if (std::popcount(subset) != open) continue;
      choose(problem, subset);
      restrict_to_chosen(problem);
      std::fill_n(part_P_.data(), part_.rows(), 0.0);
      report.iterations += newton_.solve(part_, part_P_.data()).iterations;
      std::fill_n(trial_.data(), rows, 0.0);
      for (int i = 0; i < part_.rows(); ++i) trial_[rows_[i]] = part_P_[i];
      if (keep_if_better(problem, trial_.data(), xi_.data(), report, P)) return report;
    }
  }
  if (!report.certificate.within(problem.tolerance)) report.status = SolveStatus::breakdown;
  return report;
}

// Bit k of `opened` stands for the k-th unilateral contact.
void SubsetNewton::choose(const ContactProblem& problem, unsigned opened) {
  rows_.clear();
  part_.sets.clear();
  int row = 0;
  for (const ContactSet& set : problem.sets) {
    bool chosen = true;
    if (!std::holds_alternative<Equality>(set)) {
      chosen = (opened & 1u) == 0;
      opened >>= 1;
    }
    for (int i = 0; chosen && i < rows_of(set); ++i) rows_.push_back(row + i);
    if (chosen) part_.sets.push_back(set);
    row += rows_of(set);
  }
}

void SubsetNewton::restrict_to_chosen(const ContactProblem& problem) {
  const int rows = static_cast<int>(rows_.size());
  part_.tolerance = problem.tolerance;
  part_.G.resize(rows, rows);
  part_.b.resize(rows);
  part_P_.resize(rows);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < rows; ++j) part_.G(i, j) = problem.G(rows_[i], rows_[j]);
    part_.b[i] = problem.b[rows_[i]];
  }
}

}  // namespace saltus
