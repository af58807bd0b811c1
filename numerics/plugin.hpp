#pragma once
// Shared libraries that bring integrators, contact solvers or model functions.
#include <Eigen/Core>
#include <memory>
#include <string_view>

namespace saltus {

/// A symbol of a shared library; the library stays loaded while `owner` lives.
struct PluginSymbol {
  const void* address = nullptr;
  std::shared_ptr<const void> owner;
};

/// Is the text of the form "library:name"?
bool names_plugin(std::string_view text);

/// Finds what "library:name" stands for. The library is a file ("./libown.so"), a file without its decoration
/// ("./own" for own.so or libown.so), or, without a folder, one of the current folder or of the system's.
/// @param prefix  put before the name
/// @throws std::invalid_argument if the text has no such form, or library or symbol cannot be loaded
PluginSymbol load_symbol(std::string_view library_and_name, std::string_view prefix = "");

/// What a plugin exports for one of its classes: the ABI first, so that it is compared before anything else.
template <class Entry>
struct Plugin {
  const char* abi;
  Entry (*entry)();  ///< its line in the registry
};

/// @throws std::invalid_argument naming the plugin if it was built for another ABI than this library
void require_abi(std::string_view library_and_name, std::string_view abi);

}  // namespace saltus

#define SALTUS_TEXT_OF(x) #x
#define SALTUS_TEXT(x) SALTUS_TEXT_OF(x)
/// What this translation unit and a plugin must agree on: the version of these interfaces, to be raised with
/// every change of a class that plugins see, and what decides about the layout of their arguments.
#define SALTUS_PLUGIN_ABI                                              \
  "saltus 8, Eigen " SALTUS_TEXT(EIGEN_WORLD_VERSION) "." SALTUS_TEXT( \
      EIGEN_MAJOR_VERSION) " aligned to " SALTUS_TEXT(EIGEN_MAX_ALIGN_BYTES) ", C++ " SALTUS_TEXT(__GXX_ABI_VERSION)
