#include "saltus/kernel/integrators/event_driven/frozen_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace saltus {
namespace {

constexpr double ulp = std::numeric_limits<double>::epsilon();
constexpr int most_iterations = 4;         // from a drift of the size of the tolerance one is enough
constexpr double none_in_ulps = 1e3;       // what counts as no speed, of the terms that make it
constexpr double difference = 4e-5;        // of coordinates [m, rad] or of time [s]
constexpr double noise_of_forces = 1e-11;  // relative to the terms that cancel in them

}  // namespace

FrozenMotion::FrozenMotion(std::shared_ptr<const Layout> layout, ContactStage& contacts)
    : layout_(std::move(layout)),
      contacts_(contacts),
      here_(layout_),
      nearby_(layout_),
      equations_(layout_),
      states_(layout_->contacts.size()) {
  for (Vec* x : {&q_, &rate_, &q_nearby_}) x->setZero(layout_->coordinates);
  for (Vec* x : {&v_, &h_, &a_, &change_}) x->setZero(layout_->n);
  for (Vec* x : {&lambda_, &gamma_dot_}) x->setZero(layout_->rows);
  gamma_.resize(layout_->most_rows);
  closed_.reserve(states_.size());
  for (std::size_t k = 0; k < states_.size(); ++k) {
    const auto& law = *layout_->contacts[k].law;
    if (law.bilateral) states_[k].mode = ContactMode::bilateral;
    if (const auto* coulomb = std::get_if<Coulomb>(&law.sets[0])) {
      states_[k].mu = coulomb->mu;
      states_[k].dim = coulomb->dim;
    }
  }
}

void FrozenMotion::choose() {
  closed_.clear();
  for (int k = 0; k < static_cast<int>(states_.size()); ++k)
    if (states_[k].closed()) closed_.push_back(k);
}

bool FrozenMotion::fail(StepStatus status) {
  status_ = status;
  return false;
}

bool FrozenMotion::evaluate_free(double t, const Vec& q, const Vec& v) {
  if (!all_finite(q) || !all_finite(v)) return fail(StepStatus::not_finite);
  if (!here_.is_at(q, t)) here_.move_to(q, t);
  if (!here_.finite()) return fail(StepStatus::gap_not_finite);
  if (!here_.factorise()) return fail(StepStatus::mass_not_positive_definite);
  evaluate_forces(*layout_, t, q, v, h_);
  a_ = h_;
  here_.solve_mass(a_);
  if (!all_finite(a_)) return fail(StepStatus::not_finite);
  return true;
}

bool FrozenMotion::evaluate(double t, const Vec& q, const Vec& v) {
  if (!evaluate_free(t, q, v)) return false;
  lambda_.setZero();
  if (closed_.empty()) return true;
  for (int k : closed_)
    if (states_[k].mode == ContactMode::sliding) slide(k, v);
  ContactAssembly& assembly = contacts_.assembly();
  assembly.assemble(closed_, here_, here_, here_);
  accelerate_contacts(t, v);
  equations_.reduce(ModeEquations::Level::acceleration, closed_, states_, assembly.problem(), gamma_dot_,
                    1.0);
  if (!equations_.solve()) return fail(StepStatus::not_finite);
  equations_.expand(contacts_.P());
  assembly.scatter(contacts_.P(), 1.0, lambda_);
  assembly.apply(1.0, contacts_.P().data(), a_);
  return all_finite(a_) ? true : fail(StepStatus::not_finite);
}

void FrozenMotion::accelerate_contacts(double t, const Vec& v) {
  for (int k : closed_) {
    const auto& slot = layout_->contacts[k];
    double* to = gamma_dot_.data() + slot.row;
    if (slot.relation->has_curvature()) {
      here_.relative_acceleration(k, v, a_, to);
    } else {
      here_.velocity_of_work(k, a_, to);
      add_curvature_by_differences(k, t, v);
    }
  }
}

