#include "saltus/kernel/integrators/event_driven/event_driven.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "saltus/numerics/text.hpp"

namespace saltus {
namespace {

constexpr double ulp = std::numeric_limits<double>::epsilon();
constexpr double least_rtol = 1e-13, largest_rtol = 1e-3;
constexpr double safety = 0.1;        // of the tolerance of an inner step: errors add up
constexpr int samples = 4;            // parts of an inner step at whose ends events are looked for
constexpr int most_iterations = 200;  // to locate an event
constexpr int most_events = 5000;     // in a step
constexpr double resolution_in_ulps = 4.0;
// Events of a step that there is storage for before they happen, and what all of them may take.
constexpr int fewest_events = 4, most_stored_events = 64, stored_numbers = 200000;

void require_laws(const NonSmoothDynamicalSystem& model) {
  for (const auto& link : model.links()) {
    const NonSmoothLaw& law = link.interaction->law();
    if (!law.bilateral && (law.sets.size() != 1 || law.gaps != 1))
      throw std::invalid_argument("EventDrivenOSI takes laws of one gap and one contact set, got " +
                                  std::to_string(law.sets.size()) + " sets in '" + link.name + "'");
  }
}

}  // namespace

EventDriven::EventDriven(double rtol, double velocity_tolerance)
    : rtol_(rtol), velocity_tolerance_(velocity_tolerance) {
  if (!(rtol >= least_rtol && rtol <= largest_rtol))
    throw std::invalid_argument("EventDrivenOSI: rtol must be in [1e-13, 1e-3], got " + number(rtol));
  if (!(velocity_tolerance >= 0.0) || !std::isfinite(velocity_tolerance))
    throw std::invalid_argument("EventDrivenOSI: velocity_tolerance must be a finite speed >= 0, got " +
                                number(velocity_tolerance));
}

void EventDriven::prepare(const NonSmoothDynamicalSystem& model, ContactSolver& solver) {
  require_laws(model);
  layout_ = std::make_shared<Layout>(model, solver.tolerance());
  contacts_ = std::make_unique<ContactStage>(layout_, solver);
  motion_ = std::make_unique<FrozenMotion>(layout_, *contacts_);
  solver_ = std::make_unique<RungeKutta>(*motion_, motion_->size(), motion_->controlled(), safety * rtol_);
  const std::size_t contacts = layout_->contacts.size();
  const auto make = [&](Point& point) {
    point.y = point.rate = Vec::Zero(motion_->size());
    point.values.reserve(2 * contacts);
    point.gap_rates.assign(contacts, 0.0);
  };
  samples_.resize(samples - 1);
  for (Point* point : {&now_, &next_, &probe_, &early_}) make(*point);
  for (Point& point : samples_) make(point);
  const int size = 4 * (layout_->n + layout_->rows) + layout_->coordinates + layout_->gaps;
  events_.assign(std::clamp(stored_numbers / size, fewest_events, most_stored_events), storage_of_an_event());
  noise_.reserve(2 * contacts);
  change_.assign(contacts, Change::none);
  impacts_.assign(contacts, {});
  zero_.assign(contacts, 0.0);
  q_.setZero(layout_->coordinates);
  v_.setZero(layout_->n);
  for (Vec* x : {&gamma_, &pushed_, &impulse_, &lambda_plus_}) x->setZero(layout_->rows);
  watched_ = false;
  for (const auto& contact : layout_->contacts) watched_ = watched_ || !contact.law->bilateral;
}

StepReport EventDriven::step(double dt, State& state, Reactions& reactions) {
  StepReport report;
  begin(dt, state);
  if (!motion_->evaluate_free(state.t, q_, v_)) {
    fail(report);
    return report;
  }
  touch(state);
  record_before();
  if (!settle(report)) return report;
  if (report.impulsive) record_after();
  lambda_plus_ = motion_->lambda();
  const double end = state.t + dt;
  while (now_.t < end) {
    if (!advance(end, report)) return report;
    if (report.event_steps <= most_events) continue;
    refuse_events(report);
    return report;
  }
  commit(dt, state, reactions, report);
  return report;
}

void EventDriven::begin(double dt, const State& state) {
  dt_ = size_ = dt;
  q_ = state.q;
  v_ = state.v;
  now_.t = state.t;
  now_.y.setZero();
  now_.y.head(layout_->coordinates) = q_;
  now_.y.segment(layout_->coordinates, layout_->n) = v_;
  impulse_.setZero();
  std::fill(impacts_.begin(), impacts_.end(), Impacts{});
  number_of_events_ = 0;
}

bool EventDriven::fail(StepReport& report) const {
  report.status = motion_->status() == StepStatus::ok ? StepStatus::iteration_failed : motion_->status();
  return false;
}

// Too many of them: is it one contact that bounces?
void EventDriven::refuse_events(StepReport& report) const {
  const auto most = std::max_element(impacts_.begin(), impacts_.end(),
                                     [](const Impacts& a, const Impacts& b) { return a.number < b.number; });
  const bool bounces = most->number > most_events / 4;
  report.status = bounces ? StepStatus::accumulation : StepStatus::iteration_failed;
  report.contact = static_cast<int>(most - impacts_.begin());
}

// One inner step, or a part of it that ends with an event
bool EventDriven::advance(double until, StepReport& report) {
  motion_->clear_status();
  const long rejected = solver_->rejected();
  const bool done = solver_->step(until);
  report.rejected_steps += static_cast<int>(solver_->rejected() - rejected);
  if (!done) return fail(report);
  ++report.accepted_steps;
  size_ = solver_->next_size();
  next_.t = solver_->t();
  next_.y = solver_->y();
  if (!look(next_)) return fail(report);
  if (watched_) {
    const double event = first_event(now_, next_);
    if (event <= next_.t) return locate(event, report);
    if (!look(next_)) return fail(report);  // it has looked elsewhere meanwhile
  }
  std::swap(now_, next_);
  motion_->turn();
  return true;
}

// Rates and what is measured at a point; leaves everything evaluated there
bool EventDriven::look(Point& at) {
  if (!motion_->rate(at.t, at.y.data(), at.rate.data())) return false;
  if (!watched_) return true;
  v_ = at.y.segment(layout_->coordinates, layout_->n);
  motion_->measure(v_, at.values);
  for (int k = 0; k < static_cast<int>(change_.size()); ++k) {
    if (motion_->contact(k).closed()) continue;
    const int row = layout_->contacts[k].row;
    motion_->here().relative_velocity(k, v_, gamma_.data() + row);
    at.gap_rates[k] = gamma_[row];
  }
  return true;
}

bool EventDriven::wrong(const Point& at) const {
  for (std::size_t k = 0; k < at.values.size(); ++k)
    if (at.values[k] < -noise_[k]) return true;
  return false;
}

// The cubic through values and rates at both ends
void EventDriven::interpolate(const Point& start, const Point& end, double x, Point& at) const {
  const double h = end.t - start.t, rest = 1.0 - x;
  at.t = start.t + x * h;
  at.y = (rest * rest * (1.0 + 2.0 * x)) * start.y + (x * x * (3.0 - 2.0 * x)) * end.y +
         (h * x * rest * rest) * start.rate - (h * x * x * rest) * end.rate;
}

// A time at which, or shortly before which, something is wrong that is not at the start; infinity if there is
// none. Looks inside the step as well: a gap that closes and opens again, λ that vanishes for a while.
double EventDriven::first_event(const Point& start, const Point& end) {
  const Point* left = &start;
  for (int part = 1; part <= samples; ++part) {
    const Point* right = &end;
    if (part < samples) {
      Point& sample = samples_[part - 1];
      interpolate(start, end, static_cast<double>(part) / samples, sample);
      if (!look(sample)) continue;  // what is not finite within the step is none of the motion
      right = &sample;
    }
    const double h = right->t - left->t;
    double first = wrong(*right) ? right->t : INFINITY;
    for (std::size_t k = 0; k < change_.size(); ++k) {
      const double a = left->gap_rates[k], b = right->gap_rates[k];
      if (motion_->contact(static_cast<int>(k)).closed() || !(a < 0.0 && b > 0.0)) continue;
      const double x = a / (a - b), g0 = left->values[2 * k], g1 = right->values[2 * k];
      const double lowest = (1 - x) * (1 - x) * (1 + 2 * x) * g0 + x * x * (3 - 2 * x) * g1 +
                            h * x * (1 - x) * ((1 - x) * a - x * b);
      if (lowest < -noise_[2 * k]) first = std::min(first, left->t + x * h);
    }
    if (first < INFINITY) return first;
    left = right;
  }
  return INFINITY;
}

// Takes the motion anew from the start of the inner step
bool EventDriven::follow(double until, Point& to) {
  motion_->clear_status();
  solver_->start(now_.t, now_.y, until - now_.t);
  while (solver_->t() < until)
    if (!solver_->step(until)) return false;
  to.t = solver_->t();
  to.y = solver_->y();
  return look(to);
}

// Bisects the time of the first event between the start of the inner step and `place`, by the Illinois rule:
// the motion is integrated to every trial, since the dense output of ARKODE is not as accurate as its steps.
bool EventDriven::locate(double place, StepReport& report) {
  if (!follow(place, next_)) return fail(report);
  if (!wrong(next_)) {  // only the interpolation said so
    std::swap(now_, next_);
    motion_->turn();
    solver_->start(now_.t, now_.y, size_);
    return true;
  }
  early_ = now_;
  double weight = 1.0;
  int side = 0;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    const double resolution = resolution_in_ulps * ulp * std::max(std::abs(next_.t), dt_);
    const double width = next_.t - early_.t;
    if (width <= resolution) break;
    double t = estimate(early_, next_, weight);
    if (next_.t - t < 0.5 * resolution) t = next_.t - 0.5 * resolution;
    if (t - early_.t < 0.5 * resolution) t = early_.t + 0.5 * resolution;
    if (!(t > early_.t && t < next_.t)) break;
    if (!follow(t, probe_)) return fail(report);
    const bool late = wrong(probe_);
    std::swap(late ? next_ : early_, probe_);
    weight = side == (late ? 1 : -1) ? weight * (late ? 0.5 : 2.0) : 1.0;
    side = late ? 1 : -1;
  }
  std::swap(now_, next_);
  if (!look(now_)) return fail(report);
  mark();
  ++report.event_steps;
  return happen(report);
}

