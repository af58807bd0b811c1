#include "saltus/kernel/integrators/half_explicit/half_explicit.hpp"

#include <algorithm>
#include <cmath>
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

HalfExplicit::HalfExplicit(std::string name, Tableau tableau, HalfExplicitSettings settings)
    : name_(std::move(name)), tableau_(std::move(tableau)), settings_(settings) {
  validate(tableau_);
  if (settings_.stabilized && settings_.activity != Activity::sticky)
    throw std::invalid_argument(name_ +
                                ": positions can only be stabilised with sticky activity, without it a "
                                "contact that is pulled to g = 0 opens by rounding");
  s_ = tableau_.stages() - 1;
  in_order_ = std::is_sorted(tableau_.c.begin(), tableau_.c.end());
  least_weight_ = tableau_.Av.diagonal().minCoeff();
  // λ_0 that stops a contact within the first row must not push beyond it in the output row, as b_0 > a_10
  // does.
  const bool throws_back = s_ > 1 || (s_ == 1 && tableau_.Av(1, 0) > tableau_.Av(0, 0));
  if (throws_back && settings_.activity != Activity::predicted)
    simple_ = std::make_unique<HalfExplicit>(name_, heun_tableau(), settings_);
  explicit_.assign(s_ + 2, true);
  same_as_last_.assign(s_ + 2, false);
  is_end_.assign(s_ + 2, false);
  for (int l = 1; l <= s_ + 1; ++l) {
    explicit_[l] = l == s_ + 1 ||
                   (settings_.level == Level::velocity && tableau_.Ac.row(l - 1) == tableau_.Aq.row(l - 1));
    same_as_last_[l] = l > 1 && tableau_.Aq.row(l - 1) == tableau_.Aq.row(l - 2);
    is_end_[l] = tableau_.Aq.row(l - 1) == tableau_.Aq.row(s_);
  }
}

void HalfExplicit::prepare(const NonSmoothDynamicalSystem& model, ContactSolver& solver) {
  if (settings_.level == Level::acceleration) require_acceleration_level(name_, model);
  layout_ = std::make_shared<Layout>(model, solver.tolerance());
  slot_.assign(1, 0);
  for (int l = 1; l <= s_ + 1; ++l) slot_.push_back(slot_.back() + (same_as_last_[l] ? 0 : 1));
  const Configuration blank(layout_);
  configurations_.assign(slot_.back() + 1, blank);
  for (auto& configuration : configurations_) configuration.move_to(model.q0(), model.t0());
  predicted_ = std::make_unique<Configuration>(blank);
  contacts_ = std::make_unique<ContactStage>(layout_, solver);
  sliding_ = std::make_unique<Sliding>(layout_);
  stages_.resize(s_ + 2);
  for (Stage& stage : stages_) {
    for (Vec* x : {&stage.v, &stage.h, &stage.acceleration, &stage.reaction}) x->setZero(layout_->n);
    if (layout_->mapped) stage.rate.setZero(layout_->coordinates);
    stage.lambda.setZero(layout_->rows);
  }
  if (settings_.stabilized) projection_ = std::make_unique<PositionProjection>(layout_);
  for (auto* contacts : {&start_, &active_, &drifted_}) contacts->reserve(layout_->contacts.size());
  in_start_.assign(layout_->contacts.size(), 0);
  if (simple_) simple_->prepare(model, solver);
  q_.setZero(layout_->coordinates);
  for (Vec* x : {&gamma_, &impulse_}) x->setZero(layout_->rows);
}

StepReport HalfExplicit::step(double dt, State& state, Reactions& reactions) {
  StepReport report;
  begin(state, reactions);
  if (!stage(0, state.t, dt, report)) return report;
  if (simple_ && approaches(dt)) return simple_->step(dt, state, reactions);
  for (int l = 1; l <= s_; ++l)
    if (!row(l, dt, report) || !stage(l, state.t, dt, report)) return report;
  if (!move_to_end(dt, report)) return report;
  report.impulsive = newly_closed();
  const bool continues = !report.impulsive || settings_.impact == ImpactRule::keep_resting_forces;
  if (continues && !row(s_ + 1, dt, report)) return report;
  if (simple_ && !in_order_ && changes_contacts(continues ? s_ : s_ - 1, dt))
    return simple_->step(dt, state, reactions);
  if (report.impulsive && !impact(dt, report)) return report;
  take_work(dt, report);
  commit(dt, state, reactions, report);
  return report;
}

