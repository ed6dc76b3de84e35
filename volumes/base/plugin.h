// Plugins: shared objects that the program loads when it first needs their libraries, so that a
// start costs neither their time nor their memory. A plugin carries its own copies of the few
// sources that it needs and exports one symbol, its entry. Objects cross the border through virtual
// functions and as exceptions.
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "volumes/base/error.h"

namespace supple {

struct PluginName {
  const char* file;
  const char* symbol;   // of the entry
  const char* purpose;  // completes "the plugin that ..."
};

/// A loaded plugin: its entry is null where the file has no such symbol.
struct LoadedPlugin {
  std::string path;
  const void* entry;
};

/// Loads the plugin from the folders that SUPPLE_PLUGIN_PATH names (separated by ':'), or else from
/// beside the program or library that holds this code: its own folder, ../lib/supple, or supple
/// below it. It is never unloaded, since objects that it made and exceptions in flight use its
/// code. Throws SystemError: missing, or refused by the system; std::bad_alloc where less than 64
/// MiB of addresses are left.
LoadedPlugin load_plugin(const PluginName& name);

/// The entry of a plugin of this build. Entry has the members kName, kSizes and sizes: the sizes of
/// the types that cross the border, as the program and as the plugin see them. Throws SystemError
/// also where these differ.
template <class Entry>
const Entry& plugin_entry() {
  const LoadedPlugin plugin = load_plugin(Entry::kName);
  const auto* entry = static_cast<const Entry*>(plugin.entry);
  if (entry == nullptr || entry->sizes != Entry::kSizes) {
    throw SystemError(plugin.path + ": this plugin belongs to another build of the program");
  }
  return *entry;
}

}  // namespace supple
