#include "saltus/kernel/integrators/adaptive/adaptive_half_explicit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "saltus/kernel/integrators/memory.hpp"
#include "saltus/numerics/text.hpp"

namespace saltus {
namespace {

constexpr double least_rtol = 1e-13;
constexpr double same_time = 1e-9;      // of a step of the simulation
constexpr double smallest_part = 1e-6;  // of a step of the simulation, unless a smallest step is given
constexpr long most_attempts = 10'000'000, most_shortest_steps = 100'000;  // in a step of the simulation

constexpr double safety = 0.9, least_factor = 0.1, most_factor = 5.0;
constexpr double exponent = -1.0 / 3.0;  // the error of a step is of third order
constexpr double least_error = 1e-6;
constexpr double part_of_atol = 0.1;

constexpr double never = -std::numeric_limits<double>::infinity();
// A contact bounces no more if its flight, in smallest steps, was shorter than the first of these; or than
// the second where a step was as short as it may be: several contacts that accumulate together take turns.
constexpr double plastic_flight = 1.5, plastic_flight_in_turns = 1e3;
constexpr double most_in_turns = 10.0;  // speed of opening, in that of the impact that opens

}  // namespace

AdaptiveHalfExplicit::AdaptiveHalfExplicit(MakeTrial method, ErrorControl control)
    : method_(method), control_(control) {
  const auto refuse = [this](const std::string& what, double value) {
    throw std::invalid_argument(name() + ": " + what + ", got " + number(value));
  };
  if (!(control_.rtol >= least_rtol && control_.rtol < 1.0))
    refuse("rtol must be in [" + number(least_rtol) + ", 1)", control_.rtol);
  const auto require = [&](const char* what, double value) {
    if (!(value >= 0.0) || !std::isfinite(value))
      refuse(std::string(what) + " must be finite and not negative", value);
  };
  require("atol", control_.atol);
  require("minimum_step", control_.minimum_step);
  require("velocity_tolerance", control_.velocity_tolerance);
}

void AdaptiveHalfExplicit::prepare(const NonSmoothDynamicalSystem& model, ContactSolver& solver) {
  layout_ = std::make_shared<Layout>(model, solver.tolerance());
  trial_ = method_();
  level_.setZero(layout_->gaps);
  trial_->prepare(layout_, model, solver, level_);
  events_ = std::make_unique<EventSearch>(layout_, control_);
  projection_ = std::make_unique<PositionProjection>(layout_);
  view_ = std::make_unique<Configuration>(layout_);
  const std::size_t contacts = layout_->contacts.size();
  for (auto* list : {&closed_, &meeting_}) list->reserve(contacts);
  for (auto* flags : {&is_closed_, &was_closed_}) flags->assign(contacts, 0);
  last_impact_.assign(contacts, never);
  inner_.reserve(*layout_);
  for (Reactions* reactions : {&warm_, &sums_}) reactions->set_zero(layout_->rows);
  for (Vec* rows : {&impact_.impulse, &gamma_, &rebound_}) rows->setZero(layout_->rows);
  v_before_.setZero(layout_->n);
  shown_ = {model.t0(), model.q0(), model.v0()};
  shown_.held.reserve(contacts);
  q_ = model.q0();
  v_ = model.v0();
  valid_ = false;
}

StepReport AdaptiveHalfExplicit::step(double dt, State& state, Reactions& reactions) {
  StepReport report;
  smallest_ = control_.minimum_step > 0.0 ? control_.minimum_step : smallest_part * dt;
  largest_ = std::max(dt, smallest_);  // forces that come and go are not stepped over
  sums_.set_zero(layout_->rows);
  attempts_ = shortest_steps_ = 0;
  const bool goes_on = continues(state.t, state, dt);
  valid_ = false;  // until this step is done: whatever happens, the next begins from its state
  if (!goes_on && !restart(state, reactions, dt, report)) return report;
  if (!take_inner_steps(state.t, state.t + dt, report)) return report;
  show(state.t + dt, dt, state, reactions, report);
  valid_ = report.status == StepStatus::ok;
  return report;
}

// All that outlives a step: where the inner steps have come to, and the last of them if it reaches further.
template <typename Scheme, typename Memory>
void AdaptiveHalfExplicit::exchange(Scheme& scheme, Memory& memory) {
  memory(scheme.t_, scheme.q_, scheme.v_, scheme.closed_, scheme.is_closed_, scheme.last_impact_,
         scheme.level_, scheme.h_, scheme.fastest_);
  memory(scheme.warm_.lambda_plus, scheme.warm_.lambda_minus, scheme.warm_.force, scheme.warm_.impulse);
  auto& inner = scheme.inner_;
  memory(inner.t, inner.dt, inner.q0, inner.rate0, inner.v0, inner.q1, inner.rate1, inner.v1, inner.mean_v,
         inner.place, inner.lambda[0], inner.lambda[1], inner.power_place, inner.power_forces,
         inner.power_lambda, inner.inertia_work);
  memory(scheme.ahead_, scheme.impact_.impulse, scheme.impact_.work, scheme.impact_.happens,
         scheme.impact_.captures, scheme.was_closed_);
  memory(scheme.shown_.t, scheme.shown_.q, scheme.shown_.v, scheme.shown_.held, scheme.valid_);
}

std::vector<double> AdaptiveHalfExplicit::memory() const {
  MemoryWriter memory;
  exchange(*this, memory);
  return std::move(memory.values);
}

void AdaptiveHalfExplicit::remember(std::span<const double> memory) {
  MemoryReader reader(memory);
  exchange(*this, reader);
  reader.finish();
}

// Is this state the one that was shown last? Then what was computed beyond it holds.
bool AdaptiveHalfExplicit::continues(double t, const State& state, double dt) const {
  return valid_ && std::abs(t - shown_.t) <= same_time * dt && state.q == shown_.q && state.v == shown_.v &&
         state.held == shown_.held;
}

bool AdaptiveHalfExplicit::restart(const State& state, const Reactions& reactions, double dt,
                                   StepReport& report) {
  t_ = state.t;
  q_ = state.q;
  v_ = state.v;
  h_ = dt;
  ahead_ = false;
  inner_.dt = dt;
  warm_ = reactions;
  std::fill(last_impact_.begin(), last_impact_.end(), never);
  impact_.happens = false;
  if (!trial_->begin(t_, q_, v_, warm_, report)) return false;
  Configuration& start = trial_->start();
  meeting_.clear();  // all that touch
  bool approaching = false;
  for (int k = 0; k < static_cast<int>(is_closed_.size()); ++k) {
    const auto& contact = layout_->contacts[k];
    const bool held = !state.held.empty() && state.held[k];
    if (!contact.law->bilateral && !held && !(start.gaps()[contact.gap] <= start.gap_tolerance(k, 0)))
      continue;
    meeting_.push_back(k);
    level_[contact.gap] = contact.law->bilateral ? 0.0 : std::min(start.gaps()[contact.gap], 0.0);
    start.relative_velocity(k, v_, gamma_.data() + contact.row);
    const double speed = start.velocity_tolerance(k, v_, trial_->last_acceleration(), 0.0);
    for (int i = 0; i < contact.gaps; ++i) {
      const double gamma = gamma_[contact.row + i];
      approaching = approaching || gamma < -speed || (contact.law->bilateral && gamma > speed);
    }
  }
  if (approaching) {
    if (!impact(start, v_, report)) return false;
    take_impact(report, sums_);
    return true;
  }
  close(start, v_, v_);
  return true;
}

bool AdaptiveHalfExplicit::take_inner_steps(double from, double to, StepReport& report) {
  const double close_by = same_time * (to - from);
  double done = from;
  bool first = true;
  while (true) {
    if (ahead_) {
      const double until = std::min(to, inner_.end());
      if (first) inner_.lambda_at(done, sums_.lambda_plus);
      first = false;
      inner_.add_impulse(done, until, sums_.force);
      report.work_forces += inner_.work_forces(done, until);
      report.work_lambda += inner_.work_lambda(done, until);
      inner_.lambda_at(until, sums_.lambda_minus);
      done = until;
      if (inner_.end() > to + close_by) return true;
      take_impact(report, sums_);
      ahead_ = false;
    }
    if (done >= to - close_by) return true;
    if (!inner_step(report)) return false;
    ahead_ = true;
  }
}

void AdaptiveHalfExplicit::take_impact(StepReport& report, Reactions& sums) {
  if (!impact_.happens) return;
  report.impulsive = true;
  report.work_impulse += impact_.work;
  report.captures += impact_.captures;
  sums.impulse += impact_.impulse;
  impact_.happens = false;
}

// What the simulation sees at the end of its step
void AdaptiveHalfExplicit::show(double to, double dt, State& state, Reactions& reactions,
                                StepReport& report) {
  shown_.t = to;
  if (ahead_) {
    inner_.motion_at(to, shown_.q, shown_.v);
    if (layout_->mapped) normalise(*layout_, shown_.q);
  } else {
    shown_.q = q_;
    shown_.v = v_;
  }
  shown_.held = ahead_ ? was_closed_ : is_closed_;
  view_->move_to(shown_.q, to);
  if (!view_->factorise()) {
    report.status = StepStatus::mass_not_positive_definite;
    return;
  }
  report.closed = static_cast<int>(std::count(shown_.held.begin(), shown_.held.end(), 1));
  report.penetration = view_->penetration();
  report.kinetic_energy = view_->kinetic_energy(shown_.v);
  state = shown_;
  sums_.force /= dt;
  reactions = sums_;
}

// ---- One inner step

bool AdaptiveHalfExplicit::inner_step(StepReport& report) {
  if (!trial_->begin(t_, q_, v_, warm_, report)) return false;
  double h = std::clamp(h_, smallest_, largest_);
  return meet_tolerance(h, report) && meet_event(h, report) && accept(h, report);
}

// The error of a step of length h over the tolerance; infinite if it cannot be taken
double AdaptiveHalfExplicit::attempt(double h, StepReport& report) {
  ++attempts_;
  report.status = StepStatus::ok;
  return trial_->take(h, closed_, report) ? error() : std::numeric_limits<double>::infinity();
}

double AdaptiveHalfExplicit::error() const {
  double largest = 0.0;
  const auto look = [&](const Vec& error, const Vec& start, const Vec& end) {
    for (Eigen::Index i = 0; i < error.size(); ++i) {
      const double size = std::max(std::abs(start[i]), std::abs(end[i]));
      if (error[i] == 0.0) continue;
      const double ratio = std::abs(error[i]) / (control_.atol + control_.rtol * size);
      if (!(ratio <= largest)) largest = ratio;  // or NaN
    }
  };
  look(trial_->error_q(), q_, trial_->end().q());
  look(trial_->error_v(), v_, trial_->v_end());
  return largest;
}

// Takes the step, shorter and shorter, until its error is within the tolerance.
bool AdaptiveHalfExplicit::meet_tolerance(double& h, StepReport& report) {
  bool rejected = false;
  for (;; rejected = true, ++report.rejected_steps) {
    const double error = attempt(h, report);
    const double wish = safety * std::pow(std::max(error, least_error), exponent);
    const bool possible = std::isfinite(error);
    if (possible && (error <= 1.0 || h <= smallest_)) {
      h_ = h * std::clamp(wish, least_factor, rejected ? 1.0 : most_factor);
      return true;
    }
    if (h <= smallest_) return false;  // with the status of the attempt
    if (attempts_ > most_attempts || shortest_steps_ > most_shortest_steps) {
      report.status = StepStatus::too_many_steps;
      return false;
    }
    h = std::max(smallest_, h * (possible ? std::max(wish, least_factor) : least_factor));
  }
}

// Shortens the step to where the first contact closes, or stops, if one does.
bool AdaptiveHalfExplicit::meet_event(double& h, StepReport& report) {
  constexpr int most_iterations = 60, most_by_slope = 8;
  Event event = events_->first(*trial_, is_closed_, h);
  if (!event.happens) return true;
  ++report.event_steps;
  double low = 0.0, high = h;  // it happens between these
  for (int k = 0; k < most_iterations && !event.met && h > smallest_; ++k) {
    double next = event.x;
    if (k >= most_by_slope || !(next > low && next < high)) next = 0.5 * (low + high);
    next = std::max(next, std::min(smallest_, high));
    if (next == h) break;
    h = next;
    if (!std::isfinite(attempt(h, report))) return false;
    const Event found = events_->first(*trial_, is_closed_, h);
    (found.happens ? high : low) = h;
    event = found.happens ? found : events_->of(*trial_, event.contact, is_closed_[event.contact], h);
    if (!found.happens) event.x = h + event.distance / event.rate;  // not there yet
  }
  return true;
}

// Ends the inner step: who leaves, who impacts.
bool AdaptiveHalfExplicit::accept(double h, StepReport& report) {
  Configuration& end = trial_->end();
  const std::vector<int>& closing = events_->closing();
  was_closed_ = is_closed_;
  meeting_.clear();
  for (int k = 0; k < static_cast<int>(is_closed_.size()); ++k)
    if (is_closed_[k] ? !leaves(k, h) : std::binary_search(closing.begin(), closing.end(), k))
      meeting_.push_back(k);
  const bool impulsive = !closing.empty();
  impact_.happens = false;
  for (int k : closing) level_[layout_->contacts[k].gap] = 0.0;
  if (impulsive) projection_->pull(meeting_, end, t_ + h, trial_->last_stage(), &level_);
  if (!end.factorise()) {
    report.status = StepStatus::mass_not_positive_definite;
    return false;
  }
  trial_->describe(inner_);
  inner_.keep_laws(*layout_);
  inner_.t = t_;
  inner_.dt = h;
  warm_.lambda_plus = trial_->first_lambda();
  warm_.lambda_minus = trial_->last_lambda();
  t_ += h;
  q_ = end.q();
  v_ = trial_->v_end();
  ++report.accepted_steps;
  if (h <= smallest_) ++shortest_steps_;
  if (impulsive) {
    if (!impact(end, v_, report)) return false;
  } else {
    for (auto& flag : is_closed_) flag = 0;
    closed_ = meeting_;
    for (int k : closed_) is_closed_[k] = 1;
  }
  trial_->accept();
  return true;
}

// Does a closed contact open at the end? It carries nothing there, moves away, and is further away than
// positions are known: where contacts depend on each other, one that leaves can be thrown back at once.
bool AdaptiveHalfExplicit::leaves(int k, double h) {
  const auto& contact = layout_->contacts[k];
  if (contact.law->bilateral || trial_->last_lambda()[contact.row] > 0.0) return false;
  Configuration& end = trial_->end();
  if (end.gaps()[contact.gap] - level_[contact.gap] <= part_of_atol * control_.atol) return false;
  end.relative_velocity(k, trial_->v_end(), gamma_.data() + contact.row);
  return gamma_[contact.row] > end.velocity_tolerance(k, trial_->v_end(), trial_->last_acceleration(), h);
}

// ---- Impacts

// The impact law on the contacts that meet, at t_; v <- v⁺
bool AdaptiveHalfExplicit::impact(Configuration& at, Vec& v, StepReport& report) {
  StepReport law;
  trial_->contacts().meet(meeting_, at, v, gamma_);
  choose_rebound(at, v);
  impact_.impulse.setZero();
  v_before_ = v;
  if (!trial_->contacts().strike(at, gamma_, rebound_, v, impact_.impulse, law)) {
    report.status = law.status;
    report.residual = std::max(report.residual, law.residual);
    return false;
  }
  report.solver_iterations += law.solver_iterations;
  report.residual = std::max(report.residual, law.residual);
  impact_.happens = true;
  impact_.work = law.work_impulse;
  close(at, v_before_, v);
  return true;
}

// γ⁻ of contacts that bounce; 0 of those that open, rest, or have no time to.
void AdaptiveHalfExplicit::choose_rebound(Configuration& at, const Vec& v) {
  rebound_ = gamma_;
  impact_.captures = 0;
  fastest_ = 0.0;
  for (int k : meeting_) {
    const auto& contact = layout_->contacts[k];
    if (contact.law->bilateral) continue;
    const double speed = -gamma_[contact.row];
    const double zero = at.velocity_tolerance(k, v);
    if (speed <= zero) {  // rests, or opens
      rebound_[contact.row] = 0.0;
      continue;
    }
    const double flight = t_ - last_impact_[k];
    const bool shortest = inner_.dt <= smallest_;
    const bool short_flight = flight < (shortest ? plastic_flight_in_turns : plastic_flight) * smallest_;
    const bool low = std::isfinite(flight) && 0.25 * speed * flight <= 10.0 * at.gap_tolerance(k, 0);
    last_impact_[k] = t_;
    fastest_ = std::max(fastest_, speed);
    if (!short_flight && !low && speed >= control_.velocity_tolerance) continue;
    ++impact_.captures;
    for (int i = 0; i < contact.rows; ++i) rebound_[contact.row + i] = 0.0;
  }
}

// Contacts that accumulate together open each other in turns, at last for less than the smallest steps.
bool AdaptiveHalfExplicit::takes_turns(int k, double speed) const {
  return inner_.dt <= smallest_ && t_ - last_impact_[k] <= plastic_flight_in_turns * smallest_ &&
         speed <= most_in_turns * fastest_;
}

// Contacts that the impact does not separate, or that rest at the start, are closed from now on.
void AdaptiveHalfExplicit::close(Configuration& at, const Vec& before, const Vec& after) {
  closed_.clear();
  std::fill(is_closed_.begin(), is_closed_.end(), 0);
  for (int k : meeting_) {
    const auto& contact = layout_->contacts[k];
    at.relative_velocity(k, after, gamma_.data() + contact.row);
    const double zero = at.velocity_tolerance(k, before) + at.velocity_tolerance(k, after);
    if (!contact.law->bilateral && gamma_[contact.row] > zero && !takes_turns(k, gamma_[contact.row]))
      continue;
    closed_.push_back(k);
    is_closed_[k] = 1;
  }
}

}  // namespace saltus
