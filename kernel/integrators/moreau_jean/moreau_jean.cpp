#include "saltus/kernel/integrators/moreau_jean/moreau_jean.hpp"

#include <algorithm>
#include <stdexcept>

#include "saltus/kernel/integrators/moreau_jean/activity.hpp"
#include "saltus/numerics/text.hpp"

namespace saltus {
namespace {

constexpr int most_iterations = 50;
// Change of the velocities in one iteration, relative to those with and without contact: below it, rounding.
constexpr double newton_tolerance = 1e-12;

}  // namespace

MoreauJean::MoreauJean(double theta, double gamma) : theta_(theta), gamma_(gamma) {
  if (!(theta >= 0.0 && theta <= 1.0))
    throw std::invalid_argument("theta must be in [0, 1], got " + number(theta));
  if (!(gamma >= 0.0 && gamma <= 1.0))
    throw std::invalid_argument("gamma must be in [0, 1], got " + number(gamma));
}

void MoreauJean::prepare(const NonSmoothDynamicalSystem& model, ContactSolver& solver) {
  layout_ = std::make_shared<Layout>(model, solver.tolerance());
  configurations_.assign(2, Configuration(layout_));
  middle_ = std::make_unique<Configuration>(configurations_[0]);
  for (auto& configuration : configurations_) configuration.move_to(model.q0(), model.t0());
  matrix_ = std::make_unique<IterationMatrix>(layout_);
  contacts_ = std::make_unique<ContactStage>(layout_, matrix_->partition(), solver);
  active_.reserve(layout_->contacts.size());
  for (Vec* x : {&q_, &q_middle_, &rate_}) x->setZero(layout_->coordinates);
  for (Vec* x : {&v_, &next_, &change_, &h_, &h_end_}) x->setZero(layout_->n);
  gamma_before_.setZero(layout_->rows);
  linear_ = !layout_->mapped &&
            std::all_of(layout_->systems.begin(), layout_->systems.end(),
                        [](const auto& system) { return system.model->time_invariant(); }) &&
            std::all_of(layout_->contacts.begin(), layout_->contacts.end(),
                        [](const auto& contact) { return contact.relation->constant_jacobian(); }) &&
            std::all_of(layout_->forces.begin(), layout_->forces.end(),
                        [](const auto& force) { return force.element->time_invariant(); });
}

StepReport MoreauJean::step(double dt, State& state, Reactions& reactions) {
  StepReport report;
  if (!begin(dt, state, report)) return report;
  contacts_->P().resize(0);
  for (int iteration = 1;; ++iteration) {
    if (!iterate(dt, state, reactions, report)) return report;
    change_ = next_ - v_;
    v_ = next_;
    if (linear_ || change_.cwiseAbs().maxCoeff() <= newton_tolerance * size_) break;
    if (iteration == most_iterations) {
      report.status = StepStatus::iteration_failed;
      return report;
    }
  }
  if (move(dt, state, report)) commit(dt, state, reactions, report);
  return report;
}

// Forces, relative velocities and active contacts at the start; the iteration starts from v.
bool MoreauJean::begin(double dt, const State& state, StepReport& report) {
  Configuration& start = configurations_[0];
  if (!start.is_at(state.q, state.t)) start.move_to(state.q, state.t);
  if (!start.factorise()) {
    report.status = StepStatus::mass_not_positive_definite;
    return false;
  }
  evaluate_forces(*layout_, state.t, state.q, state.v, h_);
  if (!predict_active(*layout_, start, state.v, dt, gamma_before_, active_, gamma_) || !h_.allFinite()) {
    report.status = StepStatus::not_finite;
    return false;
  }
  v_ = state.v;
  size_ = v_.cwiseAbs().maxCoeff();
  return true;
}

// q⁺ and q_θ of the velocity at hand; Y half way is of order 2 if that velocity is
bool MoreauJean::move(double dt, const State& state, StepReport& report) {
  Configuration& end = configurations_[1];
  change_ = theta_ * v_ + (1.0 - theta_) * state.v;
  q_middle_ = state.q;
  if (layout_->mapped) advance(*layout_, state.q, change_, 0.5 * dt, rate_, q_middle_);
  q_ = state.q;
  advance(*layout_, q_middle_, change_, dt, rate_, q_);
  end.move_to(q_, state.t + dt);
  q_middle_ = (1.0 - theta_) * state.q + theta_ * q_;
  if (layout_->mapped) normalise(*layout_, q_middle_);
  middle_->move_without_gaps(q_middle_, state.t + theta_ * dt);
  if (!end.factorise() || !middle_->factorise()) report.status = StepStatus::mass_not_positive_definite;
  if (!end.finite()) report.status = StepStatus::gap_not_finite;
  return report.status == StepStatus::ok;
}

// One of Newton's iterations, from v_ to next_, with the contact problem inside
bool MoreauJean::iterate(double dt, const State& state, const Reactions& reactions, StepReport& report) {
  if (!move(dt, state, report)) return false;
  Configuration& end = configurations_[1];
  evaluate_forces(*layout_, state.t + dt, end.q(), v_, h_end_);
  if (!h_end_.allFinite()) {
    report.status = StepStatus::not_finite;
    return false;
  }
  report.status = matrix_->update(theta_, dt, state.t + dt, *middle_, end.q(), v_);
  if (report.status != StepStatus::ok) return false;
  change_ = v_ - state.v;
  middle_->multiply_mass(change_, next_);
  next_ -= dt * (theta_ * h_end_ + (1.0 - theta_) * h_);  // the residual without contacts
  matrix_->solve(next_);
  next_ = v_ - next_;
  if (!next_.allFinite()) {
    report.status = StepStatus::not_finite;
    return false;
  }
  size_ = std::max(size_, next_.cwiseAbs().maxCoeff());

  ContactAssembly& assembly = contacts_->assembly();
  assembly.assemble(active_, end, end, *matrix_);
  assembly.set_b(end, next_);
  assembly.add_restitution(gamma_before_);
  PoolVec& P = contacts_->P();
  if (P.size() != assembly.problem().rows()) assembly.gather(reactions.impulse, 1.0, P);  // of the last step
  if (!contacts_->solve(report)) return false;
  assembly.apply(1.0, P.data(), next_);
  return true;
}

void MoreauJean::commit(double dt, State& state, Reactions& reactions, StepReport& report) {
  Configuration& start = configurations_[0];
  Configuration& end = configurations_[1];
  if (!v_.allFinite() || !end.q().allFinite()) {
    report.status = StepStatus::not_finite;
    return;
  }
  // The change of ½vᵀMv is exactly the work of Λ, h and the change of M, all at the mean velocity
  const double inertia = end.kinetic_energy(v_, true) - middle_->kinetic_energy(v_, true) +
                         middle_->kinetic_energy(state.v, true) - start.kinetic_energy(state.v, true);
  evaluate_forces(*layout_, state.t + dt, end.q(), v_, h_end_);
  change_ = 0.5 * (v_ + state.v);
  report.work_forces = inertia + dt * (theta_ * h_end_ + (1.0 - theta_) * h_).dot(change_);
  report.kinetic_energy = end.kinetic_energy(v_);
  reactions.impulse.setZero();
  contacts_->assembly().scatter(contacts_->P(), 1.0, reactions.impulse);
  report.impulsive = reactions.impulse.any();
  for (int k : active_) {
    const auto& contact = layout_->contacts[k];
    double* gamma = gamma_before_.data() + contact.row;
    end.velocity_of_work(k, change_, gamma);
    report.work_impulse += reactions.impulse.segment(contact.row, contact.rows).dot(In(gamma, contact.rows));
  }
  report.closed = static_cast<int>(end.closed_contacts().size());
  report.penetration = end.penetration();
  state.t += dt;
  state.q = end.q();
  state.v = v_;
  std::swap(configurations_[0], configurations_[1]);
}

}  // namespace saltus