void HalfExplicit::begin(const State& state, const Reactions& reactions) {
  t_ = state.t;
  if (!at(0).is_at(state.q, t_)) at(0).move_to(state.q, t_);
  start_.clear();
  for (int k = 0; k < static_cast<int>(in_start_.size()); ++k) {
    in_start_[k] = at(0).closed(k) || (settings_.activity == Activity::sticky && is_held(k, state));
    if (in_start_[k]) start_.push_back(k);
  }
  stages_[0].v = state.v;
  if (layout_->mapped) position_rates(*layout_, state.q, state.v, stages_[0].rate);
  stages_[0].lambda = reactions.lambda_plus;
  stages_[s_].lambda = s_ > 0 ? reactions.lambda_minus : reactions.lambda_plus;
  impulse_.setZero();
}

// q_i with M, W and gaps, (64), pulled back to the constraints where no impact follows
bool HalfExplicit::move_to_end(double dt, StepReport& report) {
  Configuration& end = at(s_ + 1);
  if (!same_as_last_[s_ + 1]) {
    position(tableau_.Aq, s_ + 1, dt);
    move(end, s_ + 1, dt);
  }
  if (settings_.stabilized && end.finite() && !newly_closed()) {
    drifted_.clear();  // those on which the multiplier before the last presses, λ_{s-1}
    const Vec& lambda = stages_[s_ > 0 ? s_ - 1 : 0].lambda;
    for (int k : start_) {
      const auto& contact = layout_->contacts[k];
      if (contact.law->bilateral || (lambda[contact.row] > 0.0 && within_reach(k, dt))) drifted_.push_back(k);
    }
    projection_->pull(drifted_, end, t_ + dt, at(s_));  // M of the last stage: it is close, and factorised
  }
  if (!end.finite()) report.status = StepStatus::gap_not_finite;
  if (!end.factorise()) report.status = StepStatus::mass_not_positive_definite;
  return report.status == StepStatus::ok;
}

// q_ <- q_0 + Δt Σ_k A_lk q̇_k
void HalfExplicit::position(const Matrix& A, int l, double dt) {
  q_ = at(0).q();
  const double* weight = &A(l - 1, 0);
  for (int k = 0; k <= s_; ++k)
    if (weight[k] != 0.0) add_scaled(dt * weight[k], layout_->mapped ? stages_[k].rate : stages_[k].v, q_);
}

// To q_ at the time of row l. Only the end is brought back to allowed coordinates: rates of stages that were
// would not belong together.
void HalfExplicit::move(Configuration& configuration, int l, double dt) {
  if (layout_->mapped && is_end_[l]) normalise(*layout_, q_);
  configuration.move_to(q_, time(l, dt));
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

  if (settings_.level == Level::velocity)
    constrain_velocity(l, dt);
  else
    constrain_acceleration(l, dt);
  force.loaded = !active_.empty();
  if (!force.loaded) {
    force.lambda.setZero();
  } else {
    ContactAssembly& assembly = contacts_->assembly();
    // Warm start: the first and the last multiplier from the step before, the others from the row before.
    const bool inner = l > 1 && l <= s_;
    assembly.gather(inner ? stages_[l - 2].lambda : force.lambda, weight, contacts_->P());
    const bool slides = sliding_->find(active_, at(l - 1), force.v);
    if (!(slides ? sliding_->solve(*contacts_, report) : contacts_->solve(report))) return false;
    force.lambda.setZero();
    assembly.scatter(contacts_->P(), 1.0 / weight, force.lambda);
    force.reaction.setZero();
    assembly.apply(1.0 / weight, contacts_->P().data(), force.reaction);
    add_scaled(weight, force.reaction, next.v);
  }

  if (l <= s_ && layout_->mapped) {  // Y where v_l is not needed to get there
    if (!explicit_[l]) position(tableau_.Ac, l, dt);
    position_rates(*layout_, explicit_[l] ? at(l).q() : q_, next.v, next.rate);
  }
  if (l <= s_ && !explicit_[l] && !same_as_last_[l]) {
    position(tableau_.Aq, l, dt);
    move(at(l), l, dt);
  }
  return true;
}

