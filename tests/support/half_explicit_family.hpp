#pragma once
// The half-explicit schemes on velocity level: the trapezoidal rule and the named Runge-Kutta tableaux.
#include <gtest/gtest.h>

#include "saltus/kernel/integrators/half_explicit/half_explicit.hpp"
#include "saltus/kernel/integrators/half_explicit/order_conditions.hpp"
#include "saltus/kernel/integrators/registry.hpp"

namespace saltus::test {

inline std::vector<std::string> family_names() {
  return {"trapezoidal", "Heun", "third-order", "Kutta3", "RK4", "HEM5"};
}

/// @param activity  an option of that name, or "stabilised"
inline std::unique_ptr<OneStepIntegrator> family(const std::string& tableau, const std::string& activity,
                                                 Options options = {}) {
  if (activity == "stabilised")
    options["stabilization"] = "position";
  else
    options["activity"] = activity;
  if (tableau == "trapezoidal") return make_integrator("HalfExplicitTrapezoidalOSI", options);
  options["tableau"] = tableau;
  return make_integrator("HalfExplicitRungeKuttaOSI", options);
}

/// What the registry says of it.
inline TableauOrder family_order(const std::string& tableau) {
  const bool trapezoidal = tableau == "trapezoidal";
  const SchemeProperties properties =
      trapezoidal ? integrator_properties("HalfExplicitTrapezoidalOSI")
                  : integrator_properties("HalfExplicitRungeKuttaOSI", {{"tableau", tableau}});
  return {properties.order_free, properties.order_bilateral};
}

inline std::string family_test_name(const testing::TestParamInfo<std::string>& test) {
  return test.param == "third-order" ? "ThirdOrder" : test.param;
}

}  // namespace saltus::test
