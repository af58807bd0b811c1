#include "saltus/numerics/solvers/proximal_newton.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/numerics/solvers/nsgs.hpp"

namespace saltus {
namespace {

constexpr double most_operations = 3e10;  // of their factorisations: some ten seconds
constexpr double most_growth = 1e8;       // of the terms in ξ, while the residual stays
constexpr int most_of_one = 12;           // for one P₀
constexpr int few = 4;                    // iterations that let ρ grow
constexpr double rigid = 1e9;             // ρ, to begin with
constexpr double middling = 10.0;         // and where that fails
constexpr double softest = 1e-6;
constexpr double growth = 2.0;
constexpr double retreat = 4.0;
constexpr double relaxation = 1.3;  // in (0, 2): longer steps of the proximal point method
constexpr int sweeps = 100;         // after each of these
constexpr double detour = 3.0;      // of the residual, that sweeps may lead to
constexpr double rounding = 1e-13;  // of P, relative
constexpr double near = 1e-3;       // F over the residual: closer than that is for the next P₀
constexpr int most_refinements = 20;
constexpr int most_halvings = 8;

int unknowns_of(Mode mode, int rows) {
  switch (mode) {
    case Mode::open: return 0;
    case Mode::closed: return rows;
    case Mode::slip_plus:
    case Mode::slip_minus: return 1;
    case Mode::slip_space: break;
  }
  return 2;
}

double friction_of(const ContactSet& set) {
  const auto* law = std::get_if<Coulomb>(&set);
  return law ? law->mu : 0.0;
}

}  // namespace

void ProximalNewton::reserve(int rows) {
  for (PoolVec* x : {&start_, &P_, &y_, &trial_P_, &trial_y_, &full_P_, &full_y_, &xi_}) x->reserve(rows);
  contacts_.reserve(rows);
  contact_of_.reserve(rows);
  sums_.reserve(rows);
  columns_.reserve(rows);
  seen_in_.reserve(rows);
}

SolveReport ProximalNewton::solve(const ContactProblem& problem, double* P) {
  const int rows = problem.rows();
  for (PoolVec* x : {&start_, &P_, &y_, &trial_P_, &trial_y_, &full_P_, &full_y_, &xi_}) x->resize(rows);
  read_contacts(problem);
  SolveReport report{.status = SolveStatus::iteration_limit, .solver = name()};
  report.certificate = certify(problem, P, xi_.data());
  std::copy_n(P, rows, start_.data());
  trial_P_.view().setZero();  // where nothing presses, a start shrinks for ever
  if (!report.certificate.within(problem.tolerance))
    keep_if_better(problem, trial_P_.data(), xi_.data(), report, P);
  const double first_residual = report.certificate.residual;
  const double largest_scale =
      most_growth * std::max(report.certificate.scale, problem.b.view().lpNorm<Eigen::Infinity>());
  // Most problems are solved as if contacts were rigid, from a good start or where nothing is in doubt.
  hardness_ = rigid;
  const double most_work = linear_.work() + most_operations;
  while (!report.certificate.within(problem.tolerance) && report.iterations < iterations_ &&
         linear_.work() < most_work) {
    int iterations = 0;
    const bool solved = solve_compliant(problem, near * report.certificate.residual, iterations);
    report.iterations += std::max(iterations, 1);
    if (!solved) {
      hardness_ = std::min(middling, hardness_ / retreat);
      if (hardness_ >= softest) continue;
      report.status = SolveStatus::breakdown;
      break;
    }
    const Certificate reached = certify(problem, P_.data(), xi_.data());
    if (reached.scale > largest_scale && reached.residual > 0.5 * first_residual) {
      report.status = SolveStatus::breakdown;  // P grows without bound, and ξ stays where it is
      break;
    }
    if (keep_if_better(problem, P_.data(), xi_.data(), report, P)) {
      if (iterations > 0) refine(problem, report, P);
      break;
    }
    if (hardness_ < rigid && explore(problem, reached.residual, report, P)) break;
    start_ = P_;
    if (iterations <= few) hardness_ = std::min(rigid, growth * hardness_);
  }
  if (report.certificate.within(problem.tolerance)) report.status = SolveStatus::solved;
  return report;
}

// A longer step, and sweeps that find out what contacts do among their neighbours; not taken where they lead
// away.
// @param before  residual of P_. @return true if that solves the problem
bool ProximalNewton::explore(const ContactProblem& problem, double before, SolveReport& report, double* P) {
  trial_P_.view() = start_.view() + relaxation * (P_.view() - start_.view());
  for (int k = 0; k < sweeps; ++k) sweep(problem, trial_P_.data());
  if (keep_if_better(problem, trial_P_.data(), xi_.data(), report, P)) return true;
  if (certify(problem, trial_P_.data(), xi_.data()).residual <= detour * before) std::swap(P_, trial_P_);
  return false;
}

void ProximalNewton::read_contacts(const ContactProblem& problem) {
  contacts_.clear();
  contact_of_.clear();
  int row = 0;
  for (const ContactSet& set : problem.sets) {
    const int rows = rows_of(set);
    contact_of_.insert(contact_of_.end(), rows, static_cast<int>(contacts_.size()));
    contacts_.push_back({row, rows, contact_scale(problem, row, rows), Mode::open, {}});
    row += rows;
  }
}

// The contacts of compliance d/ρ, from start_. @return false if Newton's method does not come to their
// solution
bool ProximalNewton::solve_compliant(const ContactProblem& problem, double bound, int& iterations) {
  const double scale = certify(problem, start_.data(), xi_.data()).scale;
  // What contacts do is read with ρ = 1, as the certificate does: with a large ρ the small ξ of one that
  // sticks or is closed would let it slide or open. P − ξ/d = P(…) + N, and y is P + ρ N.
  for (const Contact& contact : contacts_)
    for (int i = contact.row; i < contact.row + contact.rows; ++i) y_[i] = start_[i] - xi_[i] / contact.d;
  project(problem, y_, P_);
  y_.view() = start_.view() + hardness_ * (y_.view() - P_.view());
  double size = project(problem, y_, P_);
  bound = std::max(bound, rounding * scale) * std::sqrt(static_cast<double>(problem.rows()));
  for (; size > bound; ++iterations)
    if (iterations == std::min(most_of_one, iterations_) || !improve(problem, size)) return false;
  return true;
}

// P(y). @return |F(y)| [m/s]
double ProximalNewton::project(const ContactProblem& problem, const PoolVec& y, PoolVec& P) {
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& contact = contacts_[k];
    const double* from = y.data() + contact.row;
    double* to = P.data() + contact.row;
    std::copy_n(from, contact.rows, to);
    if (std::holds_alternative<Equality>(problem.sets[k])) continue;
    to[0] = std::max(0.0, from[0]);  // (31)
    const double radius = friction_of(problem.sets[k]) * to[0];
    double length = 0.0;
    for (int i = 1; i < contact.rows; ++i) length = std::hypot(length, from[i]);
    if (length > radius)
      for (int i = 1; i < contact.rows; ++i) to[i] *= radius / length;  // (32)
  }
  double squares = 0.0;
  for (const Contact& contact : contacts_)
    for (int i = contact.row; i < contact.row + contact.rows; ++i) {
      double F = contact.d / hardness_ * (start_[i] - y[i]) - problem.b[i];
      for_row(problem, i, [&](int j, double entry) { F -= entry * P[j]; });
      squares += F * F;
    }
  return std::sqrt(squares);
}

