#include "saltus/numerics/solvers/interior_point.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace saltus {
namespace {

constexpr int most_of_one = 80;           // iterations of one path
constexpr double most_operations = 2e10;  // of factorisations: some ten seconds
// Of the products of the cones to those of the normal rows: each makes a path of its own.
constexpr std::array weights = {1.0, 2.0, 0.5, 4.0, 0.7, 3.0, 1.5, 0.3, 6.0, 0.85};
constexpr double close = 1e-9;          // a residual, relative, from which Newton's method goes on
constexpr double closer = 0.03;         // of that, where it did not come to the end
constexpr double inside = 0.95;         // of the way to the boundary of the cones
constexpr double least_centring = 0.1;  // of the barrier, that remains
constexpr double blocked = 0.02;        // a step that is too short
constexpr double growth = 10.0;         // of the barrier then
constexpr double most_growth = 1e8;     // of the terms in ξ, while the residual stays
constexpr double softness = 1e-12;      // of d: contacts that depend on each other leave the matrix regular

}  // namespace

void InteriorPoint::Point::resize(int rows, int contacts) {
  P.resize(rows);
  u.resize(rows);
  a.resize(contacts);
}

void InteriorPoint::reserve(int rows) {
  for (Point* point : {&now_, &step_})
    for (PoolVec* x : {&point->P, &point->u, &point->a}) x->reserve(rows);
  for (PoolVec* x : {&xi_, &right_}) x->reserve(rows);
  contacts_.reserve(rows);
  block_.reserve(rows);
  finish_.reserve(rows);
}

SolveReport InteriorPoint::solve(const ContactProblem& problem, double* P) {
  const int rows = problem.rows();
  for (PoolVec* x : {&xi_, &right_}) x->resize(rows);
  for (Point* point : {&now_, &step_}) point->resize(rows, problem.contacts());
  SolveReport report{.status = SolveStatus::iteration_limit, .solver = name()};
  report.certificate = certify(problem, P, xi_.data());
  now_.P.view().setZero();
  if (!report.certificate.within(problem.tolerance))
    keep_if_better(problem, now_.P.data(), xi_.data(), report, P);
  if (!report.certificate.within(problem.tolerance)) {
    read_contacts(problem);
    read_matrix(problem);
    first_residual_ = report.certificate.residual;
    largest_scale_ =
        most_growth * std::max(report.certificate.scale, problem.b.view().lpNorm<Eigen::Infinity>());
  }
  const double most_work = factor_.work() + most_operations;
  bool stuck = true;
  for (double weight : weights) {
    if (report.certificate.within(problem.tolerance) || factor_.work() >= most_work) break;
    weight_ = weight;
    stuck = follow_path(problem, report, P) && stuck;
  }
  if (stuck) report.status = SolveStatus::breakdown;
  if (report.certificate.within(problem.tolerance)) report.status = SolveStatus::solved;
  return report;
}

// From the start, until the problem is solved or nothing goes on. @return true if no further step was found
bool InteriorPoint::follow_path(const ContactProblem& problem, SolveReport& report, double* P) {
  start(problem);
  same_pivots_ = false;
  double goal = std::max(close, problem.tolerance);
  for (int k = 0; k < most_of_one; ++k, ++report.iterations) {
    const Certificate reached = certify(problem, now_.P.data(), xi_.data());
    if (reached.scale > largest_scale_ && reached.residual > 0.5 * first_residual_) return true;
    if (reached.within(problem.tolerance) || reached.better_than(report.certificate)) {
      report.certificate = reached;
      std::copy_n(now_.P.data(), problem.rows(), P);
    }
    if (report.certificate.within(goal)) {
      const SolveReport finished = finish_.solve(problem, P);
      report.iterations += finished.iterations;
      report.certificate = finished.certificate;
      goal *= closer;
    }
    if (report.certificate.within(problem.tolerance) || !iterate()) return true;
  }
  return false;
}

void InteriorPoint::read_contacts(const ContactProblem& problem) {
  contacts_.clear();
  int row = 0;
  for (const ContactSet& set : problem.sets) {
    const int rows = rows_of(set);
    const auto* law = std::get_if<Coulomb>(&set);
    contacts_.push_back({row, rows, !std::holds_alternative<Equality>(set), law ? law->mu : 0.0,
                         contact_scale(problem, row, rows)});
    row += rows;
  }
}