// W at the row's own position, or at a prediction of it where that needs the velocity first, (69), (71)
void HalfExplicit::constrain_velocity(int l, double dt) {
  const bool predicts = settings_.activity == Activity::predicted;
  // A constant W needs no prediction, where the activity needs none either.
  const bool foreseen = !explicit_[l] && !layout_->varying_jacobian && !layout_->rheonomous && !predicts;
  Configuration& constraint = explicit_[l] ? at(l) : foreseen ? at(0) : *predicted_;
  if (l <= s_ && !foreseen && !(explicit_[l] && same_as_last_[l])) {
    position(tableau_.Ac, l, dt);
    if (explicit_[l] || predicts)
      move(constraint, l, dt);
    else
      constraint.move_without_gaps(q_, time(l, dt));
  }
  choose_active(l, constraint);
  if (active_.empty()) return;
  contacts_->assembly().assemble(active_, constraint, at(l - 1), at(l - 1));
  contacts_->assembly().set_b(constraint, stages_[l].v);
}

// The contacts on which λ_{l-1} acts, S1 of (51): C_i, or those closed at the row's position
void HalfExplicit::choose_active(int l, const Configuration& constraint) {
  if (l <= s_ && settings_.activity == Activity::predicted) {
    active_.assign(constraint.closed_contacts().begin(), constraint.closed_contacts().end());
    return;
  }
  active_.clear();
  const bool sticky = settings_.activity == Activity::sticky;
  for (int k : start_)
    if (l <= s_ || sticky || constraint.closed(k)) active_.push_back(k);
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

// The impact law on all closed contacts, (56)-(59), (A.11)-(A.13)
bool HalfExplicit::impact(double dt, StepReport& report) {
  Configuration& end = at(s_ + 1);
  Vec& v = stages_[s_ + 1].v;
  active_.clear();
  for (int k = 0; k < static_cast<int>(in_start_.size()); ++k)
    if (impacts(k, dt)) active_.push_back(k);
  if (settings_.impact == ImpactRule::paper) {
    v = stages_[0].v;
    for (int k = 0; k <= s_; ++k) add_scaled(dt * tableau_.Av(s_, k), stages_[k].acceleration, v);  // (55)
    for (Stage& stage : stages_) {
      stage.lambda.setZero();
      stage.loaded = false;
    }
  }
  ContactAssembly& assembly = contacts_->assembly();
  assembly.assemble(active_, end, end, end);
  assembly.set_b(end, v);
  assembly.scatter(assembly.problem().b, 1.0, gamma_);  // γ⁻
  assembly.add_restitution(gamma_);                     // (59)
  assembly.gather(impulse_, 0.0, contacts_->P());
  if (!contacts_->solve(report)) return false;  // (56)-(58)
  assembly.scatter(contacts_->P(), 1.0, impulse_);
  report.work_forces = inertia_work(at(0), end, stages_[0].v, v);
  report.work_impulse = assembly.work(contacts_->P(), end, gamma_);
  assembly.apply(1.0, contacts_->P().data(), v);  // (68)
  return true;
}

void HalfExplicit::take_work(double dt, StepReport& report) {
  if (!report.impulsive)
    report.work_forces = inertia_work(at(0), at(s_ + 1), stages_[0].v, stages_[s_ + 1].v);
  for (int k = 0; k <= s_; ++k) {
    const double weight = dt * tableau_.Av(s_, k);
    report.work_forces += weight * dot(stages_[k].h, stages_[k].v);
    if (stages_[k].loaded) report.work_lambda += weight * lambda_power(k);
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
    at(k).velocity_of_work(contact, stages_[k].v, gamma);
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
  if (settings_.activity == Activity::sticky) hold(dt, report.impulsive, state.held);
  reactions.force.setZero();
  for (int k = 0; k <= s_; ++k) add_scaled(tableau_.Av(s_, k), stages_[k].lambda, reactions.force);
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
