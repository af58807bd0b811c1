#pragma once
// Models and simulations as C++ programs written for Siconos drive them.
#include <memory>
#include <string>
#include <vector>

#include "saltus/kernel/integrators/one_step_integrator.hpp"
#include "saltus/kernel/simulation/time_stepping.hpp"
#include "saltus/siconos/kernel/interactions.hpp"

namespace saltus::siconos::kernel {

/// Systems and the interactions between them, from t0 to T [s].
class NonSmoothDynamicalSystem {
 public:
  struct Link {
    SP::Interaction interaction;
    SP::DynamicalSystem first, second;  ///< no second: the ground
  };

  NonSmoothDynamicalSystem(double t0, double T) : t0_(t0), T_(T) {}
  void insertDynamicalSystem(SP::DynamicalSystem ds) { systems_.push_back(ds); }
  /// @throws std::invalid_argument if a system is not inserted, or H has another size
  void link(SP::Interaction interaction, SP::DynamicalSystem first, SP::DynamicalSystem second = nullptr);
  double t0() const { return t0_; }
  double finalT() const { return T_; }
  std::size_t getNumberOfDS() const { return systems_.size(); }
  std::size_t getNumberOfInteractions() const { return links_.size(); }
  const std::vector<SP::DynamicalSystem>& systems() const { return systems_; }
  const std::vector<Link>& links() const { return links_; }

 private:
  double t0_, T_;
  std::vector<SP::DynamicalSystem> systems_;
  std::vector<Link> links_;
};

/// t_k = t0 + k h.
class TimeDiscretisation {
 public:
  TimeDiscretisation(double t0, double h) : t0_(t0), h_(h) {}
  double t0() const { return t0_; }
  double h() const { return h_; }

 private:
  double t0_, h_;
};

/// Any scheme of the registry.
class OneStepIntegrator {
 public:
  /// @param scheme  "Name" or "Name(option=value, ...)", docs/schemes
  /// @throws std::invalid_argument if there is no such scheme or option
  explicit OneStepIntegrator(const std::string& scheme);
  explicit OneStepIntegrator(std::unique_ptr<saltus::OneStepIntegrator> scheme)
      : scheme_(std::move(scheme)) {}
  const saltus::OneStepIntegrator& native() const { return *scheme_; }

 private:
  std::unique_ptr<saltus::OneStepIntegrator> scheme_;
};

class MoreauJeanOSI : public OneStepIntegrator {
 public:
  explicit MoreauJeanOSI(double theta = 0.5);
};

class HalfExplicitTrapezoidalOSI : public OneStepIntegrator {
 public:
  /// @param options  "activity=sticky, ..."
  explicit HalfExplicitTrapezoidalOSI(const std::string& options = "")
      : OneStepIntegrator("HalfExplicitTrapezoidalOSI(" + options + ")") {}
};

class D1MinusLinearOSI : public OneStepIntegrator {
 public:
  D1MinusLinearOSI() : OneStepIntegrator("DMinusAccelerationOSI") {}
};

/// The contact problems of a simulation, by whatever name: one solver takes them all.
class OneStepNSProblem {
 public:
  /// @param solver  name in the table of solvers
  explicit OneStepNSProblem(std::string solver = "auto") : solver_(std::move(solver)) {}
  const std::string& solver() const { return solver_; }

 private:
  std::string solver_;
};

using LCP = OneStepNSProblem;
using MLCP = OneStepNSProblem;
using Equality = OneStepNSProblem;
using GenericMechanical = OneStepNSProblem;

class FrictionContact : public OneStepNSProblem {
 public:
  /// The dimension is that of the laws. @throws std::invalid_argument unless it is 2 or 3
  explicit FrictionContact(int dim, std::string solver = "auto");
};

namespace SP {
using NonSmoothDynamicalSystem = std::shared_ptr<kernel::NonSmoothDynamicalSystem>;
using TimeDiscretisation = std::shared_ptr<kernel::TimeDiscretisation>;
using OneStepIntegrator = std::shared_ptr<kernel::OneStepIntegrator>;
using MoreauJeanOSI = std::shared_ptr<kernel::MoreauJeanOSI>;
using OneStepNSProblem = std::shared_ptr<kernel::OneStepNSProblem>;
using FrictionContact = std::shared_ptr<kernel::FrictionContact>;
}  // namespace SP

/// A simulation with steps of equal size, driven by the program.
class TimeStepping {
 public:
  /// @param osi, problem  may be inserted later; contact problems are solved by "auto" if there is none
  TimeStepping(SP::NonSmoothDynamicalSystem nsds, SP::TimeDiscretisation td,
               SP::OneStepIntegrator osi = nullptr, SP::OneStepNSProblem problem = nullptr)
      : nsds_(nsds), td_(td), osi_(osi), problem_(problem) {}
  void insertIntegrator(SP::OneStepIntegrator osi) { osi_ = osi; }
  void insertNonSmoothProblem(SP::OneStepNSProblem problem) { problem_ = problem; }

  /// Is there a whole step before T?
  bool hasNextEvent() const;
  /// Takes the step to nextTime(): all vectors are then of that time. The first one makes the model: what is
  /// changed later in it is not seen.
  /// @throws std::invalid_argument if there is no integrator or it cannot take the model; SimulationError if
  /// the step fails;
  ///         std::logic_error if nextStep() is missing
  void computeOneStep();
  void advanceToEvent() { computeOneStep(); }
  /// Accepts the step. @throws std::logic_error if there is none
  void nextStep();
  void processEvents() { nextStep(); }
  /// Iterations end at 1e-12 of the velocities, or the step fails.
  /// @throws std::invalid_argument if that is wider than the tolerance
  void setNewtonTolerance(double tolerance);
  /// All steps to T.
  void run();
  double startingTime() const { return nsds_->t0() + static_cast<double>(step_) * td_->h(); }
  double nextTime() const { return nsds_->t0() + static_cast<double>(step_ + 1) * td_->h(); }
  double timeStep() const { return td_->h(); }
  SP::NonSmoothDynamicalSystem nonSmoothDynamicalSystem() const { return nsds_; }

 private:
  void start();

  SP::NonSmoothDynamicalSystem nsds_;
  SP::TimeDiscretisation td_;
  SP::OneStepIntegrator osi_;
  SP::OneStepNSProblem problem_;
  std::unique_ptr<saltus::TimeStepping> simulation_;
  long step_ = 0;
  bool computed_ = false;
};

namespace SP {
using TimeStepping = std::shared_ptr<kernel::TimeStepping>;
}  // namespace SP

}  // namespace saltus::siconos::kernel