// The structure of G and of a block for each contact. Tangential rows without friction become P_T = 0.
void InteriorPoint::read_matrix(const ContactProblem& problem) {
  A_.clear();
  block_.clear();
  for (const Contact& contact : contacts_)
    for (int i = contact.row; i < contact.row + contact.rows; ++i) {
      const bool fixed = contact.is_frictionless() && i > contact.row;
      const int end = contact.row + contact.rows;
      int next = contact.row;  // of the block, what is still to be added
      auto add_block = [&](int before) {
        for (; next < std::min(before, end); ++next) A_.add(next, fixed && next == i ? 1.0 : 0.0);
      };
      for_row(problem, i, [&](int j, double entry) {
        if (j >= contact.row) add_block(j);
        if (j >= contact.row && j < end) ++next;
        A_.add(j, fixed ? (i == j ? 1.0 : 0.0) : entry);
      });
      add_block(end);
      const auto from = A_.column.begin() + A_.start.back();
      block_.push_back(
          static_cast<int>(std::lower_bound(from, A_.column.end(), contact.row) - A_.column.begin()));
      A_.end_row();
    }
  G_ = A_.value;
  same_pivots_ = false;
}

// Impulses that stop |b|, and products that are alike.
void InteriorPoint::start(const ContactProblem& problem) {
  const double speed = problem.b.view().lpNorm<Eigen::Infinity>();
  for (PoolVec* x : {&now_.P, &now_.u, &now_.a, &step_.P, &step_.u, &step_.a}) x->view().setZero();
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& contact = contacts_[k];
    if (!contact.one_sided) continue;
    now_.P[contact.row] = speed / contact.d;
    now_.u[contact.row] = contact.has_cone() ? contact.mu * speed : speed;
    now_.a[static_cast<int>(k)] = 2.0 * speed;
  }
}

ConeVec InteriorPoint::force(const Contact& contact, const PoolVec& P) {
  const int i = contact.row;
  return {contact.mu * P[i], P[i + 1], contact.rows == 3 ? P[i + 2] : 0.0};
}

ConeVec InteriorPoint::velocity(const Point& point, int contact) const {
  const int i = contacts_[contact].row;
  return {point.a[contact], point.u[i + 1], contacts_[contact].rows == 3 ? point.u[i + 2] : 0.0};
}

// Predictor and corrector, from xi_ = G P + b. @return false where nothing goes on
bool InteriorPoint::iterate() {
  const double before = barrier(0.0);
  if (!(before > 0.0) || !factorise() || !find_direction(0.0, false)) return false;
  const double after = barrier(std::min(1.0, reach()));
  const double centring = std::clamp(std::pow(after / before, 3), least_centring, 1.0);
  if (!find_direction(centring * before, true)) return false;
  const double step = std::min(1.0, inside * reach());
  if (step < blocked) {
    raise(growth * before);
    return true;
  }
  now_.P.view() += step * step_.P.view();
  now_.u.view() += step * step_.u.view();
  now_.a.view() += step * step_.a.view();
  return true;
}

// The mean of the products after a step; those of a cone, two, are meant to be weight_ times the others.
double InteriorPoint::barrier(double step) const {
  double sum = 0.0, count = 0.0;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& contact = contacts_[k];
    if (!contact.one_sided) continue;
    const int i = contact.row, c = static_cast<int>(k);
    sum += (now_.P[i] + step * step_.P[i]) * (now_.u[i] + step * step_.u[i]);
    count += 1.0;
    if (!contact.has_cone()) continue;
    sum += (force(contact, now_.P) + step * force(contact, step_.P))
               .dot(velocity(now_, c) + step * velocity(step_, c));
    count += 2.0 * weight_;
  }
  return count > 0.0 ? sum / count : std::numeric_limits<double>::min();
}

// G dP - du = ..., where the products give du as a linear function of dP: of a contact u_N/P_N in the normal
// row, and of its cone x⁻¹∘(y∘dx) in the tangential ones.
bool InteriorPoint::factorise() {
  A_.value = G_;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& contact = contacts_[k];
    for (int i = 0; i < contact.rows; ++i) A_.value[block_[contact.row + i] + i] += softness * contact.d;
    if (contact.one_sided) A_.value[block_[contact.row]] += now_.u[contact.row] / now_.P[contact.row];
    if (!contact.has_cone()) continue;
    const ConeVec x = force(contact, now_.P), y = velocity(now_, static_cast<int>(k));
    for (int j = 0; j < contact.rows; ++j) {
      const ConeVec dx = (j == 0 ? contact.mu : 1.0) * ConeVec::Unit(j);
      const ConeVec dy = cone_quotient(cone_product(y, dx), x);
      for (int i = 1; i < contact.rows; ++i) A_.value[block_[contact.row + i] + j] += dy[i];
    }
  }
  if (same_pivots_ && factor_.factorise_again(A_.value)) return true;
  same_pivots_ = factor_.factorise(A_.start, A_.column, A_.value);
  return same_pivots_;
}

