#include "raycast/scene/presets.h"

#include <algorithm>

#include "volumes/base/error.h"

namespace supple {

namespace {

std::vector<NamedPreset> all_presets() {
  std::vector<NamedPreset> all;
  for (const auto* presets : {&ct_presets(), &mr_presets(), &own_presets()}) {
    all.insert(all.end(), presets->begin(), presets->end());
  }
  return all;
}

}  // namespace

TransferFunction preset(const std::string& name) {
  for (const NamedPreset& entry : all_presets()) {
    if (name == entry.name) return entry.make();
  }
  std::string known;
  for (const std::string& other : preset_names()) known += (known.empty() ? "" : ", ") + other;
  throw InputError({"", "preset", name, "one of " + known});
}

std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  for (const NamedPreset& entry : all_presets()) names.emplace_back(entry.name);
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace supple
