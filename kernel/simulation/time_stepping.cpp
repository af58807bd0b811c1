#include "saltus/kernel/simulation/time_stepping.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "saltus/kernel/assembly/force_elements.hpp"
#include "saltus/kernel/model/requirements.hpp"
#include "saltus/numerics/solvers/registry.hpp"
#include "saltus/numerics/text.hpp"

namespace saltus {
namespace {

constexpr double until_tolerance = 1e-12;
constexpr double until_tolerance_in_steps = 1e-3;
constexpr long longest_interval = 512;   // between two calls of progress
constexpr double longest_silence = 0.1;  // [s]

// @param about  the contact that the status is about, or empty
std::string describe(double time, long step, const std::string& about,
                     const std::vector<std::string>& contacts, const StepReport& report) {
  char text[160];
  std::snprintf(text, sizeof text, "step %ld from t = %.9g s failed: ", step, time);
  std::string message =
      text + (about.empty() ? "" : "'" + about + "': ") + std::string(to_string(report.status));
  std::snprintf(text, sizeof text, " (residual %.3g m/s; closed contacts: ", report.residual);
  message += text;
  for (std::size_t k = 0; k < contacts.size() && k < 8; ++k) message += (k ? ", " : "") + contacts[k];
  if (contacts.empty()) message += "none";
  if (contacts.size() > 8) message += ", ... " + std::to_string(contacts.size()) + " in all";
  return message + ")";
}

}  // namespace

double require_time_step(double dt, double t0) {
  if (!(dt > 0.0) || !std::isfinite(dt))
    throw std::invalid_argument("time_step must be positive and finite, got " + number(dt));
  if (t0 + dt == t0)
    throw std::invalid_argument("time_step must change t0 = " + number(t0) + ", got " + number(dt));
  return dt;
}

bool reaches(double until, double t0, double time_step, long steps) {
  const double last =
      until + std::min(until_tolerance * std::abs(until), until_tolerance_in_steps * time_step);
  return t0 + (steps + 1) * time_step <= last;
}

class TimeStepping::Busy {
 public:
  Busy(bool& flag, const char* what) : flag_(flag) {
    if (flag_)
      throw std::logic_error(std::string(what) + " was called while a step of this simulation is taken");
    flag_ = true;
  }
  ~Busy() { flag_ = false; }
  Busy(const Busy&) = delete;
  Busy& operator=(const Busy&) = delete;

