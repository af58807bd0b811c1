#include "saltus/numerics/box_problem.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "saltus/numerics/text.hpp"

namespace saltus {
namespace {

constexpr int scaling_sweeps = 3;

// The power of two next to 1/√size: scaling by it rounds nothing.
double inverse_root(double size) {
  return size > 0.0 && std::isfinite(size) ? std::exp2(-std::round(0.5 * std::log2(size))) : 1.0;
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
  problem_.tolerance = solver.tolerance();
  P_.resize(unknowns);
  scale_ = 0.0;
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
      const double factor = inverse_root(M_.row(i).cwiseAbs().maxCoeff());
      rows_[i].row *= factor;
      M_.row(i) *= factor;
    }
    for (int j = 0; j < n; ++j) {
      const double factor = inverse_root(M_.col(j).cwiseAbs().maxCoeff());
      rows_[j].column *= factor;
      M_.col(j) *= factor;
    }
  }
}

void BoxProblem::set_matrix(const Matrix& M) {
  scale(M);
  const int n = static_cast<int>(rows_.size());
  problem_.G.view().setZero();
  for (int i = 0; i < n; ++i) {
    const double sign = rows_[i].sign();
    for (int j = 0; j < n; ++j) problem_.G(i, j) = sign * rows_[j].sign() * M_(i, j);
    if (const int slack = rows_[i].slack; slack >= 0) {
      problem_.G(i, slack) = 1.0;
      problem_.G(slack, i) = -1.0;
      problem_.b[slack] = (rows_[i].upper - rows_[i].lower) / rows_[i].column;
    }
  }
}

// The guess z as unknowns; slacks are what they must be then.
void BoxProblem::guess(const Vec& q, const Vec& z) {
  const int n = static_cast<int>(rows_.size());
  for (int i = 0; i < n; ++i) {
    const Row& row = rows_[i];
    P_[i] = row.sign() * (z[i] - row.origin()) / row.column;
    if (row.slack < 0) continue;
    double w = row.row * q[i];
    for (int j = 0; j < n; ++j) w += M_(i, j) * z[j] / rows_[j].column;
    P_[row.slack] = std::max(0.0, -w);
  }
}

SolveReport BoxProblem::solve(const Vec& q, Vec& z) {
  const int n = static_cast<int>(rows_.size());
  if (n == 0) return {};
  for (int i = 0; i < n; ++i) {
    double b = rows_[i].row * q[i];
    for (int j = 0; j < n; ++j)
      if (const double origin = rows_[j].origin(); origin != 0.0) b += M_(i, j) * origin / rows_[j].column;
    problem_.b[i] = rows_[i].sign() * b;
  }
  guess(q, z);
  const SolveReport report = solver_->solve(problem_, P_.data());
  scale_ = report.certificate.scale;
  for (int i = 0; i < n; ++i) {
    const Row& row = rows_[i];
    z[i] = std::clamp(row.origin() + row.sign() * row.column * P_[i], row.lower, row.upper);
    // At the upper bound z is the bound, not a sum that is next to it.
    if (row.slack >= 0 && P_[row.slack] > problem_.b[row.slack] - P_[i]) z[i] = row.upper;
  }
  return report;
}

Certificate BoxProblem::certify(const Vec& q, const Vec& z, const Vec& w) const {
  const int n = static_cast<int>(rows_.size());
  Certificate certificate{.scale = scale_};
  // z is the sum of where it counts from and what the solver found.
  const auto terms = [&](int j) { return (std::abs(z[j]) + std::abs(rows_[j].origin())) / rows_[j].column; };
  for (int i = 0; i < n; ++i) {
    const Row& row = rows_[i];
    double size = std::abs(row.row * q[i]);
    for (int j = 0; j < n; ++j) size += std::abs(M_(i, j)) * terms(j);
    const double scaled = z[i] / row.column;
    const double natural =
        scaled - std::clamp(scaled - row.row * w[i], row.lower / row.column, row.upper / row.column);
    certificate.scale = std::max(certificate.scale, size);
    if (!(std::abs(natural) <= certificate.residual)) certificate.residual = std::abs(natural);  // also NaN
  }
  return certificate;
}

}  // namespace saltus
