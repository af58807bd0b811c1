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
    : settings_(settings),
      rows_(std::move(tableau), settings.level == Level::velocity),
      name_(std::move(name)) {
  if (settings_.stabilized && settings_.activity != Activity::sticky)
    throw std::invalid_argument(name_ +
                                ": positions can only be stabilised with sticky activity, without it a "
                                "contact that is pulled to g = 0 opens by rounding");
  const Tableau& given = rows_.tableau();
  const int s = rows_.s();
  in_order_ = !given.coupled && std::is_sorted(given.c.begin(), given.c.end());
  least_weight_ = given.Av.diagonal().minCoeff();
  // λ_0 that stops a contact within the first row must not push beyond it in the output row, as b_0 > a_10
  // does.
  const bool throws_back = s > 1 || (s == 1 && given.Av(1, 0) > given.Av(0, 0));
  if (given.coupled)
    simple_ = std::make_unique<HalfExplicit>(name_, trapezoidal_tableau(), settings_);
  else if (throws_back && settings_.activity != Activity::predicted)
    simple_ = std::make_unique<HalfExplicit>(name_, heun_tableau(), settings_);
}

void HalfExplicit::prepare(const NonSmoothDynamicalSystem& model, ContactSolver& solver) {
  if (settings_.level == Level::acceleration) require_acceleration_level(name_, model);
  layout_ = std::make_shared<Layout>(model, solver.tolerance());
  rows_.prepare(layout_, model, solver);
  if (settings_.stabilized) projection_ = std::make_unique<PositionProjection>(layout_);
  for (auto* contacts : {&start_, &active_, &drifted_}) contacts->reserve(layout_->contacts.size());
  in_start_.assign(layout_->contacts.size(), 0);
  if (simple_) simple_->prepare(model, solver);
  for (Vec* x : {&gamma_, &impulse_}) x->setZero(layout_->rows);
}

StepReport HalfExplicit::step(double dt, State& state, Reactions& reactions) {
  StepReport report;
  const int s = rows_.s();
  begin(state, reactions);
  if (!rows_.stage(0, dt, report)) return report;
  if (simple_ && approaches(dt)) return simple_->step(dt, state, reactions);
  if (!take_stages(dt, reactions, report)) return report;
  if (!move_to_end(dt, report)) return report;
  report.impulsive = newly_closed();
  const bool continues = !report.impulsive || settings_.impact == ImpactRule::keep_resting_forces;
  if (continues && !row(s + 1, dt, report)) return report;
  if (simple_ && !in_order_ && changes_contacts(continues ? s : s - 1, dt))
    return simple_->step(dt, state, reactions);
  if (!report.impulsive)
    rows_.take_work(dt, rows_.output().v, report);
  else if (!impact(dt, report))
    return report;
  commit(dt, state, reactions, report);
  return report;
}

bool HalfExplicit::take_stages(double dt, const Reactions&, StepReport& report) {
  for (int l = 1; l <= rows_.s(); ++l)
    if (!row(l, dt, report) || !rows_.stage(l, dt, report)) return false;
  return true;
}

void HalfExplicit::begin(const State& state, const Reactions& reactions) {
  rows_.begin(state.t, state.q, state.v, reactions);
  start_.clear();
  for (int k = 0; k < static_cast<int>(in_start_.size()); ++k) {
    in_start_[k] = rows_.at(0).closed(k) || (settings_.activity == Activity::sticky && is_held(k, state));
    if (in_start_[k]) start_.push_back(k);
  }
  impulse_.setZero();
}

