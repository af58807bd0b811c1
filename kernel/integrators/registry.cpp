#include "saltus/kernel/integrators/registry.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "saltus/kernel/integrators/adaptive/adaptive_half_explicit.hpp"
#include "saltus/kernel/integrators/d_minus/d_minus_galerkin.hpp"
#include "saltus/kernel/integrators/event_driven/event_driven.hpp"
#include "saltus/kernel/integrators/half_explicit/half_explicit.hpp"
#include "saltus/kernel/integrators/half_explicit/order_conditions.hpp"
#include "saltus/kernel/integrators/impact_refinement.hpp"
#include "saltus/kernel/integrators/moreau_jean/explicit_moreau_jean.hpp"
#include "saltus/kernel/integrators/moreau_jean/moreau_jean.hpp"
#include "saltus/numerics/registry.hpp"
#include "saltus/numerics/text.hpp"

namespace saltus {
namespace {

constexpr const char* trapezoidal_name = "HalfExplicitTrapezoidalOSI";
constexpr const char* runge_kutta_name = "HalfExplicitRungeKuttaOSI";
constexpr const char* galerkin_name = "DMinusGalerkinOSI";
constexpr double most_substeps = 1e6;

const std::string& word(const Options& options, const char* name) {
  return std::get<std::string>(options.at(name));
}

// ---- Half-explicit schemes on velocity level

const SchemeOption activity_option = {
    "activity",
    "start",
    {"start", "sticky", "predicted"},
    "contacts that carry λ: closed at the start of the step (69); those and the ones held, so that a drift "
    "costs no force; or closed at the predicted position (77), (B.11), which corrupts impacts"};

const SchemeOption stabilization_option = {
    "stabilization",
    "none",
    {"none", "position"},
    "position: pulls drifted positions back to the constraints after every step without impact; the activity "
    "is sticky then"};

const SchemeOption impact_option = {
    "impact",
    "paper",
    {"paper", "keep-resting-forces"},
    "velocity before an impact: without any λ (55), or with λ of the contacts that were closed before, which "
    "then stay at rest"};

const SchemeOption substeps_option = {
    "impulsive_substeps",
    1.0,
    {},
    "parts in which a step with an impact is taken again; 10 is the paper's choice of Section 6.2"};

const std::vector<SchemeOption> velocity_level_options = {activity_option, stabilization_option,
                                                          impact_option, substeps_option};

void imply_on_velocity_level(Options& options) {
  const bool stabilized = word(options, "stabilization") == "position";
  if (word(options, "activity") == "predicted") {
    if (stabilized)
      throw std::invalid_argument("stabilization = position takes the activity sticky, got predicted");
    if (word(options, "impact") == "keep-resting-forces")
      throw std::invalid_argument(
          "impact = keep-resting-forces takes no activity predicted, which gives forces to open contacts");
  }
  if (stabilized) options["activity"] = "sticky";
}

HalfExplicitSettings velocity_level_settings(const Options& options) {
  HalfExplicitSettings settings;
  const std::string& activity = word(options, "activity");
  if (activity == "predicted") settings.activity = Activity::predicted;
  if (activity == "sticky") settings.activity = Activity::sticky;
  if (word(options, "impact") == "keep-resting-forces") settings.impact = ImpactRule::keep_resting_forces;
  settings.stabilized = word(options, "stabilization") == "position";
  return settings;
}

std::unique_ptr<OneStepIntegrator> make_on_velocity_level(const std::string& scheme, const Tableau& tableau,
                                                          const Options& options) {
  auto integrator = std::make_unique<HalfExplicit>(scheme, tableau, velocity_level_settings(options));
  const double parts = std::get<double>(options.at("impulsive_substeps"));
  if (!(parts >= 1.0 && parts <= most_substeps) || parts != std::floor(parts))
    throw std::invalid_argument(scheme + ": impulsive_substeps must be a whole number from 1 to " +
                                number(most_substeps) + ", got " + number(parts));
  if (parts == 1.0) return integrator;
  return std::make_unique<ImpactRefinement>(std::move(integrator), static_cast<int>(parts));
}

SchemeProperties velocity_level_properties(TableauOrder order, const Options& options) {
  return {.order_free = order.free,
          .order_bilateral = order.constrained,
          .order_sliding = order.constrained,
          .impact_law = word(options, "activity") != "predicted",
          .forces_at_rest = true};
}

constexpr Tableau (*tableaux[])() = {heun_tableau, third_order_tableau, kutta3_tableau, rk4_tableau,
                                     hem5_tableau};

SchemeOption tableau_option() {
  SchemeOption option{"tableau", "third-order", {}, "coefficients a, b, c of (B.9)-(B.16)", true};
  for (const auto make : tableaux) option.choices.push_back(make().name);
  return option;
}

Tableau tableau_of(const Options& options) {
  const OptionValue& value = options.at("tableau");
  if (const auto* own = std::get_if<Tableau>(&value)) return *own;
  const auto* const make = std::find_if(std::begin(tableaux), std::end(tableaux), [&](const auto candidate) {
    return candidate().name == std::get<std::string>(value);
  });
  return (*make)();  // the word is one of the choices
}

std::vector<SchemeOption> runge_kutta_options() {
  std::vector<SchemeOption> all = velocity_level_options;
  all.insert(all.begin(), tableau_option());
  return all;
}

// ---- D⁻ Galerkin schemes

const std::vector<SchemeOption> galerkin_options = {
    {"stages", 2.0, {}, "the paper's s, 1, 2 or 3: stages of a step less one"},
    {"points",
     "lobatto",
     {"lobatto", "chebyshev"},
     "where the stages lie; with one or two both are the same"},
    {"activity",
     "start",
     {"start", "sticky"},
     "contacts that carry λ: closed at the start of the step; or those and the ones held, so that a drift "
     "costs no force"}};

int galerkin_stages(const Options& options) {
  const double stages = std::get<double>(options.at("stages"));
  if (!(stages >= 1.0 && stages <= 3.0) || stages != std::floor(stages))
    throw std::invalid_argument(std::string(galerkin_name) + ": stages must be 1, 2 or 3, got " +
                                number(stages));
  return static_cast<int>(stages);
}

SchemeProperties galerkin_properties(const Options& options) {
  const int stages = galerkin_stages(options);
  const int order = stages == 3 && word(options, "points") == "chebyshev" ? 4 : 2 * stages;
  return {.order_free = order, .order_bilateral = order, .order_sliding = order, .forces_at_rest = true};
}

std::unique_ptr<OneStepIntegrator> make_galerkin(const Options& options) {
  return std::make_unique<DMinusGalerkin>(
      galerkin_stages(options),
      word(options, "points") == "chebyshev" ? StagePoints::chebyshev : StagePoints::lobatto,
      word(options, "activity") == "sticky" ? Activity::sticky : Activity::start);
}

// ---- The others

std::unique_ptr<OneStepIntegrator> make_acceleration(const Options&) {
  return std::make_unique<HalfExplicit>("DMinusAccelerationOSI", trapezoidal_tableau(),
                                        HalfExplicitSettings{.level = Level::acceleration});
}

const SchemeOption theta_option = {
    "theta", 0.5, {}, "weight of the end of the step in forces and positions, in [0, 1]"};

const SchemeOption gamma_option = {
    "gamma",
    0.5,
    {},
    "contacts that this part of the step would close, at the velocity of its start, are active; in [0, 1]"};

std::vector<SchemeOption> error_control_options() {
  const ErrorControl standard;
  return {
      {"rtol", standard.rtol, {}, "relative tolerance of positions and velocities in an inner step"},
      {"atol", standard.atol, {}, "absolute tolerance, in the unit of each"},
      {"method",
       "third-order",
       {"third-order", "trapezoidal"},
       "the third-order tableau with the trapezoidal rule on its stages to compare with, or the trapezoidal "
       "scheme in one step and in two halves, extrapolated"},
      {"minimum_step",
       standard.minimum_step,
       {},
       "inner steps are not made smaller [s]; bounces that follow each other within it end. 0: a millionth "
       "of "
       "the step of the simulation"},
      {"velocity_tolerance",
       standard.velocity_tolerance,
       {},
       "contacts that meet with less are closed plastically [m/s]"},
  };
}

std::unique_ptr<OneStepIntegrator> make_adaptive(const Options& options) {
  const auto number_of = [&](const char* name) { return std::get<double>(options.at(name)); };
  return std::make_unique<AdaptiveHalfExplicit>(
      word(options, "method") == "trapezoidal" ? trapezoidal_trial : third_order_trial,
      ErrorControl{{number_of("rtol"), number_of("atol")},
                   number_of("minimum_step"),
                   number_of("velocity_tolerance")});
}

const std::vector<SchemeOption> event_driven_options = {
    {"rtol", 1e-10, {}, "relative error of the motion between two events, in [1e-13, 1e-3]"},
    {"velocity_tolerance",
     0.0,
     {},
     "[m/s] a contact that closes more slowly is stopped without restitution; 0 refuses bounces that "
     "accumulate"}};

std::string join(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : ", ") + word;
  return all.empty() ? "none" : all;
}

// A value of the option's type: a word among its choices, a number, or a tableau.
OptionValue checked(const std::string& scheme, const SchemeOption& option, const OptionValue& value) {
  if (option.takes_tableau && std::holds_alternative<Tableau>(value)) return value;
  const auto* word = std::get_if<std::string>(&value);
  const bool in_choices =
      word && std::find(option.choices.begin(), option.choices.end(), *word) != option.choices.end();
  if (value.index() == option.standard.index() && (!word || in_choices)) return value;
  const char* kinds[] = {"a number", "a word", "a tableau"};
  std::string expected = option.choices.empty() ? "a number" : "one of " + join(option.choices);
  if (option.takes_tableau) expected += ", or a Tableau";
  throw std::invalid_argument(scheme + ": " + option.name + " must be " + expected + ", got " +
                              (word && !option.choices.empty() ? "'" + *word + "'" : kinds[value.index()]));
}

// Every option, also those that are implied.
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
  if (entry.imply) try {
      entry.imply(all);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(entry.name + ": " + error.what());
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
           .options = {theta_option, gamma_option},
           .properties = {.implicit = true, .order_free = 2},
           .make =
               [](const Options& options) {
                 return std::make_unique<MoreauJean>(std::get<double>(options.at("theta")),
                                                     std::get<double>(options.at("gamma")));
               },
           .properties_with =
               [](const Options& options) {
                 const bool trapezoidal = std::get<double>(options.at("theta")) == 0.5;
                 return SchemeProperties{.implicit = true, .order_free = trapezoidal ? 2 : 1};
               }},
          {.name = trapezoidal_name,
           .summary =
               "forecasting trapezoidal rule on velocity level (62)-(72), forces and impulses told apart",
           .options = velocity_level_options,
           .properties = {.order_free = 2, .order_bilateral = 2, .order_sliding = 2, .forces_at_rest = true},
           .make =
               [](const Options& options) {
                 return make_on_velocity_level(trapezoidal_name, trapezoidal_tableau(), options);
               },
           .imply = imply_on_velocity_level,
           .properties_with =
               [](const Options& options) { return velocity_level_properties({2, 2}, options); }},
          {.name = "AdaptiveHalfExplicitOSI",
           .summary =
               "half-explicit scheme that chooses its steps to meet a tolerance, through impacts as well",
           .options = error_control_options(),
           .properties = {.order_free = 3,
                          .order_bilateral = 3,
                          .order_sliding = 3,
                          .forces_at_rest = true,
                          .error_controlled = true},
           .make = make_adaptive},
          {.name = runge_kutta_name,
           .summary = "explicit Runge-Kutta schemes of order 2 to 5 on velocity level (B.9)-(B.16), forces "
                      "and impulses told apart",
           .options = runge_kutta_options(),
           .properties = {.order_free = 3, .order_bilateral = 3, .order_sliding = 3, .forces_at_rest = true},
           .make =
               [](const Options& options) {
                 return make_on_velocity_level(runge_kutta_name, tableau_of(options), options);
               },
           .imply = imply_on_velocity_level,
           .properties_with =
               [](const Options& options) {
                 return velocity_level_properties(order_of(tableau_of(options)), options);
               }},
          {.name = galerkin_name,
           .summary = "time-discontinuous Galerkin schemes (B.1)-(B.8) of order 2, 4 and 6: all stages of a "
                      "step together, forces and impulses told apart",
           .options = galerkin_options,
           .properties = {.order_free = 4, .order_bilateral = 4, .order_sliding = 4, .forces_at_rest = true},
           .make = make_galerkin,
           .properties_with = galerkin_properties},
          {.name = "EventDrivenOSI",
           .summary = "reference: the motion between events to a tolerance, events located in time",
           .options = event_driven_options,
           .properties = {.order_free = 6,
                          .order_bilateral = 6,
                          .order_sliding = 6,
                          .forces_at_rest = true,
                          .error_controlled = true},
           .make =
               [](const Options& options) {
                 return std::make_unique<EventDriven>(std::get<double>(options.at("rtol")),
                                                      std::get<double>(options.at("velocity_tolerance")));
               }},
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

Options integrator_options(std::string_view name, const Options& options) {
  return complete(table().find(name), options);
}

SchemeProperties integrator_properties(std::string_view name, const Options& options) {
  const IntegratorEntry& entry = table().find(name);
  const Options all = complete(entry, options);
  return entry.properties_with ? entry.properties_with(all) : entry.properties;
}

}  // namespace saltus
