// Materials by name, for tables that need not be typed: limits for ECM and the physical columns.
//
//              lengths      shear   stiffness   poisson   density     damping
//   soft-tissue  0.6…1.5    0.29    3.25 kPa    0.48    1060 kg/m³    10 ms
//   bone         1…1        0       18.6 GPa    0.3     1920 kg/m³    0.1 ms
//   brain        0.8…1.2    0.3     6 kPa       0.48    1040 kg/m³    10 ms
//   membrane     0.8…1.1    0.2     2.5 MPa     0.48    1130 kg/m³    1 ms
//
// Sources stand beside the values in presets.cpp and in docs/materials.md. Values found in the
// literature differ by up to two decades (brain 2.1 to 250 kPa, thesis table 3.1), so these are
// starting points. Nothing is plastic by preset. Tables of whole pictures are ct-head, ct-body,
// mr-brain and elastic-tissue.
#pragma once

#include <string>
#include <vector>

#include "lib/material/material.h"

namespace supple {

struct MaterialPreset {
  const char* name;
  double min_length, max_length, shear;  // factors of the rest length; min_length > 2 · shear
  double stiffness_kpa, poisson, mass_density, rayleigh_beta_ms;
};

const std::vector<MaterialPreset>& material_presets();

/// The names in quotes, separated by commas, for messages.
std::string material_preset_names();

/// Whole tables of a kind of picture, as TOML: "ct-head", "ct-body", "mr-brain", "elastic-tissue".
/// Densities of CT are in HU; bone moves as rigid pieces.
struct TissuePreset {
  const char* name;
  const char* table;
};
const std::vector<TissuePreset>& tissue_presets();
/// The tissue preset of that name; null where there is none.
const TissuePreset* find_tissue_preset(const std::string& name);
/// All presets in quotes, separated by commas.
std::string all_preset_names();

/// Constant curves over the domain [domain_lo, domain_hi]. Throws InputError without a file,
/// field "preset", with the names, for an unknown one.
LimitTable preset_table(const std::string& name, double domain_lo, double domain_hi);

}  // namespace supple