// sample(weight) at four places along the motion, with the weights of the derivative by time
template <class Sample>
void FrozenMotion::differentiate(double t, Sample sample) {
  const double step = difference / std::max(rate_.lpNorm<Eigen::Infinity>(), 1.0);
  for (const auto& [place, weight] : {std::pair{-2, 1.0}, {-1, -8.0}, {1, 8.0}, {2, -1.0}}) {
    q_nearby_ = here_.q() + place * step * rate_;
    nearby_.move_without_gaps(q_nearby_, t + place * step);
    sample(weight / (12.0 * step));
  }
}

void FrozenMotion::add_curvature_by_differences(int contact, double t, const Vec& v) {
  const auto& slot = layout_->contacts[contact];
  position_rates(*layout_, here_.q(), v, rate_);
  differentiate(t, [&](double weight) {
    nearby_.relative_velocity(contact, v, gamma_.data());
    for (int i = 0; i < slot.rows; ++i) gamma_dot_[slot.row + i] += weight * gamma_[i];
  });
}

// ½ vᵀṀv
double FrozenMotion::inertia_power(double t, const Vec& v) {
  double power = 0.0;
  position_rates(*layout_, here_.q(), v, rate_);
  differentiate(t, [&](double weight) {
    power += nearby_.factorise() ? weight * nearby_.kinetic_energy(v, true)
                                 : std::numeric_limits<double>::quiet_NaN();
  });
  return power;
}

bool FrozenMotion::rate(double t, const double* y, double* rate) {
  const int coordinates = layout_->coordinates, n = layout_->n, rows = layout_->rows;
  q_ = In(y, coordinates);
  v_ = In(y + coordinates, n);
  if (!evaluate(t, q_, v_)) return false;
  position_rates(*layout_, q_, v_, rate_);
  Out(rate, coordinates) = rate_;
  Out(rate + coordinates, n) = a_;
  Out(rate + coordinates + n, rows) = lambda_;
  double* work = rate + coordinates + n + rows;
  work[0] = dot(h_, v_);
  work[1] = 0.0;
  for (int k : closed_) {
    const auto& slot = layout_->contacts[k];
    here_.velocity_of_work(k, v_, gamma_.data());
    for (int i = 0; i < slot.rows; ++i) work[1] += lambda_[slot.row + i] * gamma_[i];
  }
  if (layout_->varying_mass) work[0] += inertia_power(t, v_);
  return true;
}

// q <- q + Y M⁻¹ W (Wᵀ M⁻¹ W)⁺ (g_held − g), and the same of velocities
bool FrozenMotion::project(double t, double* y) {
  q_ = In(y, layout_->coordinates);
  v_ = In(y + layout_->coordinates, layout_->n);
  if (layout_->mapped) normalise(*layout_, q_);
  if (!take_positions(t, q_)) return false;
  if (!closed_.empty()) {
    for (int k : closed_) here_.relative_velocity(k, v_, gamma_dot_.data() + layout_->contacts[k].row);
    equations_.reduce(ModeEquations::Level::velocity, closed_, states_, contacts_.assembly().problem(),
                      gamma_dot_, 1.0);
    if (!equations_.solve()) return fail(StepStatus::not_finite);
    equations_.expand(contacts_.P());
    contacts_.assembly().apply(1.0, contacts_.P().data(), v_);
  }
  Out(y, layout_->coordinates) = q_;
  Out(y + layout_->coordinates, layout_->n) = v_;
  return true;
}

