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
      // Zubovits and Plewes, Phys. Med. Biol. 52, 1565-1576, 2007). Poisson's ratio: that of
      // brain below, for all water-like tissue. Density: soft tissue of ICRU Report 44.
      {"soft-tissue", 0.6, 1.5, 0.29, 3.25, 0.48, 1060, 10},
      // Stiffness: human cortical bone, microtensile 18.6 GPa, ultrasonic 20.7 GPa (Rho, Ashman
      // and Turner, J. Biomech. 26, 111-119, 1993). Poisson's ratio: the customary value of
      // isotropic models. Density: cortical bone of ICRU Report 44.
      {"bone", 1, 1, 0, 18.6e6, 0.3, 1920, 0.1},
      // Stiffness and Poisson's ratio: thesis section 6.2. Density: [Har99] in thesis table 3.1;
      // the same in ICRU Report 44.
      {"brain", 0.8, 1.2, 0.3, 6, 0.48, 1040, 10},
      // Dura mater. Stiffness: thesis section 6.2, after Patin et al. [PEHP93]. Poisson's ratio:
      // the same section; table 3.1 has 0.45 of [HLL+00]. Density: [HLL+00] in table 3.1.
      {"membrane", 0.8, 1.1, 0.2, 2500, 0.48, 1130, 1},
  };
  return presets;
}

// Limits are not measured ones, as above. Soft tissue gives more than "soft-tissue" does, since
// bone is rigid: a push must find room in front of it, and a turn of bone shears what it encloses.
// Cells may fold in CT, where min_length < 2 · shear.
//
// Stiffness: fat 3.25 kPa (Samani, Zubovits and Plewes 2007, as above); skin in vivo 4.5 to 8 kPa
// (Pailler-Mattei, Bec and Zahouani, Med. Eng. Phys. 30, 599-606, 2008), of which 6 stands for
// water-like tissue; brain: white matter 1.9 kPa, grey matter 1.4 kPa (Budday et al., J. Mech.
// Behav. Biomed. Mater. 46, 318-330, 2015), of which 1.6 stands for both. Poisson's ratio: that of
// brain in thesis section 6.2, for all water-like tissue. Densities: adipose tissue, soft tissue,
// brain and cortical bone of ICRU Report 44.
const std::vector<TissuePreset>& tissue_presets() {
  static const std::vector<TissuePreset> presets = {
      {"ct-head", R"(domain     = [-300, 3100]
active     = [-300, 3100]
components = "largest"
links      = 26
relax      = true
rigid      = [300, 3100]
max_length = [[-300, 2.0]]
min_length = [[-300, 0.4]]
shear      = [[-300, 0.6]]
stiffness  = [[-300, 3.25], [-50, 3.25], [50, 6]]
poisson    = [[-300, 0.48]]
density    = [[-300, 950], [-50, 950], [50, 1060], [300, 1060], [1500, 1920]]
damping    = [[-300, 10]]
)"},
      {"ct-body", R"(domain     = [-300, 3100]
active     = [-300, 3100]
components = "largest"
links      = 26
relax      = true
rigid      = [250, 3100]
max_length = [[-300, 1.8]]
min_length = [[-300, 0.5]]
shear      = [[-300, 0.4]]
stiffness  = [[-300, 3.25], [-50, 3.25], [50, 6]]
poisson    = [[-300, 0.48]]
density    = [[-300, 950], [-50, 950], [50, 1060], [300, 1060], [1500, 1920]]
damping    = [[-300, 10]]
)"},
      {"mr-brain", R"(active     = "foreground"
links      = 26
relax      = true
max_length = [[0, 1.3]]
min_length = [[0, 0.7]]
shear      = [[0, 0.3]]
stiffness  = [[0, 1.6]]
poisson    = [[0, 0.48]]
density    = [[0, 1040]]
damping    = [[0, 10]]
)"},
      // "soft-tissue" as relaxation comes nearest to finite elements of it
      // (docs/benchmarks/fit.md): with the volume of its Poisson's ratio, and limits that are out
      // of the way.
      {"elastic-tissue", R"(relax      = "poisson"
max_length = [[0, 1.9]]
min_length = [[0, 0.1]]
shear      = [[0, 0.9]]
stiffness  = [[0, 3.25]]
poisson    = [[0, 0.48]]
density    = [[0, 1060]]
damping    = [[0, 10]]
)"},
  };
  return presets;
}

const TissuePreset* find_tissue_preset(const std::string& name) {
  for (const TissuePreset& preset : tissue_presets()) {
    if (preset.name == name) return &preset;
  }
  return nullptr;
}

std::string all_preset_names() {
  std::string names = material_preset_names();
  for (const TissuePreset& preset : tissue_presets()) {
    names += std::string(", \"") + preset.name + '"';
  }
  return names;
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
  table.poisson = constant(preset->poisson);
  table.mass_density = constant(preset->mass_density);
  table.rayleigh_beta_ms = constant(preset->rayleigh_beta_ms);
  return table;
}

}  // namespace supple
