#pragma once
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "saltus/numerics/contact_solver.hpp"
#include "saltus/numerics/plugin.hpp"

namespace saltus {

/// One line of the table of contact solvers. Tests, Python and the command line iterate it.
struct SolverEntry {
  std::string name;
  std::string summary;
  std::function<std::unique_ptr<ContactSolver>()> make;
};

const std::vector<SolverEntry>& contact_solvers();

/// Adds a line to the table, for the rest of the program; not while another thread uses the table.
/// @throws std::invalid_argument if it has no name, a name with ':' or one that is taken
void register_contact_solver(SolverEntry entry);

/// Adds the line of a class that a shared library exports with SALTUS_CONTACT_SOLVER.
/// @param library_and_class  "library:Class", see load_symbol()
/// @return the name in the table; loading a plugin again changes nothing
/// @throws std::invalid_argument as load_symbol() and register_contact_solver()
std::string load_contact_solver(const std::string& library_and_class);

/// @param name  in the table, or "library:Class" of a plugin, which is loaded then
/// @throws std::invalid_argument if there is no such solver, naming those that there are
std::unique_ptr<ContactSolver> make_contact_solver(std::string_view name);

}  // namespace saltus

/// In a plugin, exports a solver as "library:Class". The class needs a default constructor and its name().
#define SALTUS_CONTACT_SOLVER(Class, summary)                                                 \
  static saltus::SolverEntry saltus_entry_of_##Class() {                                      \
    return {std::string(Class().name()), summary, [] { return std::make_unique<Class>(); }};  \
  }                                                                                           \
  extern "C" __attribute__((visibility("default"))) const saltus::Plugin<saltus::SolverEntry> \
      saltus_contact_solver_##Class = {SALTUS_PLUGIN_ABI, saltus_entry_of_##Class}
