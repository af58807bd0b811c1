#pragma once
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "saltus/numerics/contact_solver.hpp"

namespace saltus {

/// One line of the table of contact solvers. Tests, Python and the command line iterate it.
struct SolverEntry {
  std::string name;
  std::string summary;
  std::unique_ptr<ContactSolver> (*make)();
};

const std::vector<SolverEntry>& contact_solvers();

/// @throws std::invalid_argument if there is no such solver, naming those that there are
std::unique_ptr<ContactSolver> make_contact_solver(std::string_view name);

}  // namespace saltus
