#include "support/complementarity.hpp"

#include <algorithm>
#include <cmath>

namespace saltus::test {
namespace {

// Size of a contact's impulses as velocities, so that both sides of a law carry the same unit.
double mobility(const ContactProblem& problem, int row, int rows) {
  double d = 0.0;
  for (int k = row; k < row + rows; ++k) d = std::max(d, std::abs(problem.G(k, k)));
  return d > 0.0 ? d : 1.0;
}

// Normal law: xi >= 0, P >= 0, and not both above zero.
double normal_violation(double xi, double p) {
  return std::max({0.0, -xi, -p, std::min(std::abs(xi), std::abs(p))});
}

// Coulomb's law for tangential velocity u and force f (as a velocity) inside radius r.
double tangential_violation(const std::vector<double>& u, const std::vector<double>& f, double r) {
  double speed = 0.0, force = 0.0;
  for (double x : u) speed = std::hypot(speed, x);
  for (double x : f) force = std::hypot(force, x);
  const double outside = std::max(0.0, force - r);
  double against = 0.0;  // |f + r u/|u||: friction opposes the sliding with all that the cone allows
  for (std::size_t k = 0; k < u.size(); ++k)
    against = std::hypot(against, speed > 0.0 ? f[k] + r * u[k] / speed : 0.0);
  return std::max(outside, std::min(speed, against));
}

}  // namespace

std::vector<double> relative_velocities(const ContactProblem& problem, const std::vector<double>& P) {
  std::vector<double> xi(P.size());
  for (int i = 0; i < problem.rows(); ++i) {
    xi[i] = problem.b[i];
    for (int j = 0; j < problem.rows(); ++j) xi[i] += problem.G(i, j) * P[j];
  }
  return xi;
}

double terms(const ContactProblem& problem, const std::vector<double>& P) {
  double largest = 0.0;
  for (int i = 0; i < problem.rows(); ++i) {
    double sum = std::abs(problem.b[i]);
    for (int j = 0; j < problem.rows(); ++j) sum += std::abs(problem.G(i, j) * P[j]);
    largest = std::max(largest, sum);
  }
  return largest;
}

double violation(const ContactProblem& problem, const std::vector<double>& P) {
  const std::vector<double> xi = relative_velocities(problem, P);
  double worst = 0.0;
  int row = 0;
  for (const ContactSet& set : problem.sets) {
    const int rows = rows_of(set);
    const double d = mobility(problem, row, rows);
    if (std::holds_alternative<Equality>(set)) {
      worst = std::max(worst, std::abs(xi[row]));
    } else {
      worst = std::max(worst, normal_violation(xi[row], d * P[row]));
      if (const auto* law = std::get_if<Coulomb>(&set)) {
        std::vector<double> u, f;
        for (int k = row + 1; k < row + rows; ++k) {
          u.push_back(xi[k]);
          f.push_back(d * P[k]);
        }
        worst = std::max(worst, tangential_violation(u, f, law->mu * d * std::max(P[row], 0.0)));
      }
    }
    row += rows;
  }
  return worst;
}

ContactProblem problem_of(const Matrix& G, const Vec& b, std::vector<ContactSet> sets) {
  ContactProblem problem;
  problem.G = G;
  problem.b = b;
  problem.sets = std::move(sets);
  return problem;
}

namespace {

ContactSet random_set(std::mt19937& random, const ProblemKind& kind) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const double choice = unit(random);
  if (kind.equalities && choice < 0.2) return Equality{};
  if (kind.friction && choice < 0.7) return Coulomb{unit(random), 2};
  return NonNegative{};
}

}  // namespace

ContactProblem random_problem(std::mt19937& random, const ProblemKind& kind) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const int contacts = 1 + static_cast<int>(random() % 5);
  std::vector<ContactSet> sets;
  int rows = 0;
  for (int k = 0; k < contacts; ++k) {
    sets.push_back(k > 0 && k <= kind.dependent ? sets.back() : random_set(random, kind));
    rows += rows_of(sets.back());
  }
  const int n =
      kind.dependent > 0 ? 1 + static_cast<int>(random() % 6) : rows + static_cast<int>(random() % 3);
  Matrix W = Matrix::NullaryExpr(rows, n, [&] { return normal(random); });
  int row = rows_of(sets[0]);
  for (int k = 1; k < contacts; row += rows_of(sets[k]), ++k)
    if (k <= kind.dependent)
      W.middleRows(row, rows_of(sets[k])) = W.middleRows(row - rows_of(sets[k]), rows_of(sets[k]));
  const Matrix there = W + kind.moved * Matrix::NullaryExpr(rows, n, [&] { return normal(random); });
  const Vec mobility =
      Vec::NullaryExpr(n, [&] { return std::pow(10.0, kind.scale_spread * (2.0 * unit(random) - 1.0)); });
  const Vec v = Vec::NullaryExpr(n, [&] { return normal(random); });
  return problem_of(there * mobility.asDiagonal() * W.transpose(), there * v, sets);
}

}  // namespace saltus::test
