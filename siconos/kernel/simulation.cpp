#include "saltus/siconos/kernel/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include "saltus/numerics/solvers/registry.hpp"
#include "saltus/numerics/text.hpp"
#include "saltus/siconos/scheme_name.hpp"

namespace saltus::siconos::kernel {
namespace {

// Keeps the vectors of a program what the simulation is
class LiveState final : public Observer {
 public:
  LiveState(const NonSmoothDynamicalSystem& nsds, double dt)
      : systems_(nsds.systems()), links_(nsds.links()), dt_(dt) {}

  void observe(const StepView& view) override {
    const Layout& layout = view.configuration.layout();
    for (std::size_t k = 0; k < systems_.size(); ++k) {
      const auto& slot = layout.systems[k];
      systems_[k]->q()->values() = view.state.q.segment(slot.first, slot.coordinates);
      systems_[k]->velocity()->values() = view.state.v.segment(slot.offset, slot.n);
      systems_[k]->p(1)->zero();
    }
    for (std::size_t k = 0; k < links_.size(); ++k) {
      const auto& slot = layout.contacts[k];
      const Interaction& interaction = *links_[k].interaction;
      interaction.y(0)->values() = view.gaps.segment(slot.gap, slot.gaps);
      interaction.y(1)->values() = view.velocities.segment(slot.row, slot.rows);
      Vec& impulse = interaction.lambda(1)->values();
      impulse = view.reactions.impulse.segment(slot.row, slot.rows) +
                dt_ * view.reactions.force.segment(slot.row, slot.rows);
      const InMatrix H(view.configuration.jacobian(static_cast<int>(k)), slot.rows, slot.n);
      Eigen::Index column = 0;
      for (int side = 0; side < slot.sides; ++side) {
        Vec& p = systems_[slot.system[side]]->p(1)->values();
        p.noalias() += H.middleCols(column, p.size()).transpose() * impulse;
        column += p.size();
      }
    }
  }

 private:
  std::vector<SP::DynamicalSystem> systems_;
  std::vector<NonSmoothDynamicalSystem::Link> links_;
  double dt_;
};

}  // namespace

void ioMatrix::write(const std::string& file, const std::string& mode, const SiconosMatrix& matrix,
                     const std::string& form) {
  if (mode != "ascii") throw std::invalid_argument("the mode must be 'ascii', got '" + mode + "'");
  std::ofstream out(file);
  const Eigen::IOFormat columns(17, Eigen::DontAlignCols, " ", "\n", "", "", "", "\n");
  if (form != "noDim") out << matrix.size(0) << ' ' << matrix.size(1) << '\n';
  out << matrix.values().format(columns);
  if (!out.flush()) throw std::invalid_argument("the file '" + file + "' cannot be written");
}

double ioMatrix::compareRefFile(const SiconosMatrix& matrix, const std::string& file, double) {
  std::ifstream in(file);
  double largest = -1.0, value = 0.0;
  for (unsigned i = 0; i < matrix.size(0); ++i)
    for (unsigned j = 0; j < matrix.size(1); ++j) {
      if (!(in >> value)) return -1.0;
      largest = std::max(largest, std::abs(value - matrix(i, j)));
    }
  return largest;
}

void NonSmoothDynamicalSystem::link(SP::Interaction interaction, SP::DynamicalSystem first,
                                    SP::DynamicalSystem second) {
  for (const auto& ds : {first, second})
    if (ds && std::find(systems_.begin(), systems_.end(), ds) == systems_.end())
      throw std::invalid_argument(
          "link() expects a system that is inserted, insertDynamicalSystem(), got another one");
  const unsigned freedoms = first->dimension() + (second ? second->dimension() : 0);
  interaction->relation()->resize(interaction->dimension(), freedoms);
  links_.push_back({interaction, first, second});
}

OneStepIntegrator::OneStepIntegrator(const std::string& scheme) : scheme_(make_scheme(scheme)) {}

MoreauJeanOSI::MoreauJeanOSI(double theta)
    : OneStepIntegrator(make_integrator("MoreauJeanOSI", {{"theta", theta}})) {}

FrictionContact::FrictionContact(int dim, std::string solver) : OneStepNSProblem(std::move(solver)) {
  if (dim != 2 && dim != 3)
    throw std::invalid_argument("the dimension of friction must be 2 or 3, got " + std::to_string(dim));
}

void TimeStepping::start() {
  if (!osi_) throw std::invalid_argument("expected an integrator, insertIntegrator(), got none");
  std::vector<std::shared_ptr<const saltus::LagrangianDS>> systems;
  for (const auto& ds : nsds_->systems()) systems.push_back(ds->native());
  saltus::NonSmoothDynamicalSystem model(systems, nsds_->t0());
  const auto native_of = [&](const SP::DynamicalSystem& ds) {
    const auto& all = nsds_->systems();
    return systems[std::find(all.begin(), all.end(), ds) - all.begin()].get();
  };
  for (const auto& [interaction, first, second] : nsds_->links())
    model.link(
        std::make_shared<saltus::Interaction>(interaction->relation()->native(interaction->dimension()),
                                              interaction->nonSmoothLaw()->native()),
        *native_of(first), second ? native_of(second) : nullptr);
  const auto solver = make_contact_solver(problem_ ? problem_->solver() : "auto");
  simulation_ = std::make_unique<saltus::TimeStepping>(model, osi_->native(), td_->h(), *solver);
  simulation_->add_observer(std::make_shared<LiveState>(*nsds_, td_->h()));
}

bool TimeStepping::hasNextEvent() const {
  const double rounding = std::min(1e-12 * std::abs(nsds_->finalT()), 1e-3 * td_->h());
  return nextTime() <= nsds_->finalT() + rounding;  // as saltus::TimeStepping::run()
}

void TimeStepping::computeOneStep() {
  if (computed_)
    throw std::logic_error("expected nextStep() after computeOneStep(), got computeOneStep() again");
  if (!simulation_) start();
  simulation_->step();
  computed_ = true;
}

void TimeStepping::nextStep() {
  if (!computed_) throw std::logic_error("expected computeOneStep() before nextStep(), got none");
  computed_ = false;
  ++step_;
}

void TimeStepping::setNewtonTolerance(double tolerance) {
  if (!(tolerance >= 1e-12))
    throw std::invalid_argument("Newton's iteration ends at 1e-12 of the velocities, got " +
                                number(tolerance));
}

void TimeStepping::run() {
  while (hasNextEvent()) {
    computeOneStep();
    nextStep();
  }
}

}  // namespace saltus::siconos::kernel
