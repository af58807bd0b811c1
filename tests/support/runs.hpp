#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "saltus/kernel/integrators/registry.hpp"
#include "saltus/kernel/simulation/time_stepping.hpp"

namespace saltus::test {

/// The message of the std::invalid_argument that the call throws, or a failed expectation.
std::string refusal(const std::function<void()>& call);
/// Expects that the call is refused with a message that holds all these words.
void expect_refusal(const std::function<void()>& call, const std::vector<std::string>& words);

/// State after a run of the model with fixed steps.
State run_to(const NonSmoothDynamicalSystem& model, const OneStepIntegrator& scheme, double dt, double until);

/// What every step of a run left behind.
struct Row {
  State state;
  Reactions reactions;
  StepReport report;
};
std::vector<Row> rows_of_run(const NonSmoothDynamicalSystem& model, const OneStepIntegrator& scheme,
                             double dt, double until);

/// Slope of log(error) over log(dt) by least squares.
double slope(const std::vector<double>& dt, const std::vector<double>& error);

/// Measured orders in q and v at the end of a run.
struct Orders {
  double q, v;
};
/// @param exact  state at until, of an independent solution
Orders measure_orders(const NonSmoothDynamicalSystem& model, const OneStepIntegrator& scheme,
                      const State& exact, double until, const std::vector<double>& dt);

/// y' = f(t, y) by classic Runge-Kutta steps: the independent solution that orders are measured against.
Vec integrate_ode(const std::function<Vec(double, const Vec&)>& f, Vec y, double until, int steps);

/// Equal to the last bit.
bool same_bits(const Vec& a, const Vec& b);

/// Every scheme of the registry with its standard options, and some with others, under names of their own.
std::vector<std::string> scheme_names();
/// Those of them that take friction.
std::vector<std::string> frictional_schemes();
/// Those that are not implicit in the forces.
std::vector<std::string> explicit_schemes();
/// Also those that are too accurate for the steps with which orders of all schemes are measured.
std::vector<std::string> and_accurate_ones(std::vector<std::string> names);
/// Without those that choose steps of their own: their errors do not depend on Δt.
std::vector<std::string> with_fixed_steps(std::vector<std::string> names);
/// These alone.
std::vector<std::string> error_controlled_schemes();
std::unique_ptr<OneStepIntegrator> make_scheme(const std::string& name);
SchemeProperties scheme_properties(const std::string& name);
/// Does the scheme keep Wᵀv of bilateral constraints at zero? On acceleration level only g̈ is kept.
bool keeps_velocity_constraints(const std::string& name);
/// The friction coefficient if the scheme takes friction, else 0.
double mu_taken_by(const std::string& name, double mu);

}  // namespace saltus::test
