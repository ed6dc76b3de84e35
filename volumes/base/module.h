// Modules: shared objects that the program loads when it first needs what their libraries do, so
// that starting it costs neither their time nor their memory. A module carries its own copies of
// the few sources that it needs and exports one symbol, its entry. Objects cross the border through
// virtual functions and as exceptions.
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "volumes/base/error.h"

namespace supple {

struct ModuleName {
  const char* file;
  const char* symbol;   // of the entry
  const char* purpose;  // completes "the module that ..."
};

/// A loaded module: its entry is null where the file has no such symbol.
struct LoadedModule {
  std::string path;
  const void* entry;
};

/// Loads the module from the program's folder or from ../lib/supple of it; it is never unloaded,
/// since objects that it made and exceptions in flight use its code. Throws SystemError: missing,
/// or refused by the system; std::bad_alloc where less than 64 MiB of addresses are left.
LoadedModule load_module(const ModuleName& name);

/// The entry of a module of this build. Entry has the members kName, kSizes and sizes: the sizes of
/// the types that cross the border, as the program and as the module see them. Throws SystemError
/// also where these differ.
template <class Entry>
const Entry& module_entry() {
  const LoadedModule module = load_module(Entry::kName);
  const auto* entry = static_cast<const Entry*>(module.entry);
  if (entry == nullptr || entry->sizes != Entry::kSizes) {
    throw SystemError(module.path + ": this module belongs to another build of the program");
  }
  return *entry;
}

}  // namespace supple
