// The presets of transfer_function.h, from the file that is built in.
#include "raycast/scene/presets.h"

#include <map>

#include "raycast/scene/transfer_file.h"
#include "volumes/base/error.h"
#include "volumes/base/fields.h"

namespace supple {

namespace {

std::map<std::string, TransferFunction> read_presets() {
  std::map<std::string, TransferFunction> presets;
  Table root = Table::parse(kPresets, "presets.toml");
  for (Table& table : root.tables("preset")) {
    TransferFunction function = read_transfer_function(table);
    presets.emplace(function.name, function);
  }
  root.finish();
  return presets;
}

const std::map<std::string, TransferFunction>& presets_by_name() {
  static const std::map<std::string, TransferFunction> presets = read_presets();
  return presets;
}

}  // namespace

TransferFunction preset(const std::string& name) {
  const auto found = presets_by_name().find(name);
  if (found != presets_by_name().end()) return found->second;
  throw InputError({"", "preset", name, "one of " + listed(preset_names(), "or")});
}

std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  for (const auto& [name, function] : presets_by_name()) names.push_back(name);
  return names;
}

}  // namespace supple
