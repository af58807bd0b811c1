#include "saltus/numerics/solvers/active_set.hpp"

#include <algorithm>
#include <cmath>

namespace saltus {
namespace {

// Components along the tangents to those along e and e', the direction turned by a right angle
void turn_pair(double& first, double& second, Direction e) {
  const double along = e.cosine * first + e.sine * second;
  second = e.cosine * second - e.sine * first;
  first = along;
}

// Argument of the projection in (32) outside the disc: the derivative of y -> radius y/|y| is radius/|y|
// times the projection across y.
Mode mode_in_space(const Coulomb& law, double d, const double* P, const double* xi, Slip& slip) {
  const double first = d * P[1] - xi[1], second = d * P[2] - xi[2];
  const double length = std::hypot(first, second);
  const double radius = law.mu * (d * std::max(P[0], 0.0));
  if (length <= radius) return Mode::closed;
  slip = {{first / length, second / length}, radius / length, d * (1.0 - radius / length)};
  return Mode::slip_space;
}

}  // namespace

Mode read_mode(const ContactSet& set, double d, const double* P, const double* xi, Slip& slip) {
  if (std::holds_alternative<Equality>(set)) return Mode::closed;
  if (!(d * P[0] - xi[0] > 0.0)) return Mode::open;  // argument of the projection in (31)
  const auto* law = std::get_if<Coulomb>(&set);
  if (!law) return Mode::closed;
  if (law->dim == 3) return mode_in_space(*law, d, P, xi, slip);
  const double tangential = d * P[1] - xi[1];  // argument of the projection in (32)
  if (std::abs(tangential) <= law->mu * (d * std::max(P[0], 0.0))) return Mode::closed;
  return tangential > 0.0 ? Mode::slip_plus : Mode::slip_minus;
}

void ActiveSet::reserve(int rows) {
  modes_.reserve(rows);
  slips_.reserve(rows);
  unknowns_.reserve(rows);
  slides_.reserve(rows);
  turned_G_.reserve(rows, rows);
  turned_b_.reserve(rows);
  linear_.reserve(rows);
}

void ActiveSet::solve(const ContactProblem& problem, double* P) {
  choose_unknowns(problem);
  if (slides_.empty()) return solve_in_frame(problem.G, problem.b, P);
  turn(problem, P);
  solve_in_frame(turned_G_, turned_b_, P);
  for (const Slide& slide : slides_) {
    const Direction e = slide.slip.direction;
    turn_pair(P[slide.row + 1], P[slide.row + 2], {e.cosine, -e.sine});
  }
}

void ActiveSet::choose_unknowns(const ContactProblem& problem) {
  unknowns_.clear();
  slides_.clear();
  int row = 0;
  for (int k = 0; k < problem.contacts(); ++k) {
    const auto* law = std::get_if<Coulomb>(&problem.sets[k]);
    if (modes_[k] == Mode::closed) {
      unknowns_.push_back({row, 0.0});
      if (law) unknowns_.push_back({row + 1, 0.0});
      if (law && law->dim == 3) unknowns_.push_back({row + 2, 0.0});
    } else if (modes_[k] == Mode::slip_space) {
      unknowns_.push_back({row, law->mu});
      unknowns_.push_back({row + 2, 0.0});
      slides_.push_back({row, static_cast<int>(unknowns_.size()) - 1, slips_[k]});
    } else if (modes_[k] != Mode::open) {
      unknowns_.push_back({row, modes_[k] == Mode::slip_plus ? law->mu : -law->mu});
    }
    row += rows_of(problem.sets[k]);
  }
}

void ActiveSet::turn(const ContactProblem& problem, double* P) {
  turned_G_ = problem.G;
  turned_b_ = problem.b;
  for (const Slide& slide : slides_) {
    const Direction e = slide.slip.direction;
    const int first = slide.row + 1, second = slide.row + 2;
    for (int j = 0; j < problem.rows(); ++j) turn_pair(turned_G_(first, j), turned_G_(second, j), e);
    for (int i = 0; i < problem.rows(); ++i) turn_pair(turned_G_(i, first), turned_G_(i, second), e);
    turn_pair(turned_b_[first], turned_b_[second], e);
    turn_pair(P[first], P[second], e);
  }
}

void ActiveSet::solve_in_frame(const PoolMatrix& G, const PoolVec& b, double* P) {
  const int n = static_cast<int>(unknowns_.size());
  linear_.resize(n);
  for (int i = 0; i < n; ++i) {
    const double* row = G.row(unknowns_[i].row);
    for (int j = 0; j < n; ++j) {
      const auto [column, slip] = unknowns_[j];
      linear_.A()(i, j) = slip == 0.0 ? row[column] : row[column] + slip * row[column + 1];
    }
    linear_.y()[i] = -b[unknowns_[i].row];
    linear_.start()[i] = P[unknowns_[i].row];
  }
  for (const auto& [_, unknown, slip] : slides_) {
    for (int j = 0; j < n; ++j) linear_.A()(unknown, j) *= slip.ratio;
    linear_.A()(unknown, unknown) += slip.shift;
    linear_.y()[unknown] *= slip.ratio;
  }
  const double* x = linear_.solve();
  std::fill_n(P, G.rows(), 0.0);
  for (int j = 0; j < n; ++j) P[unknowns_[j].row] = x[j];
  for (const auto& [row, slip] : unknowns_)
    if (slip != 0.0) P[row + 1] = slip * P[row];
}

}  // namespace saltus