bool EventDriven::happen(StepReport& report) {
  record_before();
  if (!settle(report)) return false;
  record_after();
  return true;
}

LocatedEvent EventDriven::storage_of_an_event() const {
  LocatedEvent event;
  event.q.setZero(layout_->coordinates);
  event.gaps.setZero(layout_->gaps);
  for (Vec* x : {&event.v_before, &event.v, &event.generalised_impulse, &event.generalised_force})
    x->setZero(layout_->n);
  for (Vec* x : {&event.velocities_before, &event.velocities, &event.impulse, &event.force})
    x->setZero(layout_->rows);
  return event;
}

// Of the present point, with its configuration; kept only if record_after() follows
void EventDriven::record_before() {
  if (number_of_events_ == events_.size()) events_.push_back(storage_of_an_event());
  LocatedEvent& event = events_[number_of_events_];
  event.v_before = now_.y.segment(layout_->coordinates, layout_->n);
  take_relative_velocities(event.v_before, event.velocities_before);
  event.impulse = impulse_;
}

void EventDriven::record_after() {
  LocatedEvent& event = events_[number_of_events_++];
  event.t = now_.t;
  event.q = now_.y.head(layout_->coordinates);
  event.v = now_.y.segment(layout_->coordinates, layout_->n);
  event.gaps = motion_->here().gaps();
  take_relative_velocities(event.v, event.velocities);
  event.impulse = impulse_ - event.impulse;
  event.force = motion_->lambda();
  event.generalised_impulse.setZero();
  event.generalised_force.setZero();
  for (int k = 0; k < static_cast<int>(change_.size()); ++k) {
    const int row = layout_->contacts[k].row;
    motion_->here().add_forces(k, event.impulse.data() + row, event.generalised_impulse);
    motion_->here().add_forces(k, event.force.data() + row, event.generalised_force);
  }
}

