#include "saltus/kernel/model/plugin_model.hpp"

namespace saltus {

NonSmoothDynamicalSystem load_model(const std::string& library_and_function) {
  // Never destroyed: a model's classes, and what holds them, are the library's.
  static auto& owners = *new std::vector<std::shared_ptr<const void>>;
  PluginSymbol symbol = load_symbol(library_and_function, "saltus_model_");
  const auto* plugin = static_cast<const Plugin<NonSmoothDynamicalSystem>*>(symbol.address);
  require_abi(library_and_function, plugin->abi);
  owners.push_back(std::move(symbol.owner));
  return plugin->entry();
}

}  // namespace saltus
