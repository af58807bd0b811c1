#pragma once
#include <memory>

#include "saltus/kernel/assembly/contact_assembly.hpp"
#include "saltus/kernel/integrators/one_step_integrator.hpp"

namespace saltus {

/// One contact problem of a step: assembly, solve and its entry in the step report.
/// The steps of all schemes are made of these.
class ContactStage {
 public:
  /// With M in the contact problems, one block a system.
  /// @throws std::invalid_argument if the solver does not accept the laws of all contacts
  ContactStage(std::shared_ptr<const Layout> layout, ContactSolver& solver);
  /// With a matrix in the place of M that has the blocks of the partition. @throws as above
  ContactStage(std::shared_ptr<const Layout> layout, std::shared_ptr<const Partition> partition,
               ContactSolver& solver);

  ContactAssembly& assembly() { return assembly_; }
  /// Impulses of the active contacts [N s]
  PoolVec& P() { return P_; }
  /// Solves the assembled problem for P, warm start in P.
  /// @return false if the status in the report is no longer ok
  bool solve(StepReport& report);
  /// The same of a problem made of the assembled one. @param P (rows) in: warm start; out: solution
  bool solve(const ContactProblem& problem, PoolVec& P, StepReport& report);

  /// Assembles the problem of an impact of these contacts. @param[out] gamma  γ⁻ (rows of all contacts) [m/s]
  void meet(const std::vector<int>& active, Configuration& at, const Vec& v, Vec& gamma);
  /// The impact law (56)-(59) of the contacts that have met, v <- v⁺ (68), and the work of the impulses.
  /// @param rebound  what is returned times ε (rows) [m/s]: γ⁻, or 0 of a contact that is to stay closed
  /// @param impulse  Λ (rows) [N s]; in: warm start
  /// @return false if the status in the report is no longer ok
  bool strike(Configuration& at, const Vec& gamma, const Vec& rebound, Vec& v, Vec& impulse,
              StepReport& report);

 private:
  ContactAssembly assembly_;
  ContactSolver* solver_;
  PoolVec P_;
};

}  // namespace saltus
