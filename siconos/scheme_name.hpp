#pragma once
#include <memory>
#include <string>

#include "saltus/kernel/integrators/registry.hpp"

namespace saltus::siconos {

/// The integrator of "Name" or "Name(option=value, ...)"; values are numbers or words.
/// @throws std::invalid_argument if the text has no such form, and as make_integrator()
std::unique_ptr<saltus::OneStepIntegrator> make_scheme(const std::string& text);

}  // namespace saltus::siconos
