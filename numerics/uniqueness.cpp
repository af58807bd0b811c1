#include "saltus/numerics/uniqueness.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>

#include "saltus/numerics/certificate.hpp"
#include "saltus/numerics/solvers/lemke_lcp.hpp"

namespace saltus {
namespace {

constexpr double least_zero = 1e-9;  // of the terms that cancel in ξ
constexpr double least_pivot = 1e-10;
constexpr double least_gap = 1e-8;  // of |G δ|: nonnegative combinations are not as exact as ranks
constexpr std::size_t most_directions = 500, most_one_sided = 100;
constexpr double most_entries = 5e5;

enum class Sides { both, one, unclear };

// P of one contact may change along this.
struct Change {
  Sides sides;
  int row;  // of the contact
  std::array<double, 3> along;
};

class Changes {
 public:
  Changes(const ContactProblem& problem, const double* P, const double* xi, double zero);
  const std::vector<Change>& of(Sides sides) const { return lists_[static_cast<int>(sides)]; }
  std::size_t count() const { return lists_[0].size() + lists_[1].size() + lists_[2].size(); }

 private:
  void add(Sides sides, int row, std::array<double, 3> along) {
    lists_[static_cast<int>(sides)].push_back({sides, row, along});
  }
  void add_unit(Sides sides, int row, int k) {
    std::array<double, 3> along{};
    along[k] = 1.0;
    add(sides, row, along);
  }
  // (1, μ x/|x|), as a unit vector
  void add_edge(Sides sides, int row, const Coulomb& law, const double* x, double sign);
  void add_contact(const Coulomb& law, double d, int row, const double* P, const double* xi, double zero);
  void add_sticking(const Coulomb& law, double slack, int row, const double* P, double zero);

