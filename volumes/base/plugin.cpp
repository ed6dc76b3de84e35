#include "volumes/base/plugin.h"

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <vector>

#include <dlfcn.h>

#include "volumes/base/memory.h"

namespace supple {

namespace {

// A library may crash where its constructors find no room.
constexpr std::int64_t kWorkingBytes = std::int64_t(64) << 20;

std::filesystem::path program_folder() {
  std::error_code unknown;
  return std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path();
}

/// Returns the folder of the program or shared library that this code was linked into.
std::filesystem::path own_folder() {
  Dl_info info{};
  std::error_code unknown;
  if (::dladdr(reinterpret_cast<const void*>(&load_plugin), &info) != 0 && info.dli_fname) {
    // The dynamic loader knows a program by the name it was started by, which may be relative.
    const std::filesystem::path file = std::filesystem::canonical(info.dli_fname, unknown);
    if (!unknown && file.extension() != "") return file.parent_path();
  }
  return program_folder();
}

std::vector<std::filesystem::path> plugin_folders() {
  std::vector<std::filesystem::path> folders;
  if (const char* named = std::getenv("SUPPLE_PLUGIN_PATH")) {
    std::istringstream list(named);
    for (std::string folder; std::getline(list, folder, ':');) {
      if (!folder.empty()) folders.emplace_back(folder);
    }
  }
  std::filesystem::path own = own_folder();
  // The library for a level of the processor shares the plugins of the one for all.
  if (own.parent_path().filename() == "glibc-hwcaps") own = own.parent_path().parent_path();
  for (const std::filesystem::path& folder : {own, program_folder()}) {
    folders.insert(folders.end(),
                   {folder, folder.parent_path() / SUPPLE_LIBDIR / "supple", folder / "supple"});
  }
  return folders;
}

}  // namespace

LoadedPlugin load_plugin(const PluginName& name) {
  std::error_code unknown;
  const std::vector<std::filesystem::path> folders = plugin_folders();
  for (const std::filesystem::path& folder : folders) {
    const std::filesystem::path place = folder / name.file;
    if (!std::filesystem::exists(place, unknown)) continue;
    require_memory(kWorkingBytes);
    void* plugin = ::dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (plugin == nullptr) throw SystemError(place.string() + ": " + ::dlerror());
    return {place.string(), ::dlsym(plugin, name.symbol)};
  }
  throw SystemError((folders.front() / name.file).string() + ": the plugin that " + name.purpose +
                    " is missing");
}

}  // namespace supple