// One of Newton's iterations. @param[in,out] size  |F(y)|
bool ProximalNewton::improve(const ContactProblem& problem, double& size) {
  read_modes(problem);
  if (!find_direction(problem)) return false;
  double step = 1.0;
  for (int k = 0; k < most_halvings; ++k, step *= 0.5) {
    trial_y_.view() = y_.view() + step * (full_y_.view() - y_.view());
    const double trial_size = project(problem, trial_y_, trial_P_);
    if (!(trial_size <= (1.0 - 0.1 * step) * size)) continue;
    std::swap(y_, trial_y_);
    std::swap(P_, trial_P_);
    size = trial_size;
    return true;
  }
  return false;
}

void ProximalNewton::read_modes(const ContactProblem& problem) {
  constexpr double resting[3] = {0.0, 0.0, 0.0};
  // A contact that is open and closed alike counts as closed: from P = 0 that is where all of them start.
  const double zero =
      std::max(rounding * P_.view().cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
  int unknown = 0;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    Contact& contact = contacts_[k];
    double y[3];
    std::copy_n(y_.data() + contact.row, contact.rows, y);
    if (std::abs(y[0]) <= zero) y[0] = zero;
    contact.mode = read_mode(problem.sets[k], 1.0, y, resting, contact.slip);
    contact.unknown = unknown;
    unknown += unknowns_of(contact.mode, contact.rows);
  }
  sums_.assign(unknown, 0.0);
  seen_in_.assign(unknown, -1);
}

// full_y_: where F is zero if the modes are right
bool ProximalNewton::find_direction(const ContactProblem& problem) {
  linear_.A().clear();
  linear_.y().clear();
  for (const Contact& contact : contacts_)
    for (int k = 0; k < unknowns_of(contact.mode, contact.rows); ++k) add_equation(problem, contact, k);
  const double* unknowns = linear_.solve();
  if (!unknowns) return false;
  take_solution(problem, unknowns);
  return true;
}

