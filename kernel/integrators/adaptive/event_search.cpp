#include "saltus/kernel/integrators/adaptive/event_search.hpp"

#include <algorithm>
#include <cmath>

#include "saltus/kernel/integrators/adaptive/crossing.hpp"

namespace saltus {
namespace {

constexpr double rounding = 1e-15;
constexpr double part_of_tolerance = 1e-3;  // in which the time of an event may be off

}  // namespace

EventSearch::EventSearch(std::shared_ptr<const Layout> layout, Tolerances tolerances)
    : layout_(std::move(layout)),
      tolerances_(tolerances),
      start_(layout_->most_rows),
      end_(layout_->most_rows) {
  closing_.reserve(layout_->contacts.size());
}

Event EventSearch::first(Trial& trial, const std::vector<unsigned char>& is_closed, double h) {
  Event first;
  closing_.clear();
  for (int k = 0; k < static_cast<int>(is_closed.size()); ++k) {
    if (!is_closed[k] && is_far(trial, k)) continue;
    const Event event = of(trial, k, is_closed[k], h);
    if (!event.happens) continue;
    if (event.closes) closing_.push_back(k);
    if (!first.happens || event.x < first.x) first = event;
  }
  return first;
}

Event EventSearch::of(Trial& trial, int contact, bool closed, double h) {
  return closed ? stop(trial, contact, h) : fall(trial, contact, h);
}

// Further away than it moves, in the step and inside of it
bool EventSearch::is_far(Trial& trial, int contact) const {
  const int gap = layout_->contacts[contact].gap;
  const double g0 = trial.start().gaps()[gap], g1 = trial.end().gaps()[gap];
  const double inside = trial.middle().gaps()[gap];
  return std::min({g0, g1, inside}) > std::abs(g1 - g0) + 3.0 * std::abs(inside - g0);
}

// To zero, or to where it was if rounding has left it below.
Event EventSearch::fall(Trial& trial, int k, double h) {
  const int gap = layout_->contacts[k].gap;
  Configuration &start = trial.start(), &end = trial.end();
  start.relative_velocity(k, trial.v_start(), start_.data());
  end.relative_velocity(k, trial.v_end(), end_.data());
  const GapCurve curve{start.gaps()[gap], start_[0], end.gaps()[gap], end_[0], h};
  const double level = std::min(curve.g0, 0.0);
  Event event{.contact = k, .closes = true, .distance = curve.g1 - level, .rate = -curve.rate1};
  const double exact = end.gap_tolerance(k, 0) + rounding * (std::abs(curve.g0) + std::abs(curve.rate0) * h);
  const double enough = std::max(exact, part_of_tolerance * tolerances_.rtol * std::abs(curve.rate1) * h);
  event.x = h;
  event.met = event.happens = curve.rate1 < 0.0 && std::abs(event.distance) <= enough;
  if (event.met) return event;
  if (const auto x = first_fall(curve, level)) {
    event.happens = true;
    event.x = *x;
  }
  return event;
}

// Sticking, or sliding the other way at the end. The stop is met if the step goes beyond it by so little that
// the friction of that time does not matter.
Event EventSearch::stop(Trial& trial, int k, double h) {
  const auto* law = std::get_if<Coulomb>(&layout_->contacts[k].law->sets[0]);
  if (!law || law->mu == 0.0) return {};
  const auto speed = [&](Configuration& at, const Vec& v, std::vector<double>& gamma) {
    at.relative_velocity(k, v, gamma.data());
    return law->dim == 3 ? std::hypot(gamma[1], gamma[2]) : std::abs(gamma[1]);
  };
  const double before = speed(trial.start(), trial.v_start(), start_);
  const double size = trial.start().velocity_tolerance(k, trial.v_start()) / layout_->tolerance;
  const double enough = part_of_tolerance * (tolerances_.atol + tolerances_.rtol * size);
  if (before <= enough) return {};
  const double inside = speed(trial.middle(), trial.v_middle(), end_);
  const double after = speed(trial.end(), trial.v_end(), end_);
  const double zero = trial.end().velocity_tolerance(k, trial.v_start());
  const bool reversed = law->dim == 2 && start_[1] * end_[1] < 0.0;
  Event event{.contact = k, .distance = after};
  event.happens = after <= zero || reversed;
  if (!event.happens) {
    event.rate = (before - after) / h;
    event.distance += enough;  // a little beyond: then it has stopped
    return event;
  }
  const double middle = trial.middle_place() * h;
  event.rate = inside > zero && inside < before ? (before - inside) / middle : before / middle;
  event.x = (before + enough) / event.rate;
  event.met = (h - before / event.rate) * event.rate <= 2.0 * enough;
  return event;
}

}  // namespace saltus
