#include "lib/material/presets.h"

#include <algorithm>

#include "volumes/base/error.h"

namespace supple {

// Limits are not measured ones: bone is rigid, soft tissue has the lengths of the thesis' softest
// link (section 4.2.3, figure 4.10), and shear stays below half of min_length, so that no cell
// folds. Damping is our choice, too: a loss factor 2π f β of about 0.3 at f = 5 Hz in soft tissue
// and brain, less in what is stiffer.
const std::vector<MaterialPreset>& material_presets() {
  static const std::vector<MaterialPreset> presets = {
      // Stiffness: normal breast fat, 3.25 kPa, fibroglandular tissue nearly the same (Samani,
      // Zubovits and Plewes, Phys. Med. Biol. 52, 1565-1576, 2007). Density: soft tissue of ICRU
      // Report 44.
      {"soft-tissue", 0.6, 1.5, 0.29, 3.25, 1060, 10},
      // Stiffness: human cortical bone, microtensile 18.6 GPa, ultrasonic 20.7 GPa (Rho, Ashman
      // and Turner, J. Biomech. 26, 111-119, 1993). Density: cortical bone of ICRU Report 44.
      {"bone", 1, 1, 0, 18.6e6, 1920, 0.1},
      // Stiffness: thesis section 6.2. Density: [Har99] in thesis table 3.1; the same in ICRU
      // Report 44.
      {"brain", 0.8, 1.2, 0.3, 6, 1040, 10},
      // Dura mater. Stiffness: thesis section 6.2, after Patin et al. [PEHP93]. Density: [HLL+00]
      // in thesis table 3.1.
      {"membrane", 0.8, 1.1, 0.2, 2500, 1130, 1},
  };
  return presets;
}

std::string material_preset_names() {
  std::string names;
  for (const MaterialPreset& preset : material_presets()) {
    names += std::string(names.empty() ? "" : ", ") + '"' + preset.name + '"';
  }
  return names;
}

LimitTable preset_table(const std::string& name, double domain_lo, double domain_hi) {
  const auto& presets = material_presets();
  const auto preset =
      std::find_if(presets.begin(), presets.end(),
                   [&](const MaterialPreset& candidate) { return candidate.name == name; });
  if (preset == presets.end()) {
    throw InputError({"", "preset", '"' + name + '"', "one of " + material_preset_names()});
  }
  const auto constant = [&](double value) { return Curve{{{domain_lo, value}}}; };
  LimitTable table;
  table.domain_lo = domain_lo;
  table.domain_hi = domain_hi;
  table.min_length = constant(preset->min_length);
  table.max_length = constant(preset->max_length);
  table.shear1 = table.shear2 = constant(preset->shear);
  table.stiffness = constant(preset->stiffness_kpa);
  table.mass_density = constant(preset->mass_density);
  table.rayleigh_beta_ms = constant(preset->rayleigh_beta_ms);
  return table;
}

}  // namespace supple
