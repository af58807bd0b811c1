#pragma once
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "saltus/numerics/plugin.hpp"

namespace saltus {

/// A table of things that are made by name: those of the library, then those added at run time, by plugins or
/// in Python. Lines are never removed. Not to be changed while another thread reads it.
template <class Entry>
class Registry {
 public:
  /// @param kind    for messages: "integrator"
  /// @param prefix  of the symbols that plugins of this kind export
  Registry(std::string kind, std::string prefix, std::vector<Entry> entries)
      : kind_(std::move(kind)), prefix_(std::move(prefix)), entries_(std::move(entries)) {}

  const std::vector<Entry>& entries() const { return entries_; }

  /// @throws std::invalid_argument if the entry has no name, one with ':' or one that is taken
  void add(Entry entry) {
    if (entry.name.empty() || names_plugin(entry.name))
      throw std::invalid_argument(kind_ + ": a name must not be empty or hold ':', got '" + entry.name + "'");
    for (const Entry& other : entries_)
      if (other.name == entry.name)
        throw std::invalid_argument(kind_ + ": there is one named '" + entry.name + "' already");
    entries_.push_back(std::move(entry));
  }

  /// Adds what a plugin exports. @return its name; loading it again changes nothing
  /// @throws std::invalid_argument as load_symbol(), require_abi() and add()
  std::string load(const std::string& library_and_class) {
    PluginSymbol symbol = load_symbol(library_and_class, prefix_);
    const auto known = loaded_.find(symbol.address);
    if (known != loaded_.end()) return known->second.name;
    const auto* plugin = static_cast<const Plugin<Entry>*>(symbol.address);
    require_abi(library_and_class, plugin->abi);
    Entry entry = plugin->entry();
    const std::string name = entry.name;
    add(std::move(entry));
    loaded_[symbol.address] = {name, std::move(symbol.owner)};
    return name;
  }

  /// @param name  in the table, or "library:Class" of a plugin, which is loaded then
  /// @throws std::invalid_argument if there is no such line, naming those that there are
  const Entry& find(std::string_view name) {
    const std::string wanted = names_plugin(name) ? load(std::string(name)) : std::string(name);
    std::string known;
    for (const Entry& entry : entries_) {
      if (entry.name == wanted) return entry;
      known += (known.empty() ? "" : ", ") + entry.name;
    }
    throw std::invalid_argument("no " + kind_ + " named '" + wanted + "', there are " + known);
  }

 private:
  std::string kind_, prefix_;
  std::vector<Entry> entries_;
  struct Loaded {
    std::string name;
    std::shared_ptr<const void> owner;  // the code outlives every object that it made
  };
  std::map<const void*, Loaded> loaded_;  // by the address of the plugin's symbol
};

}  // namespace saltus
