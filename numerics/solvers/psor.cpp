#include "saltus/numerics/solvers/psor.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "saltus/numerics/text.hpp"

namespace saltus {
namespace {

constexpr int unwatched_sweeps = 4;  // a certificate costs as much as a sweep

struct Row {
  double xi;
  double own;  // diagonal entry, plus the absolute values beside it; 0 where the diagonal is not positive
};

// Row i of G P + b, and what stands in the columns first...end of G.
Row read_row(const ContactProblem& problem, int i, int first, int end, const double* P) {
  Row row{problem.b[i], 0.0};
  double diagonal = 0.0;
  for_row(problem, i, [&](int j, double entry) {
    row.xi += entry * P[j];
    if (j == i) diagonal = entry;
    if (j >= first && j < end) row.own += j == i ? entry : std::abs(entry);
  });
  if (!(diagonal > 0.0)) row.own = 0.0;
  return row;
}

// As above for an equality, where the sign does not matter.
Row read_equality(const ContactProblem& problem, int i, const double* P) {
  Row row{problem.b[i], 0.0};
  for_row(problem, i, [&](int j, double entry) {
    row.xi += entry * P[j];
    if (j == i) row.own = entry;
  });
  return row;
}

}  // namespace

Psor::Psor(double relaxation, int sweeps) : relaxation_(relaxation), sweeps_(sweeps) {
  if (!(relaxation > 0.0 && relaxation < 2.0))
    throw std::invalid_argument("the relaxation must be in (0, 2), got " + number(relaxation));
}

void Psor::reserve(int rows) {
  for (PoolVec* x : {&P_, &before_, &xi_}) x->reserve(rows);
}

SolveReport Psor::solve(const ContactProblem& problem, double* P) {
  const int rows = problem.rows();
  for (PoolVec* x : {&P_, &before_, &xi_}) x->resize(rows);
  std::copy_n(P, rows, P_.data());
  SolveReport report{.solver = name()};
  report.certificate = certify(problem, P, xi_.data());
  if (report.certificate.within(problem.tolerance)) return report;
  bool moves = true;
  while (moves && report.iterations < sweeps_) {
    for (int k = 0; k < unwatched_sweeps && moves && report.iterations < sweeps_; ++k) {
      moves = sweep(problem);
      ++report.iterations;
    }
    if (keep_if_better(problem, P_.data(), xi_.data(), report, P)) return report;
    moves = moves && P_.view().allFinite();
  }
  report.status = moves ? SolveStatus::iteration_limit : SolveStatus::breakdown;
  return report;
}

// @return false if nothing has changed
bool Psor::sweep(const ContactProblem& problem) {
  before_ = P_;
  int row = 0;
  for (const ContactSet& set : problem.sets) {
    const bool equality = std::holds_alternative<Equality>(set);
    const auto [xi, own] =
        equality ? read_equality(problem, row, P_.data()) : read_row(problem, row, row, row + 1, P_.data());
    if (own != 0.0) P_[row] -= relaxation_ * xi / own;
    if (!equality) P_[row] = std::max(P_[row], 0.0);
    if (const auto* law = std::get_if<Coulomb>(&set)) relax_friction(problem, row, *law);
    row += rows_of(set);
  }
  return !std::equal(P_.data(), P_.data() + row, before_.data());
}

void Psor::relax_friction(const ContactProblem& problem, int row, const Coulomb& law) {
  const int first = row + 1, end = row + law.dim;
  double xi[2] = {}, own = 0.0, length = 0.0;
  for (int i = first; i < end; ++i) {
    const Row read = read_row(problem, i, first, end, P_.data());
    xi[i - first] = read.xi;
    own = std::max(own, read.own);
  }
  for (int i = first; i < end; ++i) {
    if (own > 0.0) P_[i] -= relaxation_ * xi[i - first] / own;
    length = std::hypot(length, P_[i]);
  }
  const double radius = law.mu * P_[row];
  if (length > radius)
    for (int i = first; i < end; ++i) P_[i] *= radius / length;
}

}  // namespace saltus