// Newton's step to products of `barrier`. @param correct  by the products of the step at hand
bool InteriorPoint::find_direction(double barrier, bool correct) {
  find_right_hand_side(barrier, correct);
  std::copy_n(right_.data(), right_.size(), step_.P.data());
  if (!factor_.solve(step_.P.data()) || !step_.P.view().allFinite()) return false;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& contact = contacts_[k];
    const int i = contact.row, c = static_cast<int>(k);
    if (contact.one_sided) step_.u[i] -= now_.u[i] / now_.P[i] * step_.P[i];
    if (!contact.has_cone()) continue;
    const ConeVec dy =
        cone_quotient(cone_product(velocity(now_, c), force(contact, step_.P)), force(contact, now_.P));
    step_.a[c] -= dy[0];
    for (int j = 1; j < contact.rows; ++j) step_.u[i + j] -= dy[j];
  }
  return true;
}

// right_, and in step_.u and step_.a what of them does not depend on dP
void InteriorPoint::find_right_hand_side(double barrier, bool correct) {
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& contact = contacts_[k];
    const int i = contact.row, c = static_cast<int>(k);
    for (int j = i; j < i + contact.rows; ++j)
      right_[j] = contact.is_frictionless() && j > i ? 0.0 : now_.u[j] - xi_[j];
    if (!contact.one_sided) continue;
    double product = barrier - now_.P[i] * now_.u[i];
    if (correct) product -= step_.P[i] * step_.u[i];
    step_.u[i] = product / now_.P[i];
    right_[i] += step_.u[i];
    if (!contact.has_cone()) continue;
    const ConeVec x = force(contact, now_.P);
    ConeVec products = 2.0 * weight_ * barrier * ConeVec::Unit(0) - cone_product(x, velocity(now_, c));
    if (correct) products -= cone_product(force(contact, step_.P), velocity(step_, c));
    const ConeVec dy = cone_quotient(products, x);
    step_.a[c] = dy[0];
    for (int j = 1; j < contact.rows; ++j) right_[i + j] += step_.u[i + j] = dy[j];
  }
}

// The largest step that stays in the cones.
double InteriorPoint::reach() const {
  double least = std::numeric_limits<double>::infinity();
  auto of_number = [&](double x, double dx) {
    if (dx < 0.0) least = std::min(least, -x / dx);
  };
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& contact = contacts_[k];
    if (!contact.one_sided) continue;
    of_number(now_.P[contact.row], step_.P[contact.row]);
    of_number(now_.u[contact.row], step_.u[contact.row]);
    if (!contact.has_cone()) continue;
    const int c = static_cast<int>(k);
    least = std::min({least, cone_reach(force(contact, now_.P), force(contact, step_.P)),
                      cone_reach(velocity(now_, c), velocity(step_, c))});
  }
  return least;
}

// Lets what is small grow until no product is below `barrier`: in the frame of x, where x∘y has the products
// (x_0 ± |x_T|)(y_0 ± e·y_T)/2, e = x_T/|x_T|.
void InteriorPoint::raise(double barrier) {
  auto grow = [](double& x, double& y, double d, double product) {
    if (x * y < product) (d * x < y ? x : y) = product / (d * x < y ? y : x);
  };
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& contact = contacts_[k];
    if (!contact.one_sided) continue;
    double* P = &now_.P[contact.row];
    double* u = &now_.u[contact.row];
    if (contact.has_cone()) {
      const int c = static_cast<int>(k);
      const ConeVec x = force(contact, now_.P), y = velocity(now_, c);
      const double length = std::hypot(x[1], x[2]);
      const double e[2] = {length > 0.0 ? x[1] / length : 1.0, length > 0.0 ? x[2] / length : 0.0};
      const double along = e[0] * y[1] + e[1] * y[2];
      double far = x[0] + length, of_far = y[0] + along, near = x[0] - length, of_near = y[0] - along;
      grow(far, of_far, contact.d, 2.0 * weight_ * barrier);
      grow(near, of_near, contact.d, 2.0 * weight_ * barrier);
      P[0] = 0.5 * (far + near) / contact.mu;
      now_.a[c] = 0.5 * (of_far + of_near);
      for (int i = 1; i < contact.rows; ++i) {
        P[i] = 0.5 * (far - near) * e[i - 1];
        u[i] = 0.5 * (of_far - of_near) * e[i - 1];
      }
      u[0] = std::max(u[0], barrier / P[0]);
    } else {
      grow(P[0], u[0], contact.d, barrier);
    }
  }
}

}  // namespace saltus