// q_i with M, W and gaps, pulled back to the constraints where no impact follows
bool HalfExplicit::move_to_end(double dt, StepReport& report) {
  rows_.move_to_end(dt);
  Configuration& end = rows_.end();
  if (settings_.stabilized && end.finite() && !newly_closed()) {
    const int s = rows_.s();
    drifted_.clear();  // those on which the multiplier before the last presses, λ_{s-1}
    const Vec& lambda = rows_.at_stage(s > 0 ? s - 1 : 0).lambda;
    for (int k : start_) {
      const auto& contact = layout_->contacts[k];
      if (contact.law->bilateral || (lambda[contact.row] > 0.0 && within_reach(k, dt))) drifted_.push_back(k);
    }
    projection_->pull(drifted_, end, rows_.t() + dt, rows_.at(s));  // M of the last stage: close, factorised
  }
  if (!end.finite()) report.status = StepStatus::gap_not_finite;
  if (!end.factorise()) report.status = StepStatus::mass_not_positive_definite;
  return report.status == StepStatus::ok;
}

// Velocity and position of row l, and the multiplier λ_{l-1}
bool HalfExplicit::row(int l, double dt, StepReport& report) {
  rows_.free_velocity(l, dt);
  if (settings_.level == Level::velocity) {
    Configuration& constraint = rows_.constraint(l, dt, settings_.activity == Activity::predicted);
    choose_active(l, constraint);
    rows_.assemble(l, active_, constraint);
  } else {
    choose_staying(rows_.at(l - 1), rows_.at_stage(l - 1), dt);
    rows_.assemble_acceleration(l, dt, active_);
  }
  return rows_.finish(l, dt, active_, report);
}

// The contacts on which λ_{l-1} acts, S1 of (51): C_i, or those closed at the row's position
void HalfExplicit::choose_active(int l, const Configuration& constraint) {
  if (l <= rows_.s() && settings_.activity == Activity::predicted) {
    active_.assign(constraint.closed_contacts().begin(), constraint.closed_contacts().end());
    return;
  }
  active_.clear();
  const bool sticky = settings_.activity == Activity::sticky;
  for (int k : start_)
    if (l <= rows_.s() || sticky || constraint.closed(k)) active_.push_back(k);
}

// The impact law on all closed contacts, (56)-(59), (A.11)-(A.13)
bool HalfExplicit::impact(double dt, StepReport& report) {
  Configuration& end = rows_.end();
  Vec& v = rows_.output().v;
  active_.clear();
  for (int k = 0; k < static_cast<int>(in_start_.size()); ++k)
    if (impacts(k, dt)) active_.push_back(k);
  if (settings_.impact == ImpactRule::paper) {
    v = rows_.at_stage(0).v;
    for (int k = 0; k <= rows_.s(); ++k) {
      Stage& stage = rows_.at_stage(k);
      add_scaled(dt * rows_.tableau().Av(rows_.s(), k), stage.acceleration, v);  // (55)
      stage.lambda.setZero();
      stage.loaded = false;
    }
  }
  rows_.take_work(dt, v, report);
  rows_.contacts().meet(active_, end, v, gamma_);
  return rows_.contacts().strike(end, gamma_, gamma_, v, impulse_, report);
}

void HalfExplicit::commit(double dt, State& state, Reactions& reactions, StepReport& report) {
  Configuration& end = rows_.end();
  Vec& v = rows_.output().v;
  const int s = rows_.s();
  if (!all_finite(v) || !all_finite(end.q())) {
    report.status = StepStatus::not_finite;
    return;
  }
  report.closed = static_cast<int>(active_.size());
  report.penetration = end.penetration();
  report.kinetic_energy = end.kinetic_energy(v);
  if (settings_.activity == Activity::sticky) hold(dt, report.impulsive, state.held);
  rows_.mean_force(reactions.force);
  state.t += dt;
  state.q = end.q();
  state.v.swap(v);
  if (s > 0)
    reactions.lambda_plus.swap(rows_.at_stage(0).lambda);
  else
    reactions.lambda_plus = rows_.at_stage(0).lambda;
  reactions.lambda_minus.swap(rows_.at_stage(s).lambda);
  reactions.impulse.swap(impulse_);
  rows_.advance();  // the end is the next start
}

}  // namespace saltus
