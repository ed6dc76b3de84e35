#include "raycast/scene/presets.h"

#include "volumes/base/error.h"

namespace supple {

TransferFunction preset(const std::string& name) {
  std::string known;
  for (const auto* presets : {&ct_presets(), &mr_presets()}) {
    for (const NamedPreset& entry : *presets) {
      if (name == entry.name) return entry.make();
      known += (known.empty() ? "" : ", ") + std::string(entry.name);
    }
  }
  throw InputError({"", "preset", name, "one of " + known});
}

std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  for (const auto* presets : {&ct_presets(), &mr_presets()}) {
    for (const NamedPreset& entry : *presets) names.emplace_back(entry.name);
  }
  return names;
}

}  // namespace supple
