#include "volumes/base/plugin.h"

#include <filesystem>

#include <dlfcn.h>

#include "volumes/base/require_memory.h"

namespace supple {

namespace {

// A library may crash where its constructors find no room.
constexpr std::int64_t kWorkingBytes = std::int64_t(64) << 20;

}  // namespace

LoadedPlugin load_plugin(const PluginName& name) {
  std::error_code unknown;
  const std::filesystem::path folder =
      std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path();
  const std::filesystem::path beside = folder / name.file;
  const std::filesystem::path installed = folder.parent_path() / "lib" / "supple" / name.file;
  for (const std::filesystem::path& place : {beside, installed}) {
    if (!std::filesystem::exists(place, unknown)) continue;
    require_memory(kWorkingBytes);
    void* plugin = dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (plugin == nullptr) throw SystemError(place.string() + ": " + dlerror());
    return {place.string(), dlsym(plugin, name.symbol)};
  }
  throw SystemError(beside.string() + ": the plugin that " + name.purpose + " is missing");
}

}  // namespace supple