  std::vector<Change> lists_[3];
};

double tangential(const Coulomb& law, const double* x) {
  return law.dim == 2 ? std::abs(x[1]) : std::hypot(x[1], x[2]);
}

Changes::Changes(const ContactProblem& problem, const double* P, const double* xi, double zero) {
  int row = 0;
  for (const ContactSet& set : problem.sets) {
    const int rows = rows_of(set);
    const double d = contact_scale(problem, row, rows);
    if (const auto* law = std::get_if<Coulomb>(&set))
      add_contact(*law, d, row, P + row, xi + row, zero);
    else if (std::holds_alternative<Equality>(set) || d * P[row] > zero)
      add_unit(Sides::both, row, 0);
    else if (xi[row] <= zero)
      add_unit(Sides::one, row, 0);
    row += rows;
  }
}

void Changes::add_edge(Sides sides, int row, const Coulomb& law, const double* x, double sign) {
  const double length = tangential(law, x), edge = std::hypot(1.0, law.mu);
  std::array<double, 3> along{1.0 / edge, 0.0, 0.0};
  for (int k = 1; k < law.dim && length > 0.0; ++k) along[k] = sign * (law.mu / edge) * (x[k] / length);
  add(sides, row, along);
}

void Changes::add_contact(const Coulomb& law, double d, int row, const double* P, const double* xi,
                          double zero) {
  const bool presses = d * P[0] > zero;
  if (!presses && xi[0] > zero) return;
  if (law.mu == 0.0) {
    add_unit(presses ? Sides::both : Sides::one, row, 0);
  } else if (tangential(law, xi) > zero) {
    add_edge(presses ? Sides::both : Sides::one, row, law, xi, -1.0);
  } else if (presses) {
    add_sticking(law, law.mu * (d * P[0]) - d * tangential(law, P), row, P, zero);
  } else if (law.dim == 2) {
    const double forward[2] = {0.0, 1.0};
    add_edge(Sides::one, row, law, forward, 1.0);
    add_edge(Sides::one, row, law, forward, -1.0);
  } else {
    for (int k = 0; k < 3; ++k) add_unit(Sides::unclear, row, k);
  }
}

void Changes::add_sticking(const Coulomb& law, double slack, int row, const double* P, double zero) {
  if (slack > zero) {
    for (int k = 0; k < law.dim; ++k) add_unit(Sides::both, row, k);
    return;
  }
  add_edge(Sides::both, row, law, P, 1.0);
  if (law.dim == 2) add(Sides::one, row, {0.0, P[1] > 0.0 ? -1.0 : 1.0, 0.0});
  if (law.dim == 3)
    for (int k = 1; k < 3; ++k) add_unit(Sides::unclear, row, k);
}

// G times the changes, one a column, scaled
Matrix moved_by(const ContactProblem& problem, const std::vector<const std::vector<Change>*>& lists) {
  const int rows = problem.rows();
  Vec scale(rows);
  int row = 0;
  for (const ContactSet& set : problem.sets) {
    scale.segment(row, rows_of(set)).setConstant(1.0 / std::sqrt(contact_scale(problem, row, rows_of(set))));
    row += rows_of(set);
  }
  struct Part {
    int column;
    double factor;
  };
  std::vector<std::vector<Part>> parts(rows);  // what each row of P has of the changes
  int columns = 0;
  for (const std::vector<Change>* list : lists)
    for (const Change& change : *list) {
      for (int k = 0; k < 3; ++k)
        if (change.along[k] != 0.0) parts[change.row + k].push_back({columns, change.along[k]});
      ++columns;
    }
  Matrix moved = Matrix::Zero(rows, columns);
  for (int i = 0; i < rows; ++i)
    for_row(problem, i, [&](int j, double entry) {
      for (const auto& [column, factor] : parts[j]) moved(i, column) += scale[i] * entry * scale[j] * factor;
    });
  return moved;
}

using Decomposition = Eigen::ColPivHouseholderQR<Matrix>;

Decomposition decompose(const Matrix& A) {
  Decomposition decomposition(A);
  decomposition.setThreshold(least_pivot);
  return decomposition;
}

// Is there x >= 0, x ≠ 0, with A x in the range of B, whose columns are independent? With  the part of A
// beside that range, as unit columns, ½ |Â x|² - Σx + ½ (Σx)² is least at such an x if there is one.
std::optional<bool> meets_range(Matrix A, const Matrix& B) {
  const int n = static_cast<int>(A.cols());
  if (B.cols() > 0) {
    const Decomposition decomposition = decompose(B);
    Matrix in_frame = decomposition.householderQ().adjoint() * A;
    A = in_frame.bottomRows(in_frame.rows() - decomposition.rank()).eval();
  }
  for (int k = 0; k < n; ++k) {
    const double length = A.col(k).norm();
    if (length <= least_pivot) return true;
    A.col(k) /= length;
  }
  LemkeLcp lcp;
  lcp.resize(n);
  lcp.M().view() = A.transpose() * A + Matrix::Ones(n, n);
  lcp.q().view().setConstant(-1.0);
  Vec x(n);
  if (lcp.solve(x.data()) != LcpOutcome::solved) return std::nullopt;
  return (A * x).norm() <= least_gap * x.sum();
}

}  // namespace

std::optional<bool> is_only_solution(const ContactProblem& problem, const double* P) {
  PoolVec xi;
  xi.resize(problem.rows());
  const Certificate certificate = certify(problem, P, xi.data());
  const double zero = std::max(least_zero * certificate.scale, 100.0 * certificate.residual);
  const Changes changes(problem, P, xi.data(), zero);
  const auto &both = changes.of(Sides::both), &one = changes.of(Sides::one),
             &unclear = changes.of(Sides::unclear);
  const std::size_t count = changes.count();
  if (count == 0) return true;
  if (count > most_directions || static_cast<double>(count) * problem.rows() > most_entries)
    return std::nullopt;
  const Matrix moved = moved_by(problem, {&both, &one, &unclear});
  if (!moved.allFinite()) return std::nullopt;
  if (decompose(moved).rank() == moved.cols()) return true;
  const Matrix freely = moved.leftCols(static_cast<int>(both.size()));
  if (!both.empty() && decompose(freely).rank() < freely.cols()) return false;
  if (one.size() > most_one_sided) return std::nullopt;
  const Matrix forward = moved.middleCols(freely.cols(), static_cast<int>(one.size()));
  const std::optional<bool> others = one.empty() ? false : meets_range(forward, freely);
  if (others == true) return false;
  if (!others || !unclear.empty()) return std::nullopt;
  return true;
}

}  // namespace saltus
