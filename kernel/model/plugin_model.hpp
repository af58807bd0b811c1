#pragma once
#include <string>

#include "saltus/kernel/model/nonsmooth_dynamical_system.hpp"
#include "saltus/numerics/plugin.hpp"

namespace saltus {

/// Composes the model that a shared library exports with SALTUS_MODEL.
/// @param library_and_function  "library:function", see load_symbol(); the library stays loaded
/// @throws std::invalid_argument as load_symbol() and require_abi(), and what the function throws
NonSmoothDynamicalSystem load_model(const std::string& library_and_function);

}  // namespace saltus

/// In a plugin, exports `saltus::NonSmoothDynamicalSystem function()` as "library:function".
#define SALTUS_MODEL(function)                                                                             \
  extern "C" __attribute__((visibility("default"))) const saltus::Plugin<saltus::NonSmoothDynamicalSystem> \
      saltus_model_##function = {SALTUS_PLUGIN_ABI, function}
