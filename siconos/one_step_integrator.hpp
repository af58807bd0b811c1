#pragma once
// Integrators of Saltus in simulations of Siconos. For C++11 and newer, and without Eigen: programs see
// Siconos's headers as they did before.
#include <OneStepIntegrator.hpp>
#include <memory>
#include <string>
#include <vector>

namespace saltus {
namespace siconos {

class Run;

/// What acts in an interaction during a step, (rows) each.
struct ContactForces {
  std::vector<double> lambda_plus;   ///< λ⁺ at its start [N]
  std::vector<double> lambda_minus;  ///< λ⁻ at its end [N]
  std::vector<double> force;         ///< their mean over the step, by the scheme's quadrature [N]
  std::vector<double> impulse;       ///< Λ at its end [N s]
};

/// A scheme of Saltus as the integrator of a ::TimeStepping:
///
///   SP::OneStepIntegrator osi(new saltus::siconos::OneStepIntegrator("MoreauJeanOSI(theta=1)"));
///   SP::TimeStepping simulation(new TimeStepping(nsds, td, osi, SP::OneStepNSProblem(new LCP())));
///
/// computeOneStep() takes one step of the scheme on the model as it is linked. Contact problems are solved
/// inside of it: the problem that the simulation was given, which may be none, is replaced by an empty one.
/// Afterwards q(), velocity(), y(0), y(1) are those of nextTime(), lambda(1) is the impulse of the whole
/// step, that of contact forces included [N s], and p(1) = Hᵀ lambda(1). A step that is taken again without
/// nextStep() starts where it started, from the memories of the systems.
///
/// What the model can be made of: LagrangianDS and what derives from it, M(q) v̇ = F(t, q, v) + Hᵀ λ;
/// LagrangianScleronomousR, LagrangianRheonomousR, LagrangianLinearTIR and what derives from these;
/// NewtonImpactNSL, NewtonImpactFrictionNSL, EqualityConditionNSL. Terms may be overrides or plugins, and
/// systems and interactions may come and go between two steps.
class OneStepIntegrator : public ::OneStepIntegrator {
 public:
  /// @param scheme   "Name" or "Name(option=value, ...)", docs/schemes, or "library:Class" of a plugin
  /// @param solver   of the contact problems, by name
  /// @throws std::invalid_argument if there is no such scheme, option or solver
  explicit OneStepIntegrator(const std::string& scheme, const std::string& solver = "auto");
  ~OneStepIntegrator() override;

  /// Of the last step. @throws std::invalid_argument if the interaction took no part in it
  ContactForces contact_forces(const ::Interaction& interaction) const;

  // What a simulation calls.
  unsigned int numberOfIndexSets() const override { return 2; }
  /// @throws std::invalid_argument if there is a second integrator
  void initialize() override;
  void initializeWorkVectorsForDS(double t, SP::DynamicalSystem ds) override;
  void initializeWorkVectorsForInteraction(::Interaction& interaction, InteractionProperties& properties,
                                           DynamicalSystemsGraph& graph) override;
  /// Takes the step.
  /// @throws std::invalid_argument if the scheme cannot take the model, naming what; std::runtime_error if
  ///         the step fails: systems and interactions are then what they were
  void computeFreeState() override;
  double computeResidu() override { return 0.0; }
  double computeResiduOutput(double, SP::InteractionsGraph) override { return 0.0; }
  double computeResiduInput(double, SP::InteractionsGraph) override { return 0.0; }
  void prepareNewtonIteration(double) override {}
  void updateState(const unsigned int) override {}
  /// @throws std::logic_error: the simulation must be a TimeStepping
  void integrate(double& start, double& end, double& out, int& flag) override;
  /// The interaction belongs to index set 1 where it is closed.
  bool addInteractionInIndexSet(SP::Interaction interaction, unsigned int level) override;
  bool removeInteractionFromIndexSet(SP::Interaction interaction, unsigned int level) override;
  void display() override;

 private:
  std::unique_ptr<Run> run_;
};

/// The half-explicit trapezoidal scheme (62)-(72), with friction, of second order between impacts.
class HalfExplicitTrapezoidal : public OneStepIntegrator {
 public:
  /// @param options  "activity=sticky, ...", those of HalfExplicitTrapezoidalOSI
  explicit HalfExplicitTrapezoidal(const std::string& options = "", const std::string& solver = "auto")
      : OneStepIntegrator("HalfExplicitTrapezoidalOSI(" + options + ")", solver) {}
};

}  // namespace siconos
}  // namespace saltus
