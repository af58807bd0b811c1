// What happens at an event: impacts, and which contacts are open, stick or slide from then on.
#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/kernel/integrators/event_driven/event_driven.hpp"

namespace saltus {
namespace {

constexpr double velocity_noise = 1e-10;      // what counts as no velocity, relative to its terms
constexpr double speed_of_a_stop = 10.0;      // likewise of one that slides to a stop, in rtol
constexpr double acceleration_noise = 1e-10;  // what counts as none, relative to its terms
constexpr double on_the_cone = 1e-6;          // |λ_T| less than μ λ_N by no more than this fraction may slide
constexpr double gap_noise_in_roundings = 10.0;
constexpr double same_time = 1e-12;         // contacts that close within this part of a step close at once
constexpr int most_passes = 10;             // until modes agree with their forces, and one for each contact
constexpr int most_slow_impacts = 20;       // of a contact in a step
constexpr int shrinking_intervals = 3;      // between impacts of a contact that may accumulate
constexpr double shortest_interval = 1e-6;  // of them, in parts of a step
constexpr double lowest_rebound = 100.0;    // in what counts as no gap
constexpr int most_low_flights = 30;        // of a contact, one after the other

}  // namespace

// Finds the contacts that are closed at the start of a step.
void EventDriven::touch(const State& state) {
  const Vec& gaps = motion_->here().gaps();
  for (int k = 0; k < static_cast<int>(change_.size()); ++k) {
    const auto& slot = layout_->contacts[k];
    ContactState& contact = motion_->contacts()[k];
    change_[k] = Change::none;
    if (slot.law->bilateral) continue;
    const bool held = !state.held.empty() && state.held[k];
    contact.mode = ContactMode::open;
    contact.gap = std::min(gaps[slot.gap], 0.0);
    if (held || gaps[slot.gap] <= gap_noise_in_roundings * motion_->here().gap_tolerance(k, 0))
      change_[k] = Change::closes;
  }
}

// What is wrong with the modes at the present point
void EventDriven::mark() {
  for (int k = 0; k < static_cast<int>(change_.size()); ++k) {
    const bool normal = now_.values[2 * k] < -noise_[2 * k];
    const bool tangential = now_.values[2 * k + 1] < -noise_[2 * k + 1];
    const ContactMode mode = motion_->contact(k).mode;
    change_[k] = Change::none;
    if (normal)
      change_[k] = mode == ContactMode::open ? Change::closes : Change::leaves;
    else if (tangential)
      change_[k] = mode == ContactMode::sliding ? Change::stops : Change::slips;
  }
}

// All that changes at one time: impacts first, then modes until they agree with their forces
bool EventDriven::settle(StepReport& report) {
  const int passes = most_passes + static_cast<int>(change_.size());
  for (int pass = 0; pass < passes; ++pass) {
    if (!meet(pass == 0, report) || !choose_modes(pass > 0, report)) return false;
    motion_->clear_status();
    if (!look(now_)) return fail(report);
    motion_->measure_noise(now_.t, v_, dt_, noise_);
    if (!wrong(now_)) {
      solver_->start(now_.t, now_.y, size_);
      return true;
    }
    mark();
  }
  report.status = StepStatus::iteration_failed;
  return false;
}

// Contacts that close, and those that slide to a stop. @param first  time that the modes are looked at
bool EventDriven::meet(bool first, StepReport& report) {
  v_ = now_.y.segment(layout_->coordinates, layout_->n);
  bool hit = false;
  for (int k = 0; k < static_cast<int>(change_.size()); ++k) {
    const auto& slot = layout_->contacts[k];
    motion_->here().relative_velocity(k, v_, gamma_.data() + slot.row);
    const double terms = motion_->speed_of_terms(k, v_, dt_);
    zero_[k] = velocity_noise * terms;
    if (slot.law->bilateral) {
      for (int i = 0; i < slot.gaps; ++i) hit = hit || std::abs(gamma_[slot.row + i]) > zero_[k];
    } else if (!motion_->contact(k).closed()) {
      hit = close(k) || hit;
    } else if (change_[k] == Change::stops) {
      take_mode_of_velocity(k, std::max(velocity_noise, speed_of_a_stop * rtol_) * terms);
    } else if (first && motion_->contact(k).mode == ContactMode::sliding) {
      take_mode_of_velocity(k, zero_[k]);  // one that stops at the same time
    }
  }
  motion_->choose();
  return !hit || impact(report);
}

// Closes a contact if it is time. @return true if it hits
bool EventDriven::close(int k) {
  const auto& slot = layout_->contacts[k];
  ContactState& contact = motion_->contacts()[k];
  const double gap = motion_->here().gaps()[slot.gap], gamma = gamma_[slot.row];
  const double near = gap_noise_in_roundings * motion_->here().gap_tolerance(k, 0) +
                      same_time * dt_ * motion_->speed_of_terms(k, v_, dt_);
  if (change_[k] != Change::closes && !(gap - contact.gap <= near && gamma < -zero_[k])) return false;
  if (gamma > zero_[k]) {
    open(k);
    return false;
  }
  contact.gap = gap;
  take_mode_of_velocity(k, zero_[k]);
  return gamma < -zero_[k];
}

void EventDriven::open(int k) {
  ContactState& contact = motion_->contacts()[k];
  contact.mode = ContactMode::open;
  contact.gap = std::min(motion_->here().gaps()[layout_->contacts[k].gap], 0.0);
}

// @param none  speeds up to this are none [m/s]
void EventDriven::take_mode_of_velocity(int k, double none) {
  ContactState& contact = motion_->contacts()[k];
  const double* gamma = gamma_.data() + layout_->contacts[k].row;
  contact.mode = contact.mu > 0.0 ? ContactMode::sticking : ContactMode::smooth;
  if (!(contact.mu > 0.0)) return;
  const double y = contact.dim == 3 ? gamma[2] : 0.0, speed = std::hypot(gamma[1], y);
  if (speed > none) slide(k, gamma[1] / speed, y / speed);
}

void EventDriven::slide(int k, double x, double y) {
  ContactState& contact = motion_->contacts()[k];
  contact.mode = ContactMode::sliding;
  contact.before[0] = contact.direction[0] = x;
  contact.before[1] = contact.direction[1] = y;
}

// The impact law on all closed contacts, (56)-(59); v⁻ is the velocity with all λ
bool EventDriven::impact(StepReport& report) {
  report.impulsive = true;
  double approach = 0.0;
  int most = 0;
  for (int k : motion_->closed()) {
    approach = std::max(approach, -gamma_[layout_->contacts[k].row]);
    most = std::max(most, impacts_[k].number);
  }
  // What rocks from one contact to another comes to rest as well, but not before its impacts are many.
  const bool rocks = approach < velocity_tolerance_ && most > most_slow_impacts;
  const double kept = rocks ? velocity_tolerance_ : 0.0;
  bool stopped = false;
  if (!restitute(report)) return false;
  for (int k : motion_->closed()) {
    const auto& slot = layout_->contacts[k];
    const bool bounced = gamma_[slot.row] < -zero_[k];
    motion_->here().relative_velocity(k, v_, gamma_.data() + slot.row);
    if (slot.law->bilateral) continue;
    impacts_[k].number += bounced;
    if (gamma_[slot.row] <= std::max(zero_[k], kept)) {
      stopped = stopped || gamma_[slot.row] > zero_[k];
      take_mode_of_velocity(k, zero_[k]);
      continue;
    }
    if (bounced && accumulates(k, gamma_[slot.row])) {
      report.status = StepStatus::accumulation;
      report.contact = k;
      return false;
    }
    open(k);
  }
  motion_->choose();
  if (stopped && !stop(report)) return false;
  now_.y.segment(layout_->coordinates, layout_->n) = v_;
  return true;
}

// Takes the velocities of contacts that part too slowly to be followed, by impulses as well.
bool EventDriven::stop(StepReport& report) {
  Configuration& here = motion_->here();
  ContactAssembly& assembly = contacts_->assembly();
  for (int k : motion_->closed()) here.relative_velocity(k, v_, gamma_.data() + layout_->contacts[k].row);
  assembly.assemble(motion_->closed(), here, here, here);
  ModeEquations& equations = motion_->equations();
  equations.reduce(ModeEquations::Level::velocity, motion_->closed(), motion_->contacts(), assembly.problem(),
                   gamma_, 1.0);
  if (!equations.solve()) return fail(report);
  equations.expand(contacts_->P());
  push(report);
  return true;
}

// Impulses P act on velocities v at γ.
void EventDriven::push(StepReport& report) {
  ContactAssembly& assembly = contacts_->assembly();
  report.work_impulse += assembly.work(contacts_->P(), motion_->here(), gamma_);
  assembly.apply(1.0, contacts_->P().data(), v_);  // (68)
  pushed_.setZero();
  assembly.scatter(contacts_->P(), 1.0, pushed_);
  impulse_ += pushed_;
}

// v⁺ from v⁻ in v_ and γ⁻ in gamma_
bool EventDriven::restitute(StepReport& report) {
  Configuration& here = motion_->here();
  ContactAssembly& assembly = contacts_->assembly();
  assembly.assemble(motion_->closed(), here, here, here);
  assembly.set_b(here, v_);
  pushed_ = gamma_;
  for (int k : motion_->closed()) {
    const auto& slot = layout_->contacts[k];
    if (slot.law->bilateral || !(std::abs(gamma_[slot.row]) < velocity_tolerance_)) continue;
    pushed_[slot.row] = 0.0;  // plastic
    report.captures += gamma_[slot.row] < -zero_[k];
  }
  assembly.add_restitution(pushed_);  // (59)
  assembly.gather(impulse_, 0.0, contacts_->P());
  if (!contacts_->solve(report)) return false;  // (56)-(58)
  push(report);
  return true;
}

// Do the impacts of a contact follow each other faster and faster, towards a time that has no next event?
bool EventDriven::accumulates(int k, double rebound) {
  Impacts& impacts = impacts_[k];
  const double interval = now_.t - impacts.last;
  const bool shrinks = impacts.number > 2 && interval < impacts.interval;
  impacts.shrinking = shrinks ? impacts.shrinking + 1 : 0;
  impacts.interval = interval;
  impacts.last = now_.t;
  // Flights so low that their impacts cannot be told apart no longer get shorter.
  const double noise = motion_->noise_of_gap(k, now_.t, motion_->speed_of_terms(k, v_, dt_));
  impacts.low = interval * rebound < lowest_rebound * noise ? impacts.low + 1 : 0;
  if (impacts.low >= most_low_flights) return true;
  return impacts.shrinking >= shrinking_intervals && interval < shortest_interval * dt_;
}

// The contact problem of accelerations: which closed contacts open, and which of those without tangential
// velocity start to slide
bool EventDriven::choose_modes(bool forced, StepReport& report) {
  motion_->clear_status();
  if (!motion_->project(now_.t, now_.y.data())) return fail(report);
  q_ = now_.y.head(layout_->coordinates);
  v_ = now_.y.segment(layout_->coordinates, layout_->n);
  if (!motion_->evaluate_free(now_.t, q_, v_)) return fail(report);
  if (!motion_->closed().empty()) {
    ModeEquations& equations = motion_->equations();
    Configuration& here = motion_->here();
    contacts_->assembly().assemble(motion_->closed(), here, here, here);
    motion_->accelerate_contacts(now_.t, v_);
    equations.reduce(ModeEquations::Level::acceleration, motion_->closed(), motion_->contacts(),
                     contacts_->assembly().problem(), motion_->gamma_dot(), dt_);
    if (!contacts_->solve(equations.problem(), equations.P(), report)) return false;
    int row = 0;
    for (int k : motion_->closed()) {
      if (!layout_->contacts[k].law->bilateral) take_mode_of_acceleration(k, equations.equation(row), forced);
      row += layout_->contacts[k].rows;
    }
  }
  motion_->choose();
  return true;
}

// @param row     of the contact in the reduced problem, which is solved
// @param forced  the forces of these modes were wrong before
void EventDriven::take_mode_of_acceleration(int k, int row, bool forced) {
  const ContactProblem& problem = motion_->equations().problem();
  const PoolVec& P = motion_->equations().P();
  const auto& slot = layout_->contacts[k];
  const ContactState& contact = motion_->contact(k);
  const auto xi = [&](int i) {
    double sum = problem.b[row + i];
    for_row(problem, row + i, [&](int j, double entry) { sum += entry * P[j]; });
    return sum;
  };
  const auto noise = [&](int i) {
    return acceleration_noise *
           (motion_->speed_of_terms(k, motion_->acceleration(), 0.0) * dt_ + std::abs(problem.b[row + i]));
  };
  const bool unloaded = P[row] <= noise(0) / entry(problem, row, row);
  if (xi(0) > noise(0) || (change_[k] == Change::leaves && (unloaded || forced))) return open(k);
  if (contact.mode != ContactMode::sticking) return;
  const bool space = contact.dim == 3;
  const double x = xi(1), y = space ? xi(2) : 0.0, size = std::hypot(x, y);
  if (size > noise(1)) return slide(k, x / size, y / size);
  if (change_[k] != Change::slips) return;
  const double friction = std::hypot(P[row + 1], space ? P[row + 2] : 0.0);
  if (!forced && friction < contact.mu * P[row] * (1.0 - on_the_cone)) return;
  const double* lambda = motion_->lambda().data() + slot.row;  // at which it began to slip
  const double z = space ? lambda[2] : 0.0, drag = std::hypot(lambda[1], z);
  slide(k, -lambda[1] / drag, -z / drag);
}

}  // namespace saltus
