#pragma once
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "saltus/kernel/integrators/half_explicit/tableau.hpp"
#include "saltus/kernel/integrators/one_step_integrator.hpp"
#include "saltus/numerics/plugin.hpp"

namespace saltus {

/// What holds for a scheme, checked by the conformance tests of the registry.
struct SchemeProperties {
  bool friction = true;         ///< takes laws with friction
  bool velocity_level = true;   ///< holds Wᵀv of closed contacts; otherwise g̈, and g and Wᵀv drift
  bool implicit = false;        ///< in the forces: stable for stiff ones; impulses act over the whole step
  int order_free = 1;           ///< in q and v, free flight
  int order_bilateral = 1;      ///< under bilateral constraints
  int order_sliding = 1;        ///< in persistent sliding, also where its direction turns in space
  bool impact_law = true;       ///< restitution by the law in every phase of a step
  bool forces_at_rest = false;  ///< at rest λ = mg and Λ = 0; otherwise Λ = m g Δt
  /// Chooses steps of its own to meet a tolerance: errors follow its rtol and not Δt, orders are those of its
  /// own steps
  bool error_controlled = false;
};

using OptionValue = std::variant<double, std::string, Tableau>;
using Options = std::map<std::string, OptionValue>;

/// One option of a scheme: a number, or a word out of some, which can stand for a tableau.
struct SchemeOption {
  std::string name;
  OptionValue standard;              ///< what it is if it is not given; its type is the option's
  std::vector<std::string> choices;  ///< of a word
  std::string meaning;
  bool takes_tableau = false;  ///< instead of the word
};

/// One line of the table of integrators. Tests, Python and the command line iterate it.
struct IntegratorEntry {
  std::string name;
  std::string summary;
  std::vector<SchemeOption> options;
  SchemeProperties properties;
  std::function<std::unique_ptr<OneStepIntegrator>(const Options&)> make;  ///< every option is given
  /// Sets options that others imply, every option given, and refuses those that contradict each other.
  std::function<void(Options&)> imply = {};
  /// What holds with other options than the standard ones, every option given; empty: the same.
  std::function<SchemeProperties(const Options&)> properties_with = {};
};

const std::vector<IntegratorEntry>& integrators();

/// Adds a line to the table, for the rest of the program; not while another thread uses the table.
/// @throws std::invalid_argument if it has no name, a name with ':' or one that is taken
void register_integrator(IntegratorEntry entry);

/// Adds the line of a class that a shared library exports with SALTUS_INTEGRATOR.
/// @param library_and_class  "library:Class", see load_symbol()
/// @return the name in the table; loading a plugin again changes nothing
/// @throws std::invalid_argument as load_symbol() and register_integrator()
std::string load_integrator(const std::string& library_and_class);

/// @param name  in the table, or "library:Class" of a plugin, which is loaded then
/// @throws std::invalid_argument if there is no such integrator, option or choice, naming those there are
std::unique_ptr<OneStepIntegrator> make_integrator(std::string_view name, const Options& options = {});

/// All options with which make_integrator() makes it. @throws as make_integrator()
Options integrator_options(std::string_view name, const Options& options = {});

/// What holds for a scheme with these options. @throws as make_integrator()
SchemeProperties integrator_properties(std::string_view name, const Options& options = {});

}  // namespace saltus

/// In a plugin, exports an integrator as "library:Class". What follows the class is its line of the table,
/// without name and make, which come from the class: it needs a default constructor and its name().
#define SALTUS_INTEGRATOR(Class, ...)                                                             \
  static saltus::IntegratorEntry saltus_entry_of_##Class() {                                      \
    saltus::IntegratorEntry entry{__VA_ARGS__};                                                   \
    entry.name = Class().name();                                                                  \
    entry.make = [](const saltus::Options&) { return std::make_unique<Class>(); };                \
    return entry;                                                                                 \
  }                                                                                               \
  extern "C" __attribute__((visibility("default"))) const saltus::Plugin<saltus::IntegratorEntry> \
      saltus_integrator_##Class = {SALTUS_PLUGIN_ABI, saltus_entry_of_##Class}
