// An integrator in a shared library, "./libown.so:TrapezoidalMoreau". The same scheme as in
// trapezoidal_moreau.py, where its formulas are.
#include <stdexcept>

#include "saltus/kernel/integrators/contact_stage.hpp"
#include "saltus/kernel/integrators/registry.hpp"

namespace {

using namespace saltus;

class TrapezoidalMoreau final : public OneStepIntegrator {
 public:
  std::string name() const override { return "TrapezoidalMoreau"; }
  std::unique_ptr<OneStepIntegrator> clone() const override { return std::make_unique<TrapezoidalMoreau>(); }

  void prepare(const NonSmoothDynamicalSystem& model, ContactSolver& solver) override {
    layout_ = std::make_shared<Layout>(model);
    if (layout_->mapped) throw std::invalid_argument(name() + " takes systems with q̇ = v only");
    places_.assign(2, Configuration(layout_));
    for (Configuration& place : places_) place.move_to(model.q0(), model.t0());
    contacts_ = std::make_unique<ContactStage>(layout_, solver);
    for (Vec* x : {&a_, &a1_, &v1_, &before_, &after_}) x->setZero(layout_->n);
    gamma_.setZero(layout_->rows);
  }

  StepReport step(double dt, State& state, Reactions& reactions) override {
    StepReport report;
    Configuration& start = places_[0];
    Configuration& end = places_[1];
    if (!start.is_at(state.q, state.t)) start.move_to(state.q, state.t);
    if (!accelerate(start, state.t, state.v, a_, report)) return report;
    v1_ = state.v + dt * a_;
    end.move_to(state.q + 0.5 * dt * (state.v + v1_), state.t + dt);
    if (!end.finite()) report.status = StepStatus::gap_not_finite;
    if (!end.finite() || !accelerate(end, state.t + dt, v1_, a1_, report)) return report;
    before_ = state.v + 0.5 * dt * (a_ + a1_);

    active_.assign(end.closed_contacts().begin(), end.closed_contacts().end());
    ContactAssembly& assembly = contacts_->assembly();
    assembly.assemble(active_, end, end, end);
    assembly.set_b(end, before_);
    assembly.scatter(assembly.problem().b, 1.0, gamma_);
    assembly.add_restitution(gamma_);
    assembly.gather(reactions.impulse, 1.0, contacts_->P());
    if (!contacts_->solve(report)) return report;
    after_ = before_;
    assembly.apply(1.0, contacts_->P().data(), after_);
    if (!after_.allFinite()) {
      report.status = StepStatus::not_finite;
      return report;
    }
    report.work_forces = end.kinetic_energy(before_) - start.kinetic_energy(state.v);
    report.work_impulse = assembly.work(contacts_->P(), end, gamma_);
    report.kinetic_energy = end.kinetic_energy(after_);
    report.penetration = end.penetration();
    report.closed = static_cast<int>(active_.size());
    state.t += dt;
    state.q = end.q();
    state.v = after_;
    reactions.set_zero(layout_->rows);
    assembly.scatter(contacts_->P(), 1.0, reactions.impulse);
    report.impulsive = reactions.impulse.any();
    std::swap(places_[0], places_[1]);
    return report;
  }

 private:
  bool accelerate(Configuration& at, double t, const Vec& v, Vec& a, StepReport& report) {
    if (!at.factorise()) {
      report.status = StepStatus::mass_not_positive_definite;
      return false;
    }
    evaluate_forces(*layout_, t, at.q(), v, a);
    at.solve_mass(a);
    return true;
  }

  std::shared_ptr<const Layout> layout_;
  std::vector<Configuration> places_;
  std::unique_ptr<ContactStage> contacts_;
  std::vector<int> active_;
  Vec a_, a1_, v1_, before_, after_, gamma_;
};

}  // namespace

SALTUS_INTEGRATOR(TrapezoidalMoreau, .summary = "Moreau-Jean around the explicit trapezoidal rule",
                  .properties = {.order_free = 2});
