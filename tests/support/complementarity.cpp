#include "support/complementarity.hpp"

#include <algorithm>
#include <array>
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

// Coulomb's law for tangential velocity u and force f (as a velocity) inside radius r: in sliding the force
// is all that the cone allows and opposes u. Slow sliding has a direction only as far as u is known: the part
// of u across the force counts, not the angle.
double tangential_violation(const std::array<double, 2>& u, const std::array<double, 2>& f, double r) {
  const double speed = std::hypot(u[0], u[1]), force = std::hypot(f[0], f[1]);
  const double outside = std::max(0.0, force - r);
  if (speed == 0.0) return outside;
  const double lacking = std::min(speed, std::abs(force - r));
  const double driving = f[0] * u[0] + f[1] * u[1] > 0.0 ? std::min(speed, force) : 0.0;
  const double across = std::abs(f[0] * u[1] - f[1] * u[0]) / std::max(speed, r);
  return std::max({outside, lacking, driving, across});
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
        std::array<double, 2> u{}, f{};
        for (int k = 1; k < rows; ++k) {
          u[k - 1] = xi[row + k];
          f[k - 1] = d * P[row + k];
        }
        worst = std::max(worst, tangential_violation(u, f, law->mu * d * std::max(P[row], 0.0)));
      }
    }
    row += rows;
  }
  return worst;
}

Matrix tangents_turned_by(double angle, const ContactProblem& problem) {
  Matrix R = Matrix::Identity(problem.rows(), problem.rows());
  int row = 0;
  for (const ContactSet& set : problem.sets) {
    if (rows_of(set) == 3) {
      R(row + 1, row + 1) = R(row + 2, row + 2) = std::cos(angle);
      R(row + 1, row + 2) = std::sin(angle);
      R(row + 2, row + 1) = -std::sin(angle);
    }
    row += rows_of(set);
  }
  return R;
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
  if (kind.friction && choice < 0.7) {
    const double mu = kind.largest_mu * unit(random);
    return Coulomb{mu, kind.space > 0.0 && unit(random) < kind.space ? 3 : 2};
  }
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

ContactProblem with_sparse_rows(const ContactProblem& problem) {
  ContactProblem copy = problem;
  copy.G = {};
  for (int i = 0; i < problem.rows(); ++i) {
    for (int j = 0; j < problem.rows(); ++j)
      if (problem.G(i, j) != 0.0) copy.sparse.add(j, problem.G(i, j));
    copy.sparse.end_row();
  }
  return copy;
}

ContactProblem side_by_side(const std::vector<ContactProblem>& problems) {
  struct Place {
    std::size_t problem;
    int row;
  };
  std::vector<Place> places;
  std::vector<ContactSet> sets;
  std::vector<int> rows(problems.size(), 0);
  bool some_left = true;
  for (int k = 0; some_left; ++k) {
    some_left = false;
    for (std::size_t p = 0; p < problems.size(); ++p) {
      if (k >= problems[p].contacts()) continue;
      some_left = true;
      sets.push_back(problems[p].sets[k]);
      for (int i = 0; i < rows_of(sets.back()); ++i) places.push_back({p, rows[p]++});
    }
  }
  const int n = static_cast<int>(places.size());
  Matrix G = Matrix::Zero(n, n);
  Vec b(n);
  for (int i = 0; i < n; ++i) {
    b[i] = problems[places[i].problem].b[places[i].row];
    for (int j = 0; j < n; ++j)
      if (places[i].problem == places[j].problem)
        G(i, j) = problems[places[i].problem].G(places[i].row, places[j].row);
  }
  return problem_of(G, b, sets);
}

ContactProblem column_of_balls(int n, double weight) {
  ContactProblem problem;
  problem.sets.assign(n, NonNegative{});
  problem.b = Vec(Vec::Zero(n));
  problem.b[0] = -weight;
  for (int i = 0; i < n; ++i) {
    if (i > 0) problem.sparse.add(i - 1, -1.0);
    problem.sparse.add(i, i == 0 ? 1.0 : 2.0);
    if (i + 1 < n) problem.sparse.add(i + 1, -1.0);
    problem.sparse.end_row();
  }
  return problem;
}

}  // namespace saltus::test