 private:
  bool& flag_;
};

SimulationError::SimulationError(double time, long step, const std::string& about,
                                 std::vector<std::string> contacts, const StepReport& report)
    : std::runtime_error(describe(time, step, about, contacts, report)),
      time_(time),
      step_(step),
      contacts_(std::move(contacts)),
      report_(report) {}

SimulationError::SimulationError(double time, long step, const std::string& message, const StepReport& report)
    : std::runtime_error(message), time_(time), step_(step), report_(report) {}

TimeStepping::TimeStepping(const NonSmoothDynamicalSystem& model, const OneStepIntegrator& integrator,
                           double time_step, const ContactSolver& solver)
    : model_(model),
      integrator_(integrator.clone()),
      solver_(solver.clone()),
      dt_(require_time_step(time_step, model.t0())),
      state_{model.t0(), model.q0(), model.v0()},
      layout_(std::make_shared<Layout>(model_)),
      view_(layout_),
      velocities_(Vec::Zero(layout_->rows)) {
  solver_.set_tolerance(solver.tolerance());
  reactions_.set_zero(layout_->rows);
  state_.held.reserve(layout_->contacts.size());
  check_start();
  integrator_->prepare(model_, solver_);
}

TimeStepping::TimeStepping(const NonSmoothDynamicalSystem& model, const OneStepIntegrator& integrator,
                           double time_step)
    : TimeStepping(model, integrator, time_step, *make_contact_solver("auto")) {}

// What the model says at t0 must make sense before the first step: a NaN found later names no culprit.
void TimeStepping::check_start() {
  for (std::size_t k = 0; k < layout_->systems.size(); ++k) {
    const auto& system = layout_->systems[k];
    const std::string who = " of system " + std::to_string(k);
    const In q(state_.q.data() + system.first, system.coordinates);
    const In v(state_.v.data() + system.offset, system.n);
    if (!system.constant_mass) {  // the others were checked when view_ was made
      Matrix M = Matrix::Zero(system.n, system.n);
      system.model->mass(q, {M.data(), system.n, system.n});
      require_mass(M, system.n, "mass" + who + " at t0");
    }
    Vec h = Vec::Zero(system.n);
    system.model->forces(state_.t, q, v, {h.data(), system.n});
    if (!h.allFinite())
      throw std::invalid_argument("forces" + who + " at t0 must be finite, got NaN or infinity");
  }
  check_force_elements();
  view_.move_to(state_.q, state_.t);
  view_.factorise();
  report_.kinetic_energy = view_.kinetic_energy(state_.v);
  report_.penetration = view_.penetration();
  report_.closed = static_cast<int>(view_.closed_contacts().size());
  for (std::size_t k = 0; k < layout_->contacts.size(); ++k) {
    const auto& contact = layout_->contacts[k];
    const int index = static_cast<int>(k);
    const std::string who = " of '" + model_.links()[k].name + "' at t0 must be finite, got NaN or infinity";
    if (!view_.gaps().segment(contact.gap, contact.gaps).allFinite())
      throw std::invalid_argument("gap" + who);
    if (!InMatrix(view_.jacobian(index), contact.rows, contact.n).allFinite())
      throw std::invalid_argument("jacobian" + who);
  }
}

void TimeStepping::check_force_elements() {
  if (layout_->forces.empty()) return;
  std::vector<double> storage(3 * layout_->largest_force);
  for (std::size_t k = 0; k < layout_->forces.size(); ++k) {
    const auto& slot = layout_->forces[k];
    const Stretch start = stretch(*layout_, slot, state_.t, state_.q, state_.v, storage.data());
    const std::string who =
        " of force element '" + model_.forces()[k].name + "' at t0 must be finite, got NaN or infinity";
    if (!std::isfinite(start.length)) throw std::invalid_argument("length" + who);
    if (!In(start.W, slot.n).allFinite()) throw std::invalid_argument("jacobian" + who);
    if (!std::isfinite(slot.element->law().force(state_.t, start.length, start.rate)))
      throw std::invalid_argument("force" + who);
  }
  Vec h(layout_->n);
  evaluate_forces(*layout_, state_.t, state_.q, state_.v, h);  // sizes its storage before the first step
}

void TimeStepping::add_observer(std::shared_ptr<Observer> observer) {
  if (!observer) throw std::invalid_argument("add_observer needs an observer, got none");
  const Busy busy(busy_, "add_observer");
  if (step_ == 0) {
    look();
    show(*observer);
  }
  observers_.push_back(std::move(observer));
}

void TimeStepping::run(double until) {
  if (!std::isfinite(until)) throw std::invalid_argument("until must be finite, got " + number(until));
  long interval = 1;  // in steps; follows what they cost
  auto shown = std::chrono::steady_clock::now();
  for (long k = 1; reaches(until); ++k) {
    step();
    if (!progress_ || k % interval != 0) continue;
    progress_(state_.t);
    const auto now = std::chrono::steady_clock::now();
    const double silence = std::chrono::duration<double>(now - shown).count();
    shown = now;
    interval = silence > 0.5 * longest_silence ? 1 : std::min(2 * interval, longest_interval);
  }
}

bool TimeStepping::reaches(double until) const { return saltus::reaches(until, model_.t0(), dt_, step_); }

const StepReport& TimeStepping::step() {
  const Busy busy(busy_, "step");
  const StepReport report = integrator_->step(dt_, state_, reactions_);
  if (report.status != StepStatus::ok) fail(report);
  report_ = report;
  ++step_;
  state_.t = model_.t0() + step_ * dt_;  // not the sum of many roundings
  bool looked = false;
  for (const auto& observer : observers_) {
    if (!observer->wants(step_, report_)) continue;
    if (!looked) look();
    looked = true;
    show(*observer);
  }
  return report_;
}

Checkpoint TimeStepping::checkpoint() const {
  return {step_, state_, reactions_, report_, integrator_->memory()};
}

void TimeStepping::restore(const Checkpoint& checkpoint) {
  const Busy busy(busy_, "restore");
  const State& state = checkpoint.state;
  const Reactions& reactions = checkpoint.reactions;
  const auto require = [](const char* what, auto expected, auto got) {
    if (static_cast<long>(expected) != static_cast<long>(got))
      throw std::invalid_argument(std::string(what) + " of a checkpoint must have " +
                                  std::to_string(expected) + " entries, got " + std::to_string(got));
  };
  require("q", state_.q.size(), state.q.size());
  require("v", state_.v.size(), state.v.size());
  if (!state.held.empty()) require("held", layout_->contacts.size(), state.held.size());
  for (const Vec* rows :
       {&reactions.lambda_plus, &reactions.lambda_minus, &reactions.force, &reactions.impulse})
    require("reactions", layout_->rows, rows->size());
  if (checkpoint.step < 0 || !state.q.allFinite() || !state.v.allFinite())
    throw std::invalid_argument("a checkpoint must have a step >= 0 and finite q and v");
  try {
    integrator_->remember(checkpoint.memory);
  } catch (...) {
    integrator_->prepare(model_, solver_);  // half of a memory is none
    throw;
  }
  step_ = checkpoint.step;
  state_ = state;
  state_.held.reserve(layout_->contacts.size());
  reactions_ = reactions;
  report_ = checkpoint.report;
}

// Gaps, relative velocities and potential energy at the present state
void TimeStepping::look() {
  view_.move_to(state_.q, state_.t);
  for (int k = 0; k < static_cast<int>(layout_->contacts.size()); ++k)
    view_.relative_velocity(k, state_.v, velocities_.data() + layout_->contacts[k].row);
  potential_energy_ = potential_energy(*layout_, state_.t, state_.q);
}

void TimeStepping::show(Observer& observer) {
  observer.observe({step_, state_, view_.gaps(), velocities_, reactions_, report_, potential_energy_, view_});
}

void TimeStepping::fail(const StepReport& report) {
  view_.move_to(state_.q, state_.t);
  std::vector<std::string> contacts;
  for (int k = 0; k < static_cast<int>(layout_->contacts.size()); ++k)
    if (view_.closed(k) || !view_.finite(k)) contacts.push_back(model_.links()[k].name);
  const std::string about = report.contact < 0 ? "" : model_.links()[report.contact].name;
  throw SimulationError(state_.t, step_ + 1, about, std::move(contacts), report);
}

}  // namespace saltus
