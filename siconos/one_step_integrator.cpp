#include "saltus/siconos/one_step_integrator.hpp"

#include <SiconosKernel.hpp>
#include <cmath>
#include <iostream>
#include <stdexcept>

#include "saltus/siconos/run.hpp"

namespace saltus {
namespace siconos {
namespace {

// What a simulation asks for where the integrator has solved the contact problems itself.
class NothingToSolve final : public ::OneStepNSProblem {
 public:
  void initialize(SP::Simulation) override {}
  void computeInteractionBlock(const InteractionsGraph::EDescriptor&) override {}
  void computeDiagonalInteractionBlock(const InteractionsGraph::VDescriptor&) override {}
  bool preCompute(double) override { return false; }
  int compute(double) override { return 0; }
  void postCompute() override {}
};

// That of the discretisation: the difference of two times has their rounding.
double time_step(const Simulation& simulation) {
  const double between_events = simulation.timeStep();
  const double dt = simulation.currentTimeStep();
  return std::abs(dt - between_events) < 1e-9 * dt ? dt : between_events;
}

}  // namespace

// Of the ids that there are, that of the nearest kind: problems ask for it, and they are empty.
OneStepIntegrator::OneStepIntegrator(const std::string& scheme, const std::string& solver)
    : ::OneStepIntegrator(OSI::D1MINUSLINEAROSI), run_(std::make_unique<Run>(scheme, solver)) {
  _levelMinForOutput = 0;
  _levelMaxForOutput = 1;
  _levelMinForInput = 1;
  _levelMaxForInput = 1;
  _steps = 1;
}

OneStepIntegrator::~OneStepIntegrator() = default;

void OneStepIntegrator::initialize() {
  if (_simulation->numberOfOSI() != 1)
    throw std::invalid_argument("a simulation must have an integrator of Saltus alone, got " +
                                std::to_string(_simulation->numberOfOSI()) + " integrators");
  for (auto& problem : *_simulation->oneStepNSProblems()) problem = std::make_shared<NothingToSolve>();
  ::OneStepIntegrator::initialize();
}

void OneStepIntegrator::initializeWorkVectorsForDS(double t, SP::DynamicalSystem ds) {
  _initializeDSWorkVectors(ds);
  if (const auto lagrangian = std::dynamic_pointer_cast<LagrangianDS>(ds)) {
    lagrangian->computeForces(t, lagrangian->q(), lagrangian->velocity());
    lagrangian->swapInMemory();
  }
  run_->forget_model();
}

void OneStepIntegrator::initializeWorkVectorsForInteraction(Interaction& interaction, InteractionProperties&,
                                                            DynamicalSystemsGraph&) {
  _check_and_update_interaction_levels(interaction);
  interaction.initializeMemory(_steps);
  run_->forget_model();
}

void OneStepIntegrator::computeFreeState() {
  NonSmoothDynamicalSystem& nsds = *_simulation->nonSmoothDynamicalSystem();
  const double end = _simulation->nextTime();
  const std::string failure = run_->step(nsds, _simulation->startingTime(), end, time_step(*_simulation));
  updateInput(end);
  updateOutput(end);
  if (!failure.empty()) throw std::runtime_error(failure);
}

ContactForces OneStepIntegrator::contact_forces(const Interaction& interaction) const {
  return run_->contact_forces(interaction);
}

void OneStepIntegrator::integrate(double&, double&, double&, int&) {
  throw std::logic_error("the simulation of an integrator of Saltus must be a TimeStepping, got another one");
}

bool OneStepIntegrator::addInteractionInIndexSet(SP::Interaction interaction, unsigned int) {
  return interaction->y(0)->getValue(0) <= 0.0;
}

bool OneStepIntegrator::removeInteractionFromIndexSet(SP::Interaction interaction, unsigned int level) {
  return !addInteractionInIndexSet(interaction, level);
}

void OneStepIntegrator::display() { std::cout << "integrator of Saltus: " << run_->name() << '\n'; }

}  // namespace siconos
}  // namespace saltus
