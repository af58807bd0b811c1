#pragma once
#include "saltus/kernel/integrators/adaptive/trial.hpp"

namespace saltus {

/// Tolerances of an inner step.
struct Tolerances {
  double rtol = 1e-6;  ///< of each position and velocity, relative
  double atol = 1e-8;  ///< and absolute, in the unit of each
};

/// What should end an inner step: an open contact that closes, or a sliding one that stops.
struct Event {
  int contact = -1;       ///< -1: nothing of the kind
  bool closes = false;    ///< else it stops
  bool happens = false;   ///< within the step
  bool met = false;       ///< at its end, up to what does not matter
  double x = 0.0;         ///< when [s after the start], by what is known of the step
  double distance = 0.0;  ///< gap over the level to which it falls [m], or speed of sliding [m/s], at the end
  double rate = 0.0;      ///< at which this shrinks
};

/// Looks for events in the trial of an inner step, from what is known at both of its ends.
class EventSearch {
 public:
  EventSearch(std::shared_ptr<const Layout> layout, Tolerances tolerances);

  /// The first one in the last trial. @param is_closed  contacts closed at the start @param h  length [s]
  Event first(Trial& trial, const std::vector<unsigned char>& is_closed, double h);
  /// That of one contact, whether or not it happens.
  Event of(Trial& trial, int contact, bool closed, double h);
  /// Contacts that close in the trial that first() looked at, in ascending order.
  const std::vector<int>& closing() const { return closing_; }

 private:
  Event fall(Trial& trial, int contact, double h);
  Event stop(Trial& trial, int contact, double h);
  bool is_far(Trial& trial, int contact) const;

  std::shared_ptr<const Layout> layout_;
  Tolerances tolerances_;
  std::vector<int> closing_;
  std::vector<double> start_, end_;  // γ of one contact
};

}  // namespace saltus
