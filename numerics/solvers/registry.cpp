#include "saltus/numerics/solvers/registry.hpp"

#include <stdexcept>

#include "saltus/numerics/solvers/automatic.hpp"
#include "saltus/numerics/solvers/lemke.hpp"
#include "saltus/numerics/solvers/prox_fixed_point.hpp"

namespace saltus {
namespace {

template <class Solver>
std::unique_ptr<ContactSolver> make() {
  return std::make_unique<Solver>();
}

}  // namespace

const std::vector<SolverEntry>& contact_solvers() {
  static const std::vector<SolverEntry> table = {
      {"auto", "semismooth Newton, with enumeration, Lemke and sweeps to fall back on", make<Automatic>},
      {"semismooth-newton", "Newton on the prox equations", make<SemismoothNewton>},
      {"subset-newton", "Newton on every subset of the contacts, up to ten", make<SubsetNewton>},
      {"enumeration", "every combination of modes, small plane problems", make<Enumeration>},
      {"lemke", "Lemke's method, plane friction as a linear complementarity problem", make<Lemke>},
      {"nsgs", "nonsmooth Gauss-Seidel sweeps, each contact solved exactly", make<Nsgs>},
      {"prox-fixed-point", "projected sweeps, P <- prox(P - r xi), steps adapt to the residual",
       make<ProxFixedPoint>},
  };
  return table;
}

std::unique_ptr<ContactSolver> make_contact_solver(std::string_view name) {
  std::string known;
  for (const SolverEntry& entry : contact_solvers()) {
    if (entry.name == name) return entry.make();
    known += (known.empty() ? "" : ", ") + entry.name;
  }
  throw std::invalid_argument("no contact solver named '" + std::string(name) + "', there are " + known);
}

}  // namespace saltus
