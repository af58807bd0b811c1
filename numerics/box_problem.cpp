#include "saltus/numerics/box_problem.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "saltus/numerics/text.hpp"

namespace saltus {
namespace {

constexpr int scaling_sweeps = 3;
// Of the solver's: a guess that it takes for solved must be within what is asked for.
constexpr double inner_tolerance = 0.1;

// A power of two near 1/size^(1/root): scaling by it rounds nothing.
double inverse(double size, int root) {
  return size > 0.0 && std::isfinite(size) ? std::scalbn(1.0, -std::ilogb(size) / root) : 1.0;
}

}  // namespace

void validate(const BoxLaws& laws, const std::string& what) {
  if (laws.lower.size() != laws.upper.size())
    throw std::invalid_argument(what + ": lower and upper must have as many entries, got " +
                                std::to_string(laws.lower.size()) + " and " +
                                std::to_string(laws.upper.size()));
  for (int i = 0; i < laws.rows(); ++i) {
    const double l = laws.lower[i], u = laws.upper[i];
    if (!(l <= u) || l == BoxLaws::unbounded || u == -BoxLaws::unbounded)
      throw std::invalid_argument(what + ": bounds must be lower <= upper, got [" + number(l) + ", " +
                                  number(u) + "]");
  }
}

void BoxProblem::prepare(const BoxLaws& laws, ContactSolver& solver) {
  validate(laws, "laws");
  solver_ = &solver;
  rows_.clear();
  const int rows = laws.rows();
  int unknowns = rows;
  problem_.sets.clear();
  for (int i = 0; i < rows; ++i) {
    const double l = laws.lower[i], u = laws.upper[i];
    Row row{Kind::free, l, u};
    if (std::isfinite(l))
      row.kind = std::isfinite(u) ? Kind::between : Kind::above;
    else if (std::isfinite(u))
      row.kind = Kind::below;
    if (row.kind == Kind::between) row.slack = unknowns++;
    problem_.sets.push_back(row.kind == Kind::free ? ContactSet(Equality{}) : ContactSet(NonNegative{}));
    rows_.push_back(row);
  }
  problem_.sets.resize(unknowns, NonNegative{});
  problem_.G.resize(unknowns, unknowns);
  problem_.b.resize(unknowns);
  problem_.tolerance = inner_tolerance * solver.tolerance();
  P_.resize(unknowns);
  M_ = Matrix::Zero(rows, rows);
  if (!solver.accepts(problem_))
    throw std::invalid_argument("the solver '" + std::string(solver.name()) +
                                "' must take mixed linear complementarity problems of " +
                                std::to_string(unknowns) + " rows, got one that does not");
  solver.reserve(unknowns);
}

// Sweeps that divide rows and columns by the roots of their largest entries: all come near one.
void BoxProblem::scale(const Matrix& M) {
  const int n = static_cast<int>(rows_.size());
  M_ = M;
  for (Row& row : rows_) row.row = row.column = 1.0;
  for (int sweep = 0; sweep < scaling_sweeps; ++sweep) {
    for (int i = 0; i < n; ++i) {
      const double factor = inverse(M_.row(i).cwiseAbs().maxCoeff(), 2);
      rows_[i].row *= factor;
      M_.row(i) *= factor;
    }
    for (int j = 0; j < n; ++j) {
      const double factor = inverse(M_.col(j).cwiseAbs().maxCoeff(), 2);
      rows_[j].column *= factor;
      M_.col(j) *= factor;
    }
  }
}

void BoxProblem::set_matrix(const Matrix& M) {
  scale(M);
  for (std::size_t i = 0; i < rows_.size(); ++i) rows_[i].d = M_(i, i) != 0.0 ? std::abs(M_(i, i)) : 1.0;
  problem_.G.view().setZero();
}

// Of scaled z: it is the sum of where it counts from and what the solver finds.
double BoxProblem::term(int j, const Vec& z) const {
  return (std::abs(z[j]) + std::abs(rows_[j].origin())) / rows_[j].column;
}

// What cancels in a scaled row.
double BoxProblem::terms(int i, const Vec& q, const Vec& z) const {
  double size = std::abs(rows_[i].row * q[i]);
  if (rows_[i].kind != Kind::free) size += rows_[i].d * term(i, z);
  for (int j = 0; j < z.size(); ++j) size += std::abs(M_(i, j)) * term(j, z);
  return size;
}

// The problem and the guess z in its unknowns; slacks are what they must be then.
void BoxProblem::pose(const Vec& q, const Vec& z) {
  const int n = static_cast<int>(rows_.size());
  for (int i = 0; i < n; ++i) {
    const Row& row = rows_[i];
    const double unit = inverse(terms(i, q, z), 1);
    double at_origin = row.row * q[i], w = at_origin;
    for (int j = 0; j < n; ++j) {
      problem_.G(i, j) = unit * row.sign() * rows_[j].sign() * M_(i, j);
      at_origin += M_(i, j) * rows_[j].origin() / rows_[j].column;
      w += M_(i, j) * z[j] / rows_[j].column;
    }
    problem_.b[i] = unit * row.sign() * at_origin;
    P_[i] = row.sign() * (z[i] - row.origin()) / row.column;
    if (row.slack < 0) continue;
    const double width = (row.upper - row.lower) / row.column;
    problem_.G(i, row.slack) = 1.0;
    problem_.G(row.slack, i) = -inverse(width, 1);
    problem_.b[row.slack] = inverse(width, 1) * width;
    P_[row.slack] = std::max(0.0, -unit * w);
  }
}

SolveReport BoxProblem::solve(const Vec& q, Vec& z) {
  if (rows_.empty()) return {};
  pose(q, z);
  const SolveReport report = solver_->solve(problem_, P_.data());
  for (int i = 0; i < z.size(); ++i) {
    const Row& row = rows_[i];
    z[i] = std::clamp(row.origin() + row.sign() * row.column * P_[i], row.lower, row.upper);
    // At the upper bound z is the bound, not a sum that is next to it.
    if (row.slack >= 0 && P_[row.slack] > problem_.b[row.slack] + problem_.G(row.slack, i) * P_[i])
      z[i] = row.upper;
  }
  return report;
}

double BoxProblem::residual(const Vec& q, const Vec& z, const Vec& w) const {
  double worst = 0.0;
  for (int i = 0; i < z.size(); ++i) {
    const Row& row = rows_[i];
    const double scale = row.d / row.column;
    const double natural =
        scale * z[i] - std::clamp(scale * z[i] - row.row * w[i], scale * row.lower, scale * row.upper);
    if (natural == 0.0) continue;
    const double relative = std::abs(natural) / terms(i, q, z);
    if (!(relative <= worst)) worst = relative;
    if (std::isnan(worst)) break;
  }
  return worst;
}

}  // namespace saltus
