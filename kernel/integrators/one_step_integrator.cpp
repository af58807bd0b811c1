#include "saltus/kernel/integrators/one_step_integrator.hpp"

#include <stdexcept>

namespace saltus {

void Reactions::set_zero(int rows) {
  lambda_plus.setZero(rows);
  lambda_minus.setZero(rows);
  force.setZero(rows);
  impulse.setZero(rows);
}

void OneStepIntegrator::remember(std::span<const double> memory) {
  if (!memory.empty())
    throw std::invalid_argument(name() + " carries nothing from step to step, got a memory of " +
                                std::to_string(memory.size()) + " numbers");
}

std::string_view to_string(StepStatus status) {
  switch (status) {
    case StepStatus::ok: return "ok";
    case StepStatus::solver_failed:
      return "the contact solver found no impulses that satisfy the contact laws";
    case StepStatus::mass_not_positive_definite: return "the mass matrix is not positive definite";
    case StepStatus::iteration_failed: return "the iteration for the velocities does not converge";
    case StepStatus::gap_not_finite: return "a gap is not finite";
    case StepStatus::too_many_steps: return "the steps that meet the tolerance are too many";
    case StepStatus::accumulation:
      return "impacts follow each other within vanishing time, a larger velocity_tolerance lets them end";
    case StepStatus::not_finite: break;
  }
  return "the velocities are not finite";
}

}  // namespace saltus
