#pragma once
// The steps of a scheme, in terms that C++ of Siconos's headers can read.
#include <memory>
#include <string>

#include "saltus/siconos/one_step_integrator.hpp"

namespace saltus {
namespace siconos {

/// A scheme on the model of a simulation, and what it carries from step to step.
class Run {
 public:
  /// As OneStepIntegrator()
  Run(const std::string& scheme, const std::string& solver);
  ~Run();

  /// Adopts the model again before the next step: it has new parts.
  void forget_model();
  /// Takes the step of dt from the memories of the systems, which are of t, to `end` [s]. Written are q and
  /// velocity of the systems, and lambda(1); if the step fails, what they were.
  /// @return what went wrong, empty if nothing did
  /// @throws std::invalid_argument if the scheme cannot take the model, naming what
  std::string step(::NonSmoothDynamicalSystem& nsds, double t, double end, double dt);
  ContactForces contact_forces(const ::Interaction& interaction) const;
  std::string name() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace siconos
}  // namespace saltus