// Moves here, then on to the gaps where the contacts are held; leaves G of the closed contacts there
bool FrozenMotion::take_positions(double t, Vec& q) {
  for (int iteration = 0;; ++iteration) {
    here_.move_to(q, t);
    if (!here_.finite()) return fail(StepStatus::gap_not_finite);
    if (!here_.factorise()) return fail(StepStatus::mass_not_positive_definite);
    if (closed_.empty()) return true;
    contacts_.assembly().assemble(closed_, here_, here_, here_);
    bool off = false;
    for (int k : closed_) {
      const auto& slot = layout_->contacts[k];
      for (int i = 0; i < slot.gaps; ++i) {
        const double drift = here_.gaps()[slot.gap + i] - states_[k].gap;
        gamma_dot_[slot.row + i] = drift;
        off = off || std::abs(drift) > here_.gap_tolerance(k, i);
      }
    }
    if (!off || iteration == most_iterations) return true;
    equations_.reduce(ModeEquations::Level::position, closed_, states_, contacts_.assembly().problem(),
                      gamma_dot_, 1.0);
    if (!equations_.solve()) return fail(StepStatus::not_finite);
    equations_.expand(contacts_.P());
    change_.setZero();
    contacts_.assembly().apply(1.0, contacts_.P().data(), change_);
    position_rates(*layout_, q, change_, rate_);
    q += rate_;
    if (layout_->mapped) normalise(*layout_, q);
  }
}

// Finds the direction d of a contact. @return the speed along it, negative where d points against that of
// before: the friction of before then lasts, so that the motion is smooth beyond the place where it stops.
double FrozenMotion::slide(int contact, const Vec& v) {
  ContactState& state = states_[contact];
  here_.relative_velocity(contact, v, gamma_.data());
  std::copy_n(state.before, 2, state.direction);
  if (state.dim == 2) return state.before[0] * gamma_[1];
  const double along = state.before[0] * gamma_[1] + state.before[1] * gamma_[2];
  const double speed = std::copysign(std::hypot(gamma_[1], gamma_[2]), along);
  const double none = none_in_ulps * ulp * speed_of_terms(contact, v, 0.0);
  if (std::abs(speed) > none)
    for (int i : {0, 1}) state.direction[i] = gamma_[1 + i] / speed;
  return speed;
}

void FrozenMotion::turn() {
  for (int k : closed_) std::copy_n(states_[k].direction, 2, states_[k].before);
}

void FrozenMotion::measure(const Vec& v, std::vector<double>& values) {
  values.assign(2 * states_.size(), 1.0);
  for (int k = 0; k < static_cast<int>(states_.size()); ++k) {
    const ContactState& state = states_[k];
    const double* lambda = lambda_.data() + layout_->contacts[k].row;
    if (state.mode == ContactMode::bilateral) continue;
    values[2 * k] = state.closed() ? lambda[0] : here_.gaps()[layout_->contacts[k].gap] - state.gap;
    if (state.mode == ContactMode::sliding) {
      values[2 * k + 1] = slide(k, v);
    } else if (state.mode == ContactMode::sticking) {
      values[2 * k + 1] = state.mu * lambda[0] - std::hypot(lambda[1], state.dim == 3 ? lambda[2] : 0.0);
    }
  }
}

double FrozenMotion::speed_of_terms(int contact, const Vec& v, double span) {
  return (here_.velocity_tolerance(contact, v) + span * here_.velocity_tolerance(contact, a_)) /
         layout_->tolerance;
}

double FrozenMotion::noise_of_gap(int contact, double t, double speed) {
  return 10.0 * here_.gap_tolerance(contact, 0) + 4.0 * ulp * std::abs(t) * speed;
}

void FrozenMotion::measure_noise(double t, const Vec& v, double span, std::vector<double>& noise) {
  noise.assign(2 * states_.size(), 0.0);
  for (int k = 0; k < static_cast<int>(states_.size()); ++k) {
    const ContactState& state = states_[k];
    const double speed = speed_of_terms(k, v, span);
    if (!state.closed()) noise[2 * k] = noise_of_gap(k, t, speed);
    noise[2 * k + 1] = none_in_ulps * ulp * speed;
  }
  const ContactProblem& problem = contacts_.assembly().problem();
  int row = 0;
  for (int k : closed_) {
    const auto& slot = layout_->contacts[k];
    const double terms = speed_of_terms(k, a_, 0.0) + std::abs(gamma_dot_[slot.row]);
    noise[2 * k] = noise_of_forces * terms / entry(problem, row, row);
    if (states_[k].mode == ContactMode::sticking) noise[2 * k + 1] = states_[k].mu * noise[2 * k];
    row += slot.rows;
  }
}

}  // namespace saltus
