#include "saltus/kernel/integrators/half_explicit/half_explicit.hpp"

#include <stdexcept>

#include "saltus/numerics/text.hpp"

namespace saltus {
namespace {

void require_acceleration_level(const std::string& scheme, const NonSmoothDynamicalSystem& model) {
  for (const auto& link : model.links()) {
    for (const ContactSet& set : link.interaction->law().sets)
      if (const auto* law = std::get_if<Coulomb>(&set); law && law->mu > 0.0)
        throw std::invalid_argument(scheme + " takes no friction, got mu = " + number(law->mu) + " in '" +
                                    link.name + "'");
    if (!link.interaction->relation().has_curvature())
      throw std::invalid_argument(scheme + " needs the curvature of every relation, '" + link.name +
                                  "' does not define it");
  }
}

}  // namespace

HalfExplicit::HalfExplicit(std::string name, Tableau tableau, Level level, Activity activity)
    : name_(std::move(name)), tableau_(std::move(tableau)), level_(level), activity_(activity) {
  validate(tableau_);
  s_ = tableau_.stages() - 1;
  explicit_.assign(s_ + 2, true);
  same_as_last_.assign(s_ + 2, false);
  for (int l = 1; l <= s_ + 1; ++l) {
    explicit_[l] =
        l == s_ + 1 || (level_ == Level::velocity && tableau_.Ac.row(l - 1) == tableau_.Aq.row(l - 1));
    same_as_last_[l] = l > 1 && tableau_.Aq.row(l - 1) == tableau_.Aq.row(l - 2);
  }
}

void HalfExplicit::prepare(const NonSmoothDynamicalSystem& model, ContactSolver& solver) {
  if (level_ == Level::acceleration) require_acceleration_level(name_, model);
  layout_ = std::make_shared<Layout>(model);
  slot_.assign(1, 0);
  for (int l = 1; l <= s_ + 1; ++l) slot_.push_back(slot_.back() + (same_as_last_[l] ? 0 : 1));
  const Configuration blank(layout_);
  configurations_.assign(slot_.back() + 1, blank);
  for (auto& configuration : configurations_) configuration.move_to(model.q0());
  predicted_ = std::make_unique<Configuration>(blank);
  contacts_ = std::make_unique<ContactStage>(layout_, solver);
  stages_.resize(s_ + 2);
  for (Stage& stage : stages_) {
    for (Vec* x : {&stage.v, &stage.h, &stage.acceleration, &stage.reaction}) x->setZero(layout_->n);
    stage.lambda.setZero(layout_->rows);
  }
  active_.reserve(layout_->contacts.size());
  q_.setZero(layout_->n);
  for (Vec* x : {&gamma_, &impulse_}) x->setZero(layout_->rows);
}

StepReport HalfExplicit::step(double dt, State& state, Reactions& reactions) {
  StepReport report;
  begin(state, reactions);
  if (!stage(0, state.t, dt, report)) return report;
  for (int l = 1; l <= s_; ++l)
    if (!row(l, dt, report) || !stage(l, state.t, dt, report)) return report;
  if (!same_as_last_[s_ + 1]) {
    position(tableau_.Aq, s_ + 1, dt);  // (64)
    at(s_ + 1).move_to(q_);
  }
  if (!at(s_ + 1).factorise()) {
    report.status = StepStatus::mass_not_positive_definite;
    return report;
  }
  if (!at(s_ + 1).finite()) {
    report.status = StepStatus::gap_not_finite;
    return report;
  }
  report.impulsive = newly_closed();
  const bool solved = report.impulsive ? impact(dt, report) : row(s_ + 1, dt, report);
  if (!solved) return report;
  take_work(dt, report);
  commit(dt, state, reactions, report);
  return report;
}

void HalfExplicit::begin(const State& state, const Reactions& reactions) {
  if (at(0).q() != state.q) at(0).move_to(state.q);
  stages_[0].v = state.v;
  stages_[0].lambda = reactions.lambda_plus;
  stages_[s_].lambda = s_ > 0 ? reactions.lambda_minus : reactions.lambda_plus;
  impulse_.setZero();
}

// q_ <- q_0 + Δt Σ_k A_lk v_k
void HalfExplicit::position(const Matrix& A, int l, double dt) {
  q_ = at(0).q();
  const double* weight = &A(l - 1, 0);
  for (int k = 0; k <= s_; ++k)
    if (weight[k] != 0.0) add_scaled(dt * weight[k], stages_[k].v, q_);
}

// h and M⁻¹h at stage l
bool HalfExplicit::stage(int l, double t, double dt, StepReport& report) {
  Stage& stage = stages_[l];
  if (!at(l).factorise()) {
    report.status = StepStatus::mass_not_positive_definite;
    return false;
  }
  evaluate_forces(*layout_, t + tableau_.c[l] * dt, at(l).q(), stage.v, stage.h);
  stage.acceleration = stage.h;
  at(l).solve_mass(stage.acceleration);
  return true;
}

// Velocity and position of row l, and the multiplier λ_{l-1}: (66), (69)-(70), (63) and (67), (71)-(72)
bool HalfExplicit::row(int l, double dt, StepReport& report) {
  Stage& force = stages_[l - 1];
  Stage& next = stages_[l];
  const double weight = dt * tableau_.Av(l - 1, l - 1);

  next.v = stages_[0].v;  // v_free: everything but λ_{l-1}
  for (int k = 0; k < l - 1; ++k) {
    add_scaled(dt * tableau_.Av(l - 1, k), stages_[k].acceleration, next.v);
    if (stages_[k].loaded) add_scaled(dt * tableau_.Av(l - 1, k), stages_[k].reaction, next.v);
  }
  add_scaled(weight, force.acceleration, next.v);

  if (level_ == Level::velocity)
    constrain_velocity(l, dt);
  else
    constrain_acceleration(l, dt);
  force.loaded = !active_.empty();
  if (!force.loaded) {
    force.lambda.setZero();
  } else {
    ContactAssembly& assembly = contacts_->assembly();
    assembly.gather(force.lambda, weight, contacts_->P());
    if (!contacts_->solve(report)) return false;
    force.lambda.setZero();
    assembly.scatter(contacts_->P(), 1.0 / weight, force.lambda);
    force.reaction.setZero();
    assembly.apply(1.0 / weight, contacts_->P().data(), force.reaction);
    add_scaled(weight, force.reaction, next.v);
  }

  if (l <= s_ && !explicit_[l] && !same_as_last_[l]) {
    position(tableau_.Aq, l, dt);
    at(l).move_to(q_);
  }
  return true;
}

// W at the row's own position, or at a prediction of it where that needs the velocity first, (69), (71)
void HalfExplicit::constrain_velocity(int l, double dt) {
  // A constant W needs no prediction, where the activity needs none either.
  const bool foreseen = !explicit_[l] && !layout_->varying_jacobian && activity_ == Activity::start;
  Configuration& constraint = explicit_[l] ? at(l) : foreseen ? at(0) : *predicted_;
  if (l <= s_ && !foreseen && !(explicit_[l] && same_as_last_[l])) {
    position(tableau_.Ac, l, dt);
    if (explicit_[l] || activity_ == Activity::predicted)
      constraint.move_to(q_);
    else
      constraint.move_without_gaps(q_);
  }
  choose_closed(l > s_ ? at(l) : activity_ == Activity::predicted ? constraint : at(0));
  if (active_.empty()) return;
  contacts_->assembly().assemble(active_, constraint, at(l - 1), at(l - 1));
  contacts_->assembly().set_b(constraint, stages_[l].v);
}

// g̈ at the stage of the multiplier, times the time that it acts: (40), (49)-(50)
void HalfExplicit::constrain_acceleration(int l, double dt) {
  const Stage& stage = stages_[l - 1];
  choose_staying(at(l - 1), stage, dt);
  if (active_.empty()) return;
  contacts_->assembly().assemble(active_, at(l - 1), at(l - 1), at(l - 1));
  contacts_->assembly().set_b_of_acceleration(at(l - 1), stage.v, stage.acceleration,
                                              dt * tableau_.Av(l - 1, l - 1));
}

// Contacts with g <= 0 and the bilateral ones, S1 of (51)
void HalfExplicit::choose_closed(const Configuration& at) {
  active_.assign(at.closed_contacts().begin(), at.closed_contacts().end());
}

// Closed contacts that do not open, S2 of (52); the solver's tolerance must not tell those at rest apart
void HalfExplicit::choose_staying(Configuration& at, const Stage& stage, double dt) {
  active_.clear();
  for (int k : at.closed_contacts()) {
    const auto& contact = layout_->contacts[k];
    at.relative_velocity(k, stage.v, gamma_.data() + contact.row);
    const double zero = at.velocity_tolerance(k, stage.v, stage.acceleration, dt);
    if (contact.law->bilateral || gamma_[contact.row] <= zero) active_.push_back(k);
  }
}

bool HalfExplicit::newly_closed() {
  for (int k : at(s_ + 1).closed_contacts())
    if (!at(0).closed(k)) return true;
  return false;
}

// The impact law on all closed contacts, from a velocity without any λ: (55)-(59), (A.11)-(A.13)
bool HalfExplicit::impact(double dt, StepReport& report) {
  Configuration& end = at(s_ + 1);
  Vec& v = stages_[s_ + 1].v;
  v = stages_[0].v;
  for (int k = 0; k <= s_; ++k) add_scaled(dt * tableau_.Av(s_, k), stages_[k].acceleration, v);  // (55)
  for (Stage& stage : stages_) stage.lambda.setZero();

  choose_closed(end);
  ContactAssembly& assembly = contacts_->assembly();
  assembly.assemble(active_, end, end, end);
  assembly.set_b(end, v);
  assembly.scatter(assembly.problem().b, 1.0, gamma_);  // γ⁻
  assembly.add_restitution(gamma_);                     // (59)
  assembly.gather(impulse_, 0.0, contacts_->P());
  if (!contacts_->solve(report)) return false;  // (56)-(58)
  assembly.scatter(contacts_->P(), 1.0, impulse_);
  report.work_forces = inertia_work(at(0), end, stages_[0].v, v);
  assembly.apply(1.0, contacts_->P().data(), v);  // (68)
  report.work_impulse = assembly.work(contacts_->P(), gamma_);
  return true;
}

void HalfExplicit::take_work(double dt, StepReport& report) {
  if (!report.impulsive)
    report.work_forces = inertia_work(at(0), at(s_ + 1), stages_[0].v, stages_[s_ + 1].v);
  for (int k = 0; k <= s_; ++k) {
    const double weight = dt * tableau_.Av(s_, k);
    report.work_forces += weight * dot(stages_[k].h, stages_[k].v);
    if (!report.impulsive && stages_[k].loaded) report.work_lambda += weight * lambda_power(k);
  }
}

// λ_kᵀ W(q_k)ᵀ v_k [W]
double HalfExplicit::lambda_power(int k) {
  double power = 0.0;
  for (int contact = 0; contact < static_cast<int>(layout_->contacts.size()); ++contact) {
    const auto& slot = layout_->contacts[contact];
    const double* lambda = stages_[k].lambda.data() + slot.row;
    if (lambda[0] == 0.0 && !slot.law->bilateral) continue;
    double* gamma = gamma_.data() + slot.row;
    at(k).relative_velocity(contact, stages_[k].v, gamma);
    for (int i = 0; i < slot.rows; ++i) power += lambda[i] * gamma[i];
  }
  return power;
}

void HalfExplicit::commit(double dt, State& state, Reactions& reactions, StepReport& report) {
  Configuration& end = at(s_ + 1);
  if (!all_finite(stages_[s_ + 1].v) || !all_finite(end.q())) {
    report.status = StepStatus::not_finite;
    return;
  }
  report.closed = static_cast<int>(active_.size());
  report.penetration = end.penetration();
  report.kinetic_energy = end.kinetic_energy(stages_[s_ + 1].v);
  state.t += dt;
  state.q = end.q();
  state.v.swap(stages_[s_ + 1].v);
  if (s_ > 0)
    reactions.lambda_plus.swap(stages_[0].lambda);
  else
    reactions.lambda_plus = stages_[0].lambda;
  reactions.lambda_minus.swap(stages_[s_].lambda);
  reactions.impulse.swap(impulse_);
  std::swap(slot_[0], slot_[s_ + 1]);  // the end is the next start
  for (int l = s_; l > 0 && same_as_last_[l + 1]; --l) slot_[l] = slot_[l + 1];
}

}  // namespace saltus
