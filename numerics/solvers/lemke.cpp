#include "saltus/numerics/solvers/lemke.hpp"

#include <Eigen/QR>
#include <algorithm>

namespace saltus {
namespace {

// Where M is singular but for rounding, the same path with another idea of what rounding is finds an end.
constexpr double least_pivots[] = {LemkeLcp::usual_pivot, 1e-8, 1e-14};

}  // namespace

bool Lemke::accepts(const ContactProblem& problem) const { return only_plane_friction(problem); }

void Lemke::reserve(int rows) {
  xi_.reserve(rows);
  trial_.reserve(rows);
  z_.reserve(2 * rows);  // three unknowns for the two rows of a frictional contact
  lcp_.reserve(2 * rows);
}

SolveReport Lemke::solve(const ContactProblem& problem, double* P) {
  const int rows = problem.rows();
  xi_.resize(rows);
  trial_.resize(rows);
  SolveReport report{.solver = name()};
  std::fill_n(P, rows, 0.0);
  report.certificate = certify(problem, P, xi_.data());
  LcpOutcome outcome = LcpOutcome::ray;
  for (const bool split : {false, true}) {
    if (split && !dependent_) break;
    split_ = split;
    for (const double least_pivot : least_pivots) {
      outcome = attempt(problem, least_pivot, trial_.data());
      report.iterations += lcp_.pivots();
      if (keep_if_better(problem, trial_.data(), xi_.data(), report, P)) return report;
      if (outcome == LcpOutcome::iteration_limit) break;
    }
  }
  if (report.certificate.within(problem.tolerance)) return report;  // P = 0
  report.status = outcome == LcpOutcome::ray               ? SolveStatus::ray
                  : outcome == LcpOutcome::iteration_limit ? SolveStatus::iteration_limit
                                                           : SolveStatus::breakdown;
  return report;
}

LcpOutcome Lemke::attempt(const ContactProblem& problem, double least_pivot, double* P) {
  eliminate_equalities(problem);
  choose_unknowns(problem);
  fill(problem);
  const LcpOutcome outcome = lcp_.solve(z_.data(), least_pivot);
  read(problem, P);
  return outcome;
}

// P_free = -G_ff⁺ (b_f + G_fr P_rest); least squares where equalities depend on each other
void Lemke::eliminate_equalities(const ContactProblem& problem) {
  free_.clear();
  rest_.clear();
  int row = 0;
  for (const ContactSet& set : problem.sets) {
    for (int i = 0; i < rows_of(set); ++i, ++row)
      (!split_ && std::holds_alternative<Equality>(set) ? free_ : rest_).push_back(row);
  }
  const auto G = problem.G.view();
  const auto b = problem.b.view();
  G_ = G(rest_, rest_);
  b_ = b(rest_);
  dependent_ = false;
  if (free_.empty()) return;
  const Matrix free = G(free_, free_);
  const Eigen::CompleteOrthogonalDecomposition<Matrix> decomposition(free);
  dependent_ = decomposition.rank() < free.rows();
  particular_ = -decomposition.solve(b(free_));
  elimination_.resize(free.rows(), G_.rows());
  if (rest_.empty()) return;
  elimination_ = -decomposition.solve(G(free_, rest_));
  G_ += G(rest_, free_) * elimination_;
  b_ += G(rest_, free_) * particular_;
}

// P of the contacts = T z
void Lemke::choose_unknowns(const ContactProblem& problem) {
  int size = 0;
  for (const ContactSet& set : problem.sets) {
    if (std::holds_alternative<Equality>(set))
      size += split_ ? 2 : 0;
    else
      size += std::holds_alternative<Coulomb>(set) ? 3 : 1;
  }
  lcp_.resize(size);
  z_.resize(size);
  T_.setZero(G_.rows(), size);
  int row = 0, at = 0;
  for (const ContactSet& set : problem.sets) {
    const bool equality = std::holds_alternative<Equality>(set);
    if (equality && !split_) continue;
    if (equality) T_(row, ++at) = -1.0;  // P = P⁺ − P⁻
    T_(row++, at - equality) = 1.0;
    if (const auto* law = std::get_if<Coulomb>(&set)) {
      T_(row, at) = -law->mu;  // P_T = σ⁺ − μ P_N
      T_(row++, at + 1) = 1.0;
      at += 2;
    }
    ++at;
  }
}

// Rows of w = M z + q
void Lemke::fill(const ContactProblem& problem) {
  auto M = lcp_.M().view();
  auto q = lcp_.q().view();
  M.setZero();
  q.setZero();
  const Matrix xi = G_ * T_;
  int row = 0, at = 0;
  for (const ContactSet& set : problem.sets) {
    const bool equality = std::holds_alternative<Equality>(set);
    if (equality && !split_) continue;
    M.row(at) = xi.row(row);
    q[at++] = b_[row++];
    if (equality) {
      M.row(at) = -xi.row(row - 1);
      q[at++] = -b_[row - 1];
    }
    if (const auto* law = std::get_if<Coulomb>(&set)) {
      M.row(at) = xi.row(row);  // ξ⁺ = ξ_T + ξ⁻
      M(at, at + 1) += 1.0;
      q[at++] = b_[row++];
      M(at, at - 2) = 2.0 * law->mu;  // σ⁻ = 2 μ P_N − σ⁺
      M(at, at - 1) = -1.0;
      ++at;
    }
  }
}

void Lemke::read(const ContactProblem& problem, double* P) {
  const Vec rest = T_ * z_.view();
  Out all(P, problem.rows());
  all(rest_) = rest;
  if (!free_.empty()) all(free_) = particular_ + elimination_ * rest;
}

}  // namespace saltus
