#pragma once
#include <memory>
#include <string>
#include <vector>

#include "saltus/kernel/integrators/event_driven/frozen_motion.hpp"

namespace saltus {

/// A reference: between events an ordinary differential equation, integrated to a tolerance; events are
/// located in time, up to rounding. A step begins anew at its state, with nothing remembered.
class EventDriven final : public OneStepIntegrator {
 public:
  /// @param rtol                error of the motion between two events, relative
  /// @param velocity_tolerance  [m/s] a contact that closes more slowly is stopped without restitution
  /// @throws std::invalid_argument if rtol is not in [1e-13, 1e-3] or velocity_tolerance negative
  EventDriven(double rtol, double velocity_tolerance);

  std::string name() const override { return "EventDrivenOSI"; }
  void prepare(const NonSmoothDynamicalSystem& model, ContactSolver& solver) override;
  StepReport step(double dt, State& state, Reactions& reactions) override;
  std::span<const LocatedEvent> events() const override { return {events_.data(), number_of_events_}; }
  std::unique_ptr<OneStepIntegrator> clone() const override {
    return std::make_unique<EventDriven>(rtol_, velocity_tolerance_);
  }

 private:
  /// A state between two events, and what is measured there.
  struct Point {
    double t = 0.0;
    Vec y, rate;
    std::vector<double> values;     // FrozenMotion::measure()
    std::vector<double> gap_rates;  // γ_N of open contacts
  };
  /// What happens to a contact at an event.
  enum class Change : unsigned char { none, closes, leaves, stops, slips };

  // event_driven.cpp: the way from event to event
  void begin(double dt, const State& state);
  void refuse_events(StepReport& report) const;
  bool advance(double until, StepReport& report);
  bool follow(double until, Point& to);
  bool look(Point& at);
  double first_event(const Point& start, const Point& end);
  bool locate(double place, StepReport& report);
  double estimate(const Point& early, const Point& late, double weight) const;
  bool wrong(const Point& at) const;
  void interpolate(const Point& start, const Point& end, double part, Point& at) const;
  bool happen(StepReport& report);
  LocatedEvent storage_of_an_event() const;
  void record_before();
  void record_after();
  void take_relative_velocities(const Vec& v, Vec& gamma);
  void commit(double dt, State& state, Reactions& reactions, StepReport& report);
  bool fail(StepReport& report) const;

  // transitions.cpp: what happens at an event
  void touch(const State& state);
  void mark();
  bool settle(StepReport& report);
  bool meet(bool first, StepReport& report);
  bool close(int contact);
  bool impact(StepReport& report);
  bool restitute(StepReport& report);
  bool stop(StepReport& report);
  void push(StepReport& report);
  bool accumulates(int contact, double rebound);
  void take_mode_of_velocity(int contact, double none);
  bool choose_modes(bool forced, StepReport& report);
  void take_mode_of_acceleration(int contact, int row, bool forced);
  void open(int contact);
  void slide(int contact, double x, double y);

  double rtol_, velocity_tolerance_;
  std::shared_ptr<const Layout> layout_;
  std::unique_ptr<ContactStage> contacts_;
  std::unique_ptr<FrozenMotion> motion_;
  std::unique_ptr<RungeKutta> solver_;
  Point now_, next_, probe_, early_;
  std::vector<Point> samples_;
  std::vector<double> noise_;  // of the values
  std::vector<Change> change_;
  struct Impacts {  // of a contact in this step
    int number = 0;
    double last = 0.0, interval = 0.0;
    int shrinking = 0, low = 0;  // how many intervals shrank, and flights were low, one after the other
  };
  std::vector<Impacts> impacts_;
  std::vector<LocatedEvent> events_;  // the storage of earlier steps is used again
  std::size_t number_of_events_ = 0;
  Vec q_, v_, gamma_, pushed_, impulse_, lambda_plus_;
  std::vector<double> zero_;      // what counts as no normal velocity, of all contacts
  double dt_ = 0.0, size_ = 0.0;  // of this step, and to be tried by the solver
  bool watched_ = false;          // can anything happen?
};

}  // namespace saltus
