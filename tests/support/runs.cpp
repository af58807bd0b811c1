#include "support/runs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <stdexcept>

namespace saltus::test {

std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << "not a std::invalid_argument: " << error.what();
    return "";
  }
  ADD_FAILURE() << "nothing was refused";
  return "";
}

void expect_refusal(const std::function<void()>& call, const std::vector<std::string>& words) {
  const std::string message = refusal(call);
  for (const std::string& word : words)
    EXPECT_NE(message.find(word), std::string::npos) << "no '" << word << "' in: " << message;
}

State run_to(const NonSmoothDynamicalSystem& model, const OneStepIntegrator& scheme, double dt,
             double until) {
  TimeStepping simulation(model, scheme, dt);
  simulation.run(until);
  return simulation.state();
}

std::vector<Row> rows_of_run(const NonSmoothDynamicalSystem& model, const OneStepIntegrator& scheme,
                             double dt, double until) {
  TimeStepping simulation(model, scheme, dt);
  std::vector<Row> rows{{simulation.state(), simulation.reactions(), simulation.report()}};
  const long steps = std::lround((until - model.t0()) / dt);
  for (long k = 0; k < steps; ++k) {
    simulation.step();
    rows.push_back({simulation.state(), simulation.reactions(), simulation.report()});
  }
  return rows;
}

double slope(const std::vector<double>& dt, const std::vector<double>& error) {
  double x_mean = 0.0, y_mean = 0.0;
  for (std::size_t k = 0; k < dt.size(); ++k) {
    x_mean += std::log(dt[k]) / dt.size();
    y_mean += std::log(error[k]) / dt.size();
  }
  double xy = 0.0, xx = 0.0;
  for (std::size_t k = 0; k < dt.size(); ++k) {
    xy += (std::log(dt[k]) - x_mean) * (std::log(error[k]) - y_mean);
    xx += (std::log(dt[k]) - x_mean) * (std::log(dt[k]) - x_mean);
  }
  return xy / xx;
}

Orders measure_orders(const NonSmoothDynamicalSystem& model, const OneStepIntegrator& scheme,
                      const State& exact, double until, const std::vector<double>& dt) {
  std::vector<double> error_q, error_v;
  for (double h : dt) {
    const State end = run_to(model, scheme, h, until);
    EXPECT_NEAR(end.t, until, 1e-9);
    error_q.push_back((end.q - exact.q).norm());
    error_v.push_back((end.v - exact.v).norm());
  }
  return {slope(dt, error_q), slope(dt, error_v)};
}

Vec integrate_ode(const std::function<Vec(double, const Vec&)>& f, Vec y, double until, int steps) {
  const double h = until / steps;
  for (int k = 0; k < steps; ++k) {
    const double t = k * h;
    const Vec k1 = f(t, y);
    const Vec k2 = f(t + h / 2, y + h / 2 * k1);
    const Vec k3 = f(t + h / 2, y + h / 2 * k2);
    const Vec k4 = f(t + h, y + h * k3);
    y += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  return y;
}

bool same_bits(const Vec& a, const Vec& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), sizeof(double) * a.size()) == 0;
}

namespace {

struct Variant {
  const char* name;
  const char* scheme;
  Options options;
  bool too_accurate = false;  // for the steps with which orders of all schemes are measured
};

const std::vector<Variant>& variants() {
  static const std::vector<Variant> table = {
      {"TrapezoidalStabilised", "HalfExplicitTrapezoidalOSI", {{"stabilization", "position"}}},
      {"TrapezoidalInTenParts",
       "HalfExplicitTrapezoidalOSI",
       {{"impulsive_substeps", 10.0}, {"impact", "keep-resting-forces"}}},
      {"KuttaSticky", "HalfExplicitRungeKuttaOSI", {{"tableau", "Kutta3"}, {"activity", "sticky"}}},
      {"Hem5Sticky", "HalfExplicitRungeKuttaOSI", {{"tableau", "HEM5"}, {"activity", "sticky"}}, true},
      {"Galerkin1", "DMinusGalerkinOSI", {{"stages", 1.0}}},
      {"Galerkin3Sticky", "DMinusGalerkinOSI", {{"stages", 3.0}, {"activity", "sticky"}}, true},
      {"GalerkinChebyshev", "DMinusGalerkinOSI", {{"stages", 3.0}, {"points", "chebyshev"}}},
      {"ThirdOrderStabilised",
       "HalfExplicitRungeKuttaOSI",
       {{"stabilization", "position"}, {"impact", "keep-resting-forces"}}},
      {"AdaptiveTrapezoidal", "AdaptiveHalfExplicitOSI", {{"method", "trapezoidal"}}},
  };
  return table;
}

std::vector<std::string> schemes_with(const std::function<bool(const SchemeProperties&)>& wanted) {
  std::vector<std::string> names;
  for (const IntegratorEntry& entry : integrators()) names.push_back(entry.name);
  for (const Variant& variant : variants())
    if (!variant.too_accurate) names.push_back(variant.name);
  std::erase_if(names, [&](const std::string& name) { return !wanted(scheme_properties(name)); });
  return names;
}

Variant scheme_called(const std::string& name) {
  // Bounces of the models in these tests accumulate, which the standard options refuse.
  if (name == "EventDrivenOSI") return {"EventDrivenOSI", "EventDrivenOSI", {{"velocity_tolerance", 1e-5}}};
  for (const Variant& variant : variants())
    if (variant.name == name) return variant;
  return {name.c_str(), name.c_str(), {}};
}

}  // namespace

std::unique_ptr<OneStepIntegrator> make_scheme(const std::string& name) {
  const Variant variant = scheme_called(name);
  return make_integrator(variant.scheme, variant.options);
}

SchemeProperties scheme_properties(const std::string& name) {
  const Variant variant = scheme_called(name);
  return integrator_properties(variant.scheme, variant.options);
}

std::vector<std::string> scheme_names() {
  return schemes_with([](const SchemeProperties&) { return true; });
}

std::vector<std::string> and_accurate_ones(std::vector<std::string> names) {
  for (const Variant& variant : variants())
    if (variant.too_accurate) names.push_back(variant.name);
  return names;
}

std::vector<std::string> frictional_schemes() {
  return schemes_with([](const SchemeProperties& p) { return p.friction; });
}

std::vector<std::string> with_fixed_steps(std::vector<std::string> names) {
  std::erase_if(names, [](const std::string& name) { return scheme_properties(name).error_controlled; });
  return names;
}

std::vector<std::string> error_controlled_schemes() {
  return schemes_with([](const SchemeProperties& p) { return p.error_controlled; });
}

std::vector<std::string> explicit_schemes() {
  return schemes_with([](const SchemeProperties& p) { return !p.implicit; });
}

bool keeps_velocity_constraints(const std::string& name) { return scheme_properties(name).velocity_level; }

double mu_taken_by(const std::string& name, double mu) { return scheme_properties(name).friction ? mu : 0.0; }

}  // namespace saltus::test
