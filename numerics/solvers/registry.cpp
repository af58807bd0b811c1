#include "saltus/numerics/solvers/registry.hpp"

#include "saltus/numerics/registry.hpp"
#include "saltus/numerics/solvers/automatic.hpp"
#include "saltus/numerics/solvers/globalised_newton.hpp"
#include "saltus/numerics/solvers/interior_point.hpp"
#include "saltus/numerics/solvers/lemke.hpp"
#include "saltus/numerics/solvers/prox_fixed_point.hpp"
#include "saltus/numerics/solvers/proximal_newton.hpp"
#include "saltus/numerics/solvers/psor.hpp"

namespace saltus {
namespace {

template <class Solver>
std::unique_ptr<ContactSolver> make() {
  return std::make_unique<Solver>();
}

Registry<SolverEntry>& table() {
  // Never destroyed: entries may belong to an interpreter that ends before this library does.
  static auto& registry = *new Registry<SolverEntry>(
      "contact solver", "saltus_contact_solver_",
      {
          {"auto", "semismooth Newton, with enumeration, Lemke and sweeps to fall back on", make<Automatic>},
          {"semismooth-newton", "Newton on the prox equations", make<SemismoothNewton>},
          {"subset-newton", "Newton on every subset of the contacts, up to ten", make<SubsetNewton>},
          {"enumeration", "every combination of modes, small plane problems", make<Enumeration>},
          {"lemke", "Lemke's method, plane friction as a linear complementarity problem", make<Lemke>},
          {"nsgs", "nonsmooth Gauss-Seidel sweeps, each contact solved exactly", make<Nsgs>},
          {"proximal-newton",
           "proximal point iterations, each solved by Newton's method with sparse equations",
           make<ProximalNewton>},
          {"interior-point", "primal-dual interior-point method with sparse equations", make<InteriorPoint>},
          {"prox-fixed-point", "projected sweeps, P <- prox(P - r xi), steps adapt to the residual",
           make<ProxFixedPoint>},
          {"pgs", "projected Gauss-Seidel, row by row", [] { return std::make_unique<Psor>(1.0); }},
          {"psor", "projected successive over-relaxation, row by row", make<Psor>},
          {"damped-newton", "Newton on the prox equations with a line search, sparse equations",
           [] { return std::make_unique<GlobalisedNewton>(GlobalisedNewton::Map::natural); }},
          {"fischer-burmeister", "Newton on p + xi - sqrt(p² + xi²) with a line search, no friction",
           [] { return std::make_unique<GlobalisedNewton>(GlobalisedNewton::Map::fischer_burmeister); }},
      });
  return registry;
}

}  // namespace

const std::vector<SolverEntry>& contact_solvers() { return table().entries(); }

void register_contact_solver(SolverEntry entry) { table().add(std::move(entry)); }

std::string load_contact_solver(const std::string& library_and_class) {
  return table().load(library_and_class);
}

std::unique_ptr<ContactSolver> make_contact_solver(std::string_view name) {
  return table().find(name).make();
}

}  // namespace saltus
