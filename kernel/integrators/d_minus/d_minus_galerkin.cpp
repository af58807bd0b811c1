#include "saltus/kernel/integrators/d_minus/d_minus_galerkin.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace saltus {
namespace {

constexpr int most_iterations = 100;
// Changes of velocities in one iteration, relative to the terms that they are sums of: what is rounding, and
// what may be, if it does not become smaller any more.
constexpr double rounding = 4.0 * std::numeric_limits<double>::epsilon(), noise = 1e-12;
constexpr double still_contracting = 0.5;
constexpr double none_in_tolerances = 1e3;  // what counts as no speed

int checked(int stages) {
  if (stages < 1 || stages > 3)
    throw std::invalid_argument("DMinusGalerkinOSI: stages must be 1, 2 or 3, got " + std::to_string(stages));
  return stages;
}

// Multipliers are those of the bodies that rest on each other: an impact elsewhere does not lift them off.
HalfExplicitSettings settings_with(Activity activity) {
  return {.activity = activity, .impact = ImpactRule::keep_resting_forces};
}

double largest(const Vec& x) {
  double size = 0.0;
  for (Eigen::Index i = 0; i < x.size(); ++i) size = std::max(size, std::abs(x.data()[i]));
  return size;
}

double largest_difference(const Vec& x, const Vec& y) {
  double size = 0.0;
  for (Eigen::Index i = 0; i < x.size(); ++i) size = std::max(size, std::abs(x.data()[i] - y.data()[i]));
  return size;
}

}  // namespace

DMinusGalerkin::DMinusGalerkin(int stages, StagePoints points, Activity activity)
    : HalfExplicit("DMinusGalerkinOSI", d_minus_tableau(checked(stages), points), settings_with(activity)),
      points_(points) {}

void DMinusGalerkin::prepare(const NonSmoothDynamicalSystem& model, ContactSolver& solver) {
  HalfExplicit::prepare(model, solver);
  const int s = rows_.s();
  coupled_ = std::make_unique<CoupledContacts>(layout_, solver, rows_.tableau().Av.topLeftCorner(s, s));
  next_.assign(s + 1, Vec::Zero(layout_->n));
  gamma_.setZero(layout_->most_rows);
  if (layout_->mapped) rate_.setZero(layout_->coordinates);
}

StepReport DMinusGalerkin::step(double dt, State& state, Reactions& reactions) {
  const StepReport report = HalfExplicit::step(dt, state, reactions);
  // A contact that changes within the step can make the multipliers go to and fro between its states.
  const bool may_change =
      std::any_of(start_.begin(), start_.end(), [&](int k) { return !layout_->contacts[k].law->bilateral; });
  const bool yields =
      report.status == StepStatus::solver_failed ||  // the problem of one stage is an easier one
      (report.status == StepStatus::iteration_failed && may_change);
  return yields ? simple_->step(dt, state, reactions) : report;
}

bool DMinusGalerkin::take_stages(double dt, const Reactions& before, StepReport& report) {
  begin_iteration(dt, before);
  for (int iteration = 1;; ++iteration) {
    if (!iterate(dt, iteration, report)) return false;
    if (has_converged(dt, iteration)) break;
    if (iteration == most_iterations) {
      report.status = StepStatus::iteration_failed;
      return false;
    }
  }
  if (!needs_end_) rows_.locate(rows_.s(), dt);
  return rows_.stage(rows_.s(), dt, report);
}

// Velocities as if the first stage's acceleration lasted. Of the step before, the first and the last
// multiplier are known, and the mean, which leaves one value for those between.
void DMinusGalerkin::begin_iteration(double dt, const Reactions& before) {
  const Tableau& tableau = rows_.tableau();
  const int s = rows_.s();
  const Stage& start = rows_.at_stage(0);
  needs_end_ = !start_.empty() || layout_->mapped;
  const double first = tableau.Av(s, 0), last = tableau.Av(s, s), between = 1.0 - first - last;
  for (int l = 1; l <= s; ++l) {
    Stage& stage = rows_.at_stage(l);
    stage.v = start.v;
    add_scaled(tableau.c[l] * dt, start.acceleration, stage.v);
    if (layout_->mapped) position_rates(*layout_, rows_.at(0).q(), stage.v, stage.rate);
    if (l < s)
      stage.lambda = (before.force - first * before.lambda_plus - last * before.lambda_minus) / between;
  }
}

