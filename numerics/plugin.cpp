#include "saltus/numerics/plugin.hpp"

#define BOOST_DLL_USE_STD_FS
#include <boost/dll/shared_library.hpp>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace saltus {
namespace {

using boost::dll::shared_library;
namespace load_mode = boost::dll::load_mode;

std::invalid_argument refused(std::string_view what, const std::string& why) {
  return std::invalid_argument("plugin '" + std::string(what) + "': " + why);
}

// The file itself; with .so after its name, or lib and .so around it; without a folder, where the system's
// loader looks.
std::shared_ptr<shared_library> open(std::string_view what, const std::string& file) {
  std::filesystem::path path(file);
  const bool anywhere = !path.has_parent_path();
  if (anywhere) path = std::filesystem::path(".") / path;
  std::string why;
  const auto tried = [&](const std::filesystem::path& where, load_mode::type modes) {
    try {
      return std::make_shared<shared_library>(where, modes | load_mode::rtld_now | load_mode::rtld_local);
    } catch (const std::exception& error) {
      if (why.empty()) why = error.what();
      return std::shared_ptr<shared_library>();
    }
  };
  bool is_file = std::filesystem::is_regular_file(path);
  if (!is_file && std::filesystem::is_regular_file(path.string() + ".so")) {
    path += ".so";
    is_file = true;
  }
  auto library = tried(path, is_file ? load_mode::default_mode : load_mode::append_decorations);
  if (!library && anywhere && !is_file)
    library = tried(file, load_mode::append_decorations | load_mode::search_system_folders);
  if (!library) throw refused(what, "the library cannot be loaded: " + why);
  return library;
}

}  // namespace

bool names_plugin(std::string_view text) { return text.find(':') != std::string_view::npos; }

PluginSymbol load_symbol(std::string_view what, std::string_view prefix) {
  const auto colon = what.rfind(':');
  if (colon == std::string_view::npos || colon == 0 || colon + 1 == what.size())
    throw refused(what, "expected the form library:name");
  const auto library = open(what, std::string(what.substr(0, colon)));
  const std::string name = std::string(prefix) + std::string(what.substr(colon + 1));
  if (!library->has(name)) throw refused(what, "the library exports no '" + name + "'");
  return {&library->get<char>(name), library};
}

void require_abi(std::string_view what, std::string_view abi) {
  if (abi != SALTUS_PLUGIN_ABI)
    throw refused(what,
                  "it was built for the ABI '" + std::string(abi) + "', this is '" SALTUS_PLUGIN_ABI "'");
}

}  // namespace saltus
