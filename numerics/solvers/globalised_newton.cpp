#include "saltus/numerics/solvers/globalised_newton.hpp"

#include <algorithm>
#include <cmath>

namespace saltus {
namespace {

constexpr int most_iterations = 200;
constexpr double regularisations[] = {0.0, 1e-8, 1e-4, 1.0};  // ν
constexpr double sufficient = 1e-4;                           // of the decrease that the slope promises
constexpr int halvings_of_newton = 12, halvings_of_gradient = 40;

// Φ of one contact, ∂Φ/∂ξ and ∂Φ/∂P
struct Equations {
  double value[3] = {};
  double by_xi[3][3] = {};
  double by_P[3][3] = {};
};

void take_velocity(Equations& equations, int k, double xi) {
  equations.value[k] = xi;
  equations.by_xi[k][k] = 1.0;
}

Equations fischer_burmeister(double d, double P, double xi) {
  const double p = d * P, length = std::hypot(p, xi);
  Equations equations;
  // without cancellation where both are positive
  equations.value[0] = p > 0.0 && xi > 0.0 ? 2.0 * xi / (1.0 + (xi + length) / p) : p + xi - length;
  const double at_origin = std::sqrt(0.5);  // there the derivatives are those along p = ξ
  equations.by_xi[0][0] = 1.0 - (length > 0.0 ? xi / length : at_origin);
  equations.by_P[0][0] = d * (1.0 - (length > 0.0 ? p / length : at_origin));
  return equations;
}

// The projection on the disc: y = p_T - ξ_T is outside, along e, and becomes radius e. Its derivative by y is
// radius/|y| (1 - e eᵀ).
void take_friction(const Coulomb& law, double d, const double* P, const double* xi, Equations& equations) {
  double e[3] = {}, length = 0.0;
  for (int k = 1; k < law.dim; ++k) {
    e[k] = d * P[k] - xi[k];
    length = std::hypot(length, e[k]);
  }
  const double radius = law.mu * (d * std::max(P[0], 0.0));
  for (int k = 1; k < law.dim; ++k) {
    if (length <= radius) {
      take_velocity(equations, k, xi[k]);
      continue;
    }
    equations.value[k] = d * P[k] - radius * (e[k] / length);
    if (P[0] >= 0.0) equations.by_P[k][0] = -law.mu * d * (e[k] / length);
    for (int l = 1; l < law.dim; ++l) {
      const double across = (k == l ? 1.0 : 0.0) - (e[k] / length) * (e[l] / length);
      equations.by_xi[k][l] = radius / length * across;
      equations.by_P[k][l] = d * ((k == l ? 1.0 : 0.0) - radius / length * across);
    }
  }
}

Equations natural(const ContactSet& set, double d, const double* P, const double* xi) {
  Equations equations;
  if (xi[0] < d * P[0]) {
    take_velocity(equations, 0, xi[0]);
  } else {
    equations.value[0] = d * P[0];
    equations.by_P[0][0] = d;
  }
  if (const auto* law = std::get_if<Coulomb>(&set)) take_friction(*law, d, P, xi, equations);
  return equations;
}

Equations equations_of(GlobalisedNewton::Map map, const ContactSet& set, double d, const double* P,
                       const double* xi) {
  if (std::holds_alternative<Equality>(set)) {
    Equations equations;
    take_velocity(equations, 0, xi[0]);
    return equations;
  }
  return map == GlobalisedNewton::Map::natural ? natural(set, d, P, xi) : fischer_burmeister(d, P[0], xi[0]);
}

}  // namespace

std::string_view GlobalisedNewton::name() const {
  return map_ == Map::natural ? "damped-newton" : "fischer-burmeister";
}

bool GlobalisedNewton::accepts(const ContactProblem& problem) const {
  return map_ == Map::natural ||
         std::none_of(problem.sets.begin(), problem.sets.end(),
                      [](const ContactSet& set) { return std::holds_alternative<Coulomb>(set); });
}

void GlobalisedNewton::reserve(int rows) {
  for (PoolVec* x : {&d_, &P_, &trial_, &xi_, &Phi_, &direction_, &gradient_}) x->reserve(rows);
  sums_.reserve(rows);
  columns_.reserve(rows);
  seen_in_.reserve(rows);
}

SolveReport GlobalisedNewton::solve(const ContactProblem& problem, double* P) {
  const int rows = problem.rows();
  for (PoolVec* x : {&d_, &P_, &trial_, &xi_, &Phi_, &direction_, &gradient_}) x->resize(rows);
  sums_.assign(rows, 0.0);
  std::copy_n(P, rows, P_.data());
  SolveReport report{.status = SolveStatus::iteration_limit, .solver = name()};
  report.certificate = certify(problem, P, xi_.data());
  size_ = report.certificate.scale;
  measure(problem);
  bool solved = report.certificate.within(problem.tolerance);
  while (!solved && report.iterations < most_iterations) {
    ++report.iterations;
    if (!improve(problem)) {
      report.status = SolveStatus::breakdown;
      break;
    }
    solved = keep_if_better(problem, P_.data(), xi_.data(), report, P);
  }
  if (solved) report.status = SolveStatus::solved;
  return report;
}

void GlobalisedNewton::measure(const ContactProblem& problem) {
  int row = 0;
  for (const ContactSet& set : problem.sets) {
    const int rows = rows_of(set);
    std::fill_n(d_.data() + row, rows, contact_scale(problem, row, rows));
    row += rows;
  }
}

// ½|Φ|², over the size of the velocities: squares must neither overflow nor vanish
double GlobalisedNewton::merit(const ContactProblem& problem, const PoolVec& P) {
  certify(problem, P.data(), xi_.data());
  int row = 0;
  for (const ContactSet& set : problem.sets) {
    const Equations equations = equations_of(map_, set, d_[row], P.data() + row, xi_.data() + row);
    for (int k = 0; k < rows_of(set); ++k) Phi_[row + k] = equations.value[k] / size_;
    row += rows_of(set);
  }
  return 0.5 * Phi_.view().squaredNorm();
}

// One iteration. @return false if no direction leads down
bool GlobalisedNewton::improve(const ContactProblem& problem) {
  for (const double regularisation : regularisations) {
    fill_jacobian(problem, regularisation);
    if (regularisation == 0.0) find_gradient(problem);
    if (take_newtons_direction() && search(problem, halvings_of_newton)) return true;
  }
  fill_jacobian(problem, 0.0);
  take_steepest_direction();
  return search(problem, halvings_of_gradient);
}

// J = A (G + ν diag(d)) + B at P_
void GlobalisedNewton::fill_jacobian(const ContactProblem& problem, double regularisation) {
  merit_ = merit(problem, P_);
  linear_.A().clear();
  seen_in_.assign(problem.rows(), -1);
  int row = 0;
  for (const ContactSet& set : problem.sets) {
    const int rows = rows_of(set);
    const double d = d_[row];
    const Equations equations = equations_of(map_, set, d, P_.data() + row, xi_.data() + row);
    for (int k = 0; k < rows; ++k) {
      for (int i = 0; i < rows; ++i) {
        const double by_xi = equations.by_xi[k][i];
        if (by_xi != 0.0) for_row(problem, row + i, [&](int j, double entry) { add(j, by_xi * entry); });
        add(row + i, by_xi * regularisation * d + equations.by_P[k][i]);
      }
      end_row();
    }
    row += rows;
  }
}

void GlobalisedNewton::add(int column, double value) {
  if (value == 0.0) return;
  const int row = linear_.A().rows();
  if (seen_in_[column] != row) columns_.push_back(column);
  seen_in_[column] = row;
  sums_[column] += value;
}

void GlobalisedNewton::end_row() {
  for (const int column : columns_) {
    linear_.A().add(column, sums_[column]);
    sums_[column] = 0.0;
  }
  columns_.clear();
  linear_.A().end_row();
}

// Jᵀ Φ
void GlobalisedNewton::find_gradient(const ContactProblem& problem) {
  gradient_.view().setZero();
  const SparseRows& J = linear_.A();
  for (int i = 0; i < problem.rows(); ++i)
    for (int k = J.start[i]; k < J.start[i + 1]; ++k) gradient_[J.column[k]] += J.value[k] * Phi_[i];
}

bool GlobalisedNewton::take_newtons_direction() {
  linear_.y().assign(Phi_.data(), Phi_.data() + Phi_.size());
  const double* solution = linear_.solve();
  if (!solution) return false;
  for (int i = 0; i < direction_.size(); ++i) direction_[i] = -solution[i];
  return true;
}

// The direction is that of forces as velocities, as long as the least of the linearised |Φ|² on it.
void GlobalisedNewton::take_steepest_direction() {
  const int rows = direction_.size();
  const SparseRows& J = linear_.A();
  for (int i = 0; i < rows; ++i) direction_[i] = -gradient_[i] / d_[i] / d_[i];
  double along = 0.0, squares = 0.0;
  for (int i = 0; i < rows; ++i) {
    double change = 0.0;
    for (int k = J.start[i]; k < J.start[i + 1]; ++k) change += J.value[k] * direction_[J.column[k]];
    along += change * Phi_[i];
    squares += change * change;
  }
  direction_.view() *= squares > 0.0 ? -along / squares : 0.0;
}

// Armijo's rule along direction_. @return false if it does not lead down; P_ is what it was then
bool GlobalisedNewton::search(const ContactProblem& problem, int most_halvings) {
  const double slope = gradient_.view().dot(direction_.view());
  if (!(slope < 0.0)) return false;
  double step = 1.0;
  for (int k = 0; k <= most_halvings; ++k, step *= 0.5) {
    trial_.view() = P_.view() + step * size_ * direction_.view();
    if (!(merit(problem, trial_) <= merit_ + sufficient * step * slope)) continue;
    std::swap(P_, trial_);
    return true;
  }
  return false;
}

}  // namespace saltus
