#include "saltus/kernel/integrators/registry.hpp"

#include <algorithm>
#include <stdexcept>

#include "saltus/kernel/integrators/half_explicit/half_explicit.hpp"
#include "saltus/kernel/integrators/moreau_jean/explicit_moreau_jean.hpp"
#include "saltus/kernel/integrators/moreau_jean/moreau_jean.hpp"
#include "saltus/numerics/registry.hpp"

namespace saltus {
namespace {

std::unique_ptr<OneStepIntegrator> make_trapezoidal(const Options& options) {
  const bool predicted = std::get<std::string>(options.at("activity")) == "predicted";
  return std::make_unique<HalfExplicit>("HalfExplicitTrapezoidalOSI", trapezoidal_tableau(), Level::velocity,
                                        predicted ? Activity::predicted : Activity::start);
}

std::unique_ptr<OneStepIntegrator> make_acceleration(const Options&) {
  return std::make_unique<HalfExplicit>("DMinusAccelerationOSI", trapezoidal_tableau(), Level::acceleration,
                                        Activity::start);
}

const SchemeOption activity_option = {
    "activity",
    "start",
    {"start", "predicted"},
    "contacts that carry λ⁺: closed at the start of the step (69), or at the predicted position (77), "
    "which corrupts impacts"};

const SchemeOption theta_option = {
    "theta", 0.5, {}, "weight of the end of the step in forces and positions, in [0, 1]"};

std::string join(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : ", ") + word;
  return all.empty() ? "none" : all;
}

// A value of the option's type: a word among its choices, or a number.
OptionValue checked(const std::string& scheme, const SchemeOption& option, const OptionValue& value) {
  if (value.index() != option.standard.index())
    throw std::invalid_argument(scheme + ": " + option.name +
                                (option.choices.empty()
                                     ? " must be a number, got a word"
                                     : " must be one of " + join(option.choices) + ", got a number"));
  const auto* word = std::get_if<std::string>(&value);
  if (word && std::find(option.choices.begin(), option.choices.end(), *word) == option.choices.end())
    throw std::invalid_argument(scheme + ": " + option.name + " must be one of " + join(option.choices) +
                                ", got '" + *word + "'");
  return value;
}

Options complete(const IntegratorEntry& entry, const Options& given) {
  Options all;
  std::vector<std::string> known;
  for (const SchemeOption& option : entry.options) {
    known.push_back(option.name);
    all[option.name] = option.standard;
  }
  for (const auto& [name, value] : given) {
    const auto option = std::find_if(entry.options.begin(), entry.options.end(),
                                     [&, &key = name](const SchemeOption& o) { return o.name == key; });
    if (option == entry.options.end())
      throw std::invalid_argument(entry.name + " has no option '" + name + "', its options: " + join(known));
    all[name] = checked(entry.name, *option, value);
  }
  return all;
}

Registry<IntegratorEntry>& table() {
  // Never destroyed: entries may belong to an interpreter that ends before this library does.
  static auto& registry = *new Registry<IntegratorEntry>(
      "integrator", "saltus_integrator_",
      {
          {.name = "ExplicitMoreauJeanOSI",
           .summary = "classic explicit Moreau-Jean scheme (29)-(33), every contact force an impulse",
           .options = {},
           .properties = {},
           .make = [](const Options&) { return std::make_unique<ExplicitMoreauJean>(); }},
          {.name = "DMinusAccelerationOSI",
           .summary =
               "forecasting trapezoidal rule on acceleration level (43)-(60), without friction; drifts",
           .options = {},
           .properties = {.friction = false,
                          .velocity_level = false,
                          .order_free = 2,
                          .order_bilateral = 2,
                          .forces_at_rest = true},
           .make = make_acceleration},
          {.name = "MoreauJeanOSI",
           .summary = "Moreau-Jean scheme with the theta rule: implicit, every contact force an impulse",
           .options = {theta_option},
           .properties = {.implicit = true, .order_free = 2},
           .make =
               [](const Options& options) {
                 return std::make_unique<MoreauJean>(std::get<double>(options.at("theta")));
               }},
          {.name = "HalfExplicitTrapezoidalOSI",
           .summary =
               "forecasting trapezoidal rule on velocity level (62)-(72), forces and impulses told apart",
           .options = {activity_option},
           .properties = {.order_free = 2, .order_bilateral = 2, .order_sliding = 2, .forces_at_rest = true},
           .make = make_trapezoidal},
      });
  return registry;
}

}  // namespace

const std::vector<IntegratorEntry>& integrators() { return table().entries(); }

void register_integrator(IntegratorEntry entry) { table().add(std::move(entry)); }

std::string load_integrator(const std::string& library_and_class) { return table().load(library_and_class); }

std::unique_ptr<OneStepIntegrator> make_integrator(std::string_view name, const Options& options) {
  const IntegratorEntry& entry = table().find(name);
  return entry.make(complete(entry, options));
}

}  // namespace saltus