// From the velocities of the stages 1..s to better ones
bool DMinusGalerkin::iterate(double dt, int iteration, StepReport& report) {
  const int s = rows_.s();
  for (int l = 1; l < s; ++l) {
    rows_.locate(l, dt);  // (B.1)
    if (!rows_.stage(l, dt, report)) return false;
  }
  if (needs_end_) rows_.locate(s, dt);  // (B.2)
  for (int l = 1; l <= s; ++l) {        // (B.3) without λ
    next_[l] = rows_.at_stage(0).v;
    for (int k = 0; k < s; ++k)
      add_scaled(dt * rows_.tableau().Av(l - 1, k), rows_.at_stage(k).acceleration, next_[l]);
  }
  for (int k = 0; k < s; ++k) {
    rows_.at_stage(k).loaded = !start_.empty();
    if (start_.empty()) rows_.at_stage(k).lambda.setZero();
  }
  if (!start_.empty() && !add_reactions(dt, iteration == 1, report)) return false;
  return take_over(report);
}

// λ of the stages 0..s-1, and what they do to the velocities of the stages 1..s: (B.3), (A.5)-(A.6)
bool DMinusGalerkin::add_reactions(double dt, bool first, StepReport& report) {
  const int s = rows_.s();
  coupled_->assemble(start_, rows_);
  coupled_->sliding().clear();
  for (int k = 0; k < s; ++k) {
    const Stage& stage = rows_.at_stage(k);
    if (first) coupled_->start_from(k, dt, stage.lambda);
    coupled_->set_b(k + 1, rows_.at(k + 1), next_[k + 1]);
    coupled_->sliding().add(start_, rows_.at(k), stage.v);
  }
  if (!coupled_->solve(report)) return false;
  for (int k = 0; k < s; ++k) {
    Stage& stage = rows_.at_stage(k);
    coupled_->read(k, dt, stage.lambda, stage.reaction);
    for (int l = 1; l <= s; ++l) add_scaled(dt * rows_.tableau().Av(l - 1, k), stage.reaction, next_[l]);
  }
  return true;
}

// The velocities of the iteration, and how much they differ from those before. Where q̇ is not v, a position
// can still change while v does not.
bool DMinusGalerkin::take_over(StepReport& report) {
  last_change_ = change_;
  change_ = 0.0;
  for (int l = 1; l <= rows_.s(); ++l) {
    Stage& stage = rows_.at_stage(l);
    stage.v.swap(next_[l]);
    change_ = std::max(change_, largest_difference(stage.v, next_[l]));
    if (!all_finite(stage.v)) report.status = StepStatus::not_finite;
    if (!layout_->mapped) continue;
    stage.rate.swap(rate_);
    position_rates(*layout_, rows_.at(l).q(), stage.v, stage.rate);
    change_ = std::max(change_, largest_difference(stage.rate, rate_));
  }
  return report.status == StepStatus::ok;
}

// By velocities, not by multipliers: contacts that depend on each other can share a load in many ways.
bool DMinusGalerkin::changes_contacts(int, double dt) {
  const Stage& first = rows_.at_stage(0);
  Configuration& start = rows_.at(0);
  for (int k : start_) {
    if (layout_->contacts[k].law->bilateral) continue;
    const double zero =
        none_in_tolerances * std::max(start.velocity_tolerance(k, first.v, first.acceleration, dt),
                                      start.velocity_tolerance(k, first.v));
    for (int stage = 2; stage <= rows_.s() + 1; ++stage)
      if (contact_state(k, stage, zero) != contact_state(k, 1, zero)) return true;
  }
  return false;
}

// 0 open, 1 closed or sticking, 2 and 3 sliding. @param zero  velocities up to this are none [m/s]
int DMinusGalerkin::contact_state(int contact, int stage, double zero) {
  rows_.at(stage).relative_velocity(contact, rows_.at_stage(stage).v, gamma_.data());
  if (gamma_[0] > zero) return 0;
  const auto* law = std::get_if<Coulomb>(&layout_->contacts[contact].law->sets[0]);
  if (!law || law->mu == 0.0) return 1;
  const double speed = std::hypot(gamma_[1], law->dim == 3 ? gamma_[2] : 0.0);
  if (speed <= zero) return 1;
  return law->dim == 3 || gamma_[1] > 0.0 ? 2 : 3;
}

bool DMinusGalerkin::has_converged(double dt, int iteration) const {
  double size = 0.0;
  for (int l = 0; l <= rows_.s(); ++l) {
    const Stage& stage = rows_.at_stage(l);
    size = std::max(size, largest(stage.v));
    if (l < rows_.s()) size = std::max(size, dt * largest(stage.acceleration));
  }
  if (change_ <= rounding * size) return true;
  if (iteration == 1 || change_ > noise * size) return false;
  const double ratio = change_ / last_change_;
  return ratio >= still_contracting || change_ * ratio <= rounding * size;  // the next is rounding
}

}  // namespace saltus
