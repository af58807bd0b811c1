#include "saltus/kernel/integrators/moreau_jean/explicit_moreau_jean.hpp"

#include <utility>

#include "saltus/kernel/integrators/moreau_jean/activity.hpp"

namespace saltus {

void ExplicitMoreauJean::prepare(const NonSmoothDynamicalSystem& model, ContactSolver& solver) {
  layout_ = std::make_shared<Layout>(model, solver.tolerance());
  configurations_.assign(2, Configuration(layout_));
  for (auto& configuration : configurations_) configuration.move_to(model.q0(), model.t0());
  contacts_ = std::make_unique<ContactStage>(layout_, solver);
  active_.reserve(layout_->contacts.size());
  for (Vec* x : {&q_, &rate_}) x->setZero(layout_->coordinates);
  for (Vec* x : {&v_, &h_}) x->setZero(layout_->n);
  for (Vec* x : {&gamma_before_, &gamma_free_}) x->setZero(layout_->rows);
}

StepReport ExplicitMoreauJean::step(double dt, State& state, Reactions& reactions) {
  StepReport report;
  Configuration& start = configurations_[0];
  Configuration& end = configurations_[1];
  if (!start.is_at(state.q, state.t)) start.move_to(state.q, state.t);
  if (!start.factorise()) {
    report.status = StepStatus::mass_not_positive_definite;
    return report;
  }
  if (!predict_active(*layout_, start, state.v, dt, gamma_before_, active_)) {
    report.status = StepStatus::not_finite;
    return report;
  }

  q_ = state.q;
  advance(*layout_, state.q, state.v, dt, rate_, q_);  // (29)
  end.move_to(q_, state.t + dt);
  if (!end.factorise()) {
    report.status = StepStatus::mass_not_positive_definite;
    return report;
  }
  if (!end.finite()) {
    report.status = StepStatus::gap_not_finite;
    return report;
  }
  evaluate_forces(*layout_, state.t, state.q, state.v, h_);
  report.work_forces = dt * h_.dot(state.v);
  start.solve_mass(h_);
  v_ = state.v + dt * h_;
  report.work_forces += inertia_work(start, end, state.v, v_);
  if (contact_impulses(reactions, report)) commit(dt, state, reactions, report);
  return report;
}

// Λ from (31)-(32) and v⁺ from (30)
bool ExplicitMoreauJean::contact_impulses(const Reactions& reactions, StepReport& report) {
  Configuration& end = configurations_[1];
  ContactAssembly& assembly = contacts_->assembly();
  assembly.assemble(active_, end, end, end);
  assembly.set_b(end, v_);
  assembly.scatter(assembly.problem().b, 1.0, gamma_free_);
  assembly.add_restitution(gamma_before_);
  assembly.gather(reactions.impulse, 1.0, contacts_->P());
  if (!contacts_->solve(report)) return false;
  report.work_impulse = assembly.work(contacts_->P(), end, gamma_free_);
  assembly.apply(1.0, contacts_->P().data(), v_);
  return true;
}

void ExplicitMoreauJean::commit(double dt, State& state, Reactions& reactions, StepReport& report) {
  Configuration& end = configurations_[1];
  if (!v_.allFinite() || !q_.allFinite()) {
    report.status = StepStatus::not_finite;
    return;
  }
  report.closed = static_cast<int>(end.closed_contacts().size());
  report.penetration = end.penetration();
  report.kinetic_energy = end.kinetic_energy(v_);
  state.t += dt;
  state.q = q_;
  state.v = v_;
  reactions.impulse.setZero();
  contacts_->assembly().scatter(contacts_->P(), 1.0, reactions.impulse);
  report.impulsive = reactions.impulse.any();
  std::swap(configurations_[0], configurations_[1]);
}

}  // namespace saltus
