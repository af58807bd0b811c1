// Which contacts are held, approach, stay closed, change, or take part in an impact.
#include <cmath>

#include "saltus/kernel/integrators/half_explicit/half_explicit.hpp"

namespace saltus {
namespace {

// What counts as an approach, and as a force, in velocity_tolerance(): solvers come near one of them. Taking
// too much for zero lets a stage act on rounding, too little takes a step with a simpler scheme.
constexpr double approach_in_tolerances = 1e3, force_in_tolerances = 100.0;
// A tangential force is short of sliding if it is so by this fraction.
constexpr double sticking_margin = 1e-9;

}  // namespace

// By memory; before the first step, if it is closed up to rounding and at rest in the normal direction.
bool HalfExplicit::is_held(int contact, const State& state) {
  if (!state.held.empty()) return state.held[contact];
  const auto& slot = layout_->contacts[contact];
  if (!(rows_.at(0).gaps()[slot.gap] <= rows_.at(0).gap_tolerance(contact, 0))) return false;
  rows_.at(0).relative_velocity(contact, state.v, gamma_.data() + slot.row);
  return std::abs(gamma_[slot.row]) <= rows_.at(0).velocity_tolerance(contact, state.v, state.v, 0.0);
}

// Is a contact of C_i still approaching, or a bilateral one violated, at t0 or after an impact elsewhere? A
// multiplier has to stop it within the first stage, and the other stages of a scheme of higher order would
// throw it back.
bool HalfExplicit::approaches(double dt) {
  const Stage& first = rows_.at_stage(0);
  for (int k : start_) {
    const auto& contact = layout_->contacts[k];
    rows_.at(0).relative_velocity(k, first.v, gamma_.data() + contact.row);
    const double zero =
        approach_in_tolerances * rows_.at(0).velocity_tolerance(k, first.v, first.acceleration, dt);
    for (int i = 0; i < contact.gaps; ++i) {
      const double gamma = gamma_[contact.row + i];
      if (gamma < -zero || (contact.law->bilateral && gamma > zero)) return true;
    }
  }
  return false;
}

// Can the gap at the end have drifted open? Not if it is larger than the way of the step: the geometry is
// another one then, such as beyond the edge of a table.
bool HalfExplicit::within_reach(int contact, double dt) {
  const Stage& last = rows_.at_stage(rows_.s());
  const double speed =
      rows_.end().velocity_tolerance(contact, last.v, last.acceleration, dt) / layout_->tolerance;
  return rows_.end().gaps()[layout_->contacts[contact].gap] <= dt * speed;
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
  for (int k : rows_.end().closed_contacts())
    if (!in_start_[k]) return true;
  return false;
}

// Stages that do not follow each other in time cannot tell when it changes: their multipliers would throw it
// up, or to and fro, by a part of h Δt again and again.
bool HalfExplicit::changes_contacts(int last, double dt) {
  const ContactProblem& problem = rows_.contacts().assembly().problem();  // of active_
  int row = 0;
  for (int k : active_) {
    const auto& slot = layout_->contacts[k];
    const double tolerance =
        rows_.at(0).velocity_tolerance(k, rows_.at_stage(0).v, rows_.at_stage(0).acceleration, dt);
    // What rounding makes of no force: an impulse that changes γ by a few times its tolerance.
    const double zero = force_in_tolerances * tolerance / (dt * least_weight_ * entry(problem, row, row));
    row += slot.rows;
    if (slot.law->bilateral) continue;
    for (int stage = 1; stage <= last; ++stage)
      if (contact_state(k, stage, zero) != contact_state(k, 0, zero)) return true;
  }
  return active_.size() != start_.size();  // the gap of one has opened
}

// 0 open, 1 closed or sticking, 2 and 3 sliding. @param zero  forces up to this are none [N]
int HalfExplicit::contact_state(int contact, int stage, double zero) const {
  const auto& slot = layout_->contacts[contact];
  const double* lambda = rows_.at_stage(stage).lambda.data() + slot.row;
  if (!(lambda[0] > zero)) return 0;
  const auto* law = std::get_if<Coulomb>(&slot.law->sets[0]);
  if (!law) return 1;
  const double size = std::hypot(lambda[1], law->dim == 3 ? lambda[2] : 0.0);
  if (size < law->mu * lambda[0] * (1.0 - sticking_margin)) return 1;
  return law->dim == 3 || lambda[1] > 0.0 ? 2 : 3;
}

// Does the impact act on this contact? It is closed, or held and pressed.
bool HalfExplicit::impacts(int contact, double dt) {
  if (rows_.end().closed(contact)) return true;
  if (settings_.activity != Activity::sticky || !in_start_[contact] || !within_reach(contact, dt))
    return false;
  const bool known = settings_.impact == ImpactRule::keep_resting_forces || rows_.s() == 0;
  return rows_.at_stage(known ? rows_.s() : rows_.s() - 1).lambda[layout_->contacts[contact].row] > 0.0;
}

// Contacts that the next step finds closed whatever their gap: pressed by the last multiplier, or not
// separated by the impact
void HalfExplicit::hold(double dt, bool impulsive, std::vector<unsigned char>& held) {
  held.assign(in_start_.size(), 0);
  Configuration& end = rows_.end();
  for (int k : active_) {
    const int row = layout_->contacts[k].row;
    if (impulsive) {
      end.relative_velocity(k, rows_.output().v, gamma_.data() + row);
      // v_s is about v⁻: the terms that cancel in v⁺
      held[k] = std::abs(gamma_[row]) <= end.velocity_tolerance(k, rows_.at_stage(rows_.s()).v,
                                                                rows_.at_stage(rows_.s()).acceleration, dt);
    } else {
      held[k] = rows_.at_stage(rows_.s()).lambda[row] > 0.0 && within_reach(k, dt);
    }
  }
}

}  // namespace saltus