void EventDriven::take_relative_velocities(const Vec& v, Vec& gamma) {
  for (int k = 0; k < static_cast<int>(change_.size()); ++k)
    motion_->here().relative_velocity(k, v, gamma.data() + layout_->contacts[k].row);
}

// The earliest time at which a line through both ends is zero
double EventDriven::estimate(const Point& early, const Point& late, double weight) const {
  double first = late.t;
  for (std::size_t k = 0; k < late.values.size(); ++k) {
    const double b = late.values[k] + noise_[k], a = weight * (early.values[k] + noise_[k]);
    if (!(b < 0.0)) continue;
    first = std::min(first, late.t - (late.t - early.t) * b / (b - std::max(a, 0.0)));
  }
  return first;
}

void EventDriven::commit(double dt, State& state, Reactions& reactions, StepReport& report) {
  q_ = now_.y.head(layout_->coordinates);
  v_ = now_.y.segment(layout_->coordinates, layout_->n);
  const double* integrals = now_.y.data() + layout_->coordinates + layout_->n;
  report.closed = static_cast<int>(motion_->closed().size());
  for (int k : motion_->closed())
    if (!layout_->contacts[k].law->bilateral)
      report.penetration = std::max(report.penetration, -motion_->here().gaps()[layout_->contacts[k].gap]);
  report.kinetic_energy = motion_->here().kinetic_energy(v_);
  report.work_forces = integrals[layout_->rows];
  report.work_lambda = integrals[layout_->rows + 1];
  state.held.assign(change_.size(), 0);
  for (int k : motion_->closed()) state.held[k] = 1;
  state.t += dt;
  state.q = q_;
  state.v = v_;
  reactions.lambda_plus = lambda_plus_;
  reactions.lambda_minus = motion_->lambda();
  reactions.force = In(integrals, layout_->rows) / dt;
  reactions.impulse = impulse_;
}

}  // namespace saltus
