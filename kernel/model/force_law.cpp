#include "saltus/kernel/model/force_law.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "saltus/numerics/text.hpp"

namespace saltus {
namespace {

// Forward differences lose half of the digits: enough for the direction of an iteration.
const double difference_step = std::sqrt(std::numeric_limits<double>::epsilon());

double require_finite(double value, const char* name) {
  if (!std::isfinite(value))
    throw std::invalid_argument(std::string(name) + " must be finite, got " + number(value));
  return value;
}

}  // namespace

double ForceLaw::force(double t, double length, double rate) const {
  const double linear = constant - stiffness * (length - rest_length) - damping * rate;
  return function ? linear + function(t, length, rate) : linear;
}

ForceLaw::Slopes ForceLaw::slopes(double t, double length, double rate) const {
  Slopes slopes{-stiffness, -damping};
  if (!function) return slopes;
  const double here = function(t, length, rate);
  const double dl = difference_step * std::max(1.0, std::abs(length));
  const double dr = difference_step * std::max(1.0, std::abs(rate));
  slopes.length += (function(t, length + dl, rate) - here) / dl;
  slopes.rate += (function(t, length, rate + dr) - here) / dr;
  return slopes;
}

double ForceLaw::potential_energy(double length) const {
  return 0.5 * stiffness * (length - rest_length) * (length - rest_length);
}

SpringDamper::SpringDamper(double k, double c, double l0) {
  stiffness = require_finite(k, "stiffness");
  damping = require_finite(c, "damping");
  rest_length = require_finite(l0, "rest_length");
  if (damping < 0.0) throw std::invalid_argument("damping must be >= 0, got " + number(c));
}

Actuator::Actuator(double force) { constant = require_finite(force, "force"); }

Actuator::Actuator(Function u) {
  if (!u) throw std::invalid_argument("force must be a function, got none");
  function = std::move(u);
}

Actuator::Actuator(ModelFunction u, Vec parameters) {
  if (!u) throw std::invalid_argument("force must be a function, got none");
  function = [u = std::move(u), arguments = FunctionArguments(std::move(parameters))](double t, double length,
                                                                                      double rate) {
    double force = 0.0;
    arguments.call(u, t, {&length, 1}, {&rate, 1}, &force);
    return force;
  };
}

}  // namespace saltus