// Proximal point iterations with the modes at hand: their equations differ in P₀ alone.
void ProximalNewton::refine(const ContactProblem& problem, SolveReport& report, double* P) {
  double before = std::numeric_limits<double>::infinity();
  for (int k = 0; k < most_refinements; ++k) {
    std::copy_n(P, problem.rows(), start_.data());
    linear_.y().clear();
    for (const Contact& contact : contacts_)
      for (int i = 0; i < unknowns_of(contact.mode, contact.rows); ++i)
        linear_.y().push_back(right_hand_side(problem, contact, i));
    const double* unknowns = linear_.solve_again();
    if (!unknowns) return;
    take_solution(problem, unknowns);
    const double change = (full_P_.view() - start_.view()).cwiseAbs().maxCoeff();
    const Certificate certificate = certify(problem, full_P_.data(), xi_.data());
    if (!(change < 0.5 * before) || !certificate.within(problem.tolerance)) return;
    before = change;
    report.certificate = certificate;
    std::copy_n(full_P_.data(), problem.rows(), P);
  }
}

double ProximalNewton::right_hand_side(const ContactProblem& problem, const Contact& contact,
                                       int equation) const {
  auto of_row = [&](int i) { return contact.d / hardness_ * start_[i] - problem.b[i]; };
  if (contact.mode != Mode::slip_space || equation == 0) return of_row(contact.row + equation);
  const Direction e = contact.slip.direction;
  return contact.slip.ratio * (e.cosine * of_row(contact.row + 2) - e.sine * of_row(contact.row + 1));
}

// ξ_i + (d/ρ) (P_i − P₀_i) = 0 in the rows of a closed contact and the normal row of one that slides; for one
// that slides in space (d/ρ) p + ratio e'·ξ_T = (d/ρ) ratio e'·P₀_T besides, P_T = μ P_N e + p e'.
void ProximalNewton::add_equation(const ContactProblem& problem, const Contact& contact, int equation) {
  auto add_row = [&](int i, double factor) {
    for_row(problem, i, [&](int j, double entry) { add_entry(problem, j, factor * entry); });
  };
  if (contact.mode == Mode::slip_space && equation == 1) {
    const Slip& slip = contact.slip;
    add_row(contact.row + 1, -slip.ratio * slip.direction.sine);
    add_row(contact.row + 2, slip.ratio * slip.direction.cosine);
  } else {
    add_row(contact.row + equation, 1.0);
  }
  const int own = contact.unknown + equation;
  add(own, contact.d / hardness_);
  for (int column : columns_) {
    linear_.A().add(column, sums_[column]);
    sums_[column] = 0.0;
  }
  columns_.clear();
  linear_.A().end_row();
  linear_.y().push_back(right_hand_side(problem, contact, equation));
}

// An entry of G times what the unknowns of its column's contact make of P there
void ProximalNewton::add_entry(const ContactProblem& problem, int column, double entry) {
  const int k = contact_of_[column];
  const Contact& contact = contacts_[k];
  if (contact.mode == Mode::open || entry == 0.0) return;
  const int i = column - contact.row;
  if (contact.mode == Mode::closed || i == 0) {
    add(contact.unknown + i, entry);
    return;
  }
  const double mu = friction_of(problem.sets[k]);
  if (contact.mode == Mode::slip_space) {
    const Direction e = contact.slip.direction;
    add(contact.unknown, mu * entry * (i == 1 ? e.cosine : e.sine));
    add(contact.unknown + 1, entry * (i == 1 ? -e.sine : e.cosine));
  } else {
    add(contact.unknown, contact.mode == Mode::slip_plus ? mu * entry : -mu * entry);
  }
}

void ProximalNewton::add(int unknown, double value) {
  const int equation = linear_.A().rows();
  if (seen_in_[unknown] != equation) columns_.push_back(unknown);
  seen_in_[unknown] = equation;
  sums_[unknown] += value;
}

void ProximalNewton::take_solution(const ContactProblem& problem, const double* unknowns) {
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& contact = contacts_[k];
    double* P = full_P_.data() + contact.row;
    const double* x = unknowns + contact.unknown;
    std::fill_n(P, contact.rows, 0.0);
    if (contact.mode == Mode::closed) std::copy_n(x, contact.rows, P);
    if (contact.mode == Mode::open || contact.mode == Mode::closed) continue;
    P[0] = x[0];
    const double radius = friction_of(problem.sets[k]) * x[0];
    if (contact.mode == Mode::slip_space) {
      const Direction e = contact.slip.direction;
      P[1] = radius * e.cosine - x[1] * e.sine;
      P[2] = radius * e.sine + x[1] * e.cosine;
    } else {
      P[1] = contact.mode == Mode::slip_plus ? radius : -radius;
    }
  }
  certify(problem, full_P_.data(), xi_.data());
  for (const Contact& contact : contacts_)
    for (int i = contact.row; i < contact.row + contact.rows; ++i) {
      // Where P is an unknown it is y as well; only elsewhere does ρ magnify the rounding of ξ.
      const bool given = contact.mode == Mode::closed || (contact.mode != Mode::open && i == contact.row);
      full_y_[i] = given ? full_P_[i] : start_[i] - hardness_ / contact.d * xi_[i];
    }
}

}  // namespace saltus
