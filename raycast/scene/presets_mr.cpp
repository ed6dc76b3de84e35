// Presets for MRI. They have a fixed range, as in Slicer: they suit 8-bit and similarly scaled MRI
// (tissue between 40 and 250); other scalings want their own table.
#include "raycast/scene/presets.h"

namespace supple {

namespace {

/// Bright vessels, as in time-of-flight angiography.
TransferFunction mr_angio() {
  TransferFunction f;
  f.name = "MR-Angio";
  f.opacity = {{151, 0}, {158, 0.44}, {190, 0.58}, {201, 0.73}};
  f.colour = {{151, {0.37, 0.19, 0}},
              {158, {0.75, 0.38, 0}},
              {190, {1, 0.87, 0.73}},
              {201, {0.94, 0.94, 0.94}},
              {3661, {1, 1, 1}}};
  f.ambient = 0.2, f.diffuse = 1, f.specular = 0, f.specular_power = 1;
  return f;
}

/// Skin and thin tissue brown, brain grey, fat and marrow white.
TransferFunction mr_default() {
  TransferFunction f;
  f.name = "MR-Default";
  f.opacity = {{0, 0}, {20, 0}, {45, 0.15}, {120, 0.3}, {220, 0.4}, {1024, 0.5}};
  f.colour = {{0, {0, 0, 0}},
              {20, {0.17, 0.02, 0.01}},
              {45, {0.42, 0.18, 0.11}},
              {75, {0.60, 0.42, 0.32}},
              {100, {0.62, 0.57, 0.52}},
              {130, {0.70, 0.68, 0.65}},
              {220, {0.90, 0.88, 0.85}},
              {1024, {1, 1, 1}}};
  f.ambient = 0.3, f.diffuse = 1.0, f.specular = 0.2, f.specular_power = 10;
  return f;
}

TransferFunction mr_mip() {
  TransferFunction f;
  f.name = "MR-MIP";
  f.blend = Blend::maximum;
  f.background = "black";
  f.opacity = {{98, 0}, {417, 1}};
  f.colour = {{98, {1, 1, 1}}};
  return f;
}

/// T2-weighted brain: tissue yellow, liquor, the brightest, blue.
TransferFunction mr_t2_brain() {
  TransferFunction f;
  f.name = "MR-T2-Brain";
  f.opacity = {{36, 0}, {218, 0.17}, {412, 1}};
  f.colour = {{0, {0, 0, 0}}, {99, {0.96, 0.84, 0.19}}, {412, {0, 0.59, 0.81}}, {641, {1, 1, 1}}};
  f.full_shading_gradient = 15;
  f.ambient = 0.3, f.diffuse = 0.6, f.specular = 0.5, f.specular_power = 40;
  return f;
}

}  // namespace

const std::vector<NamedPreset>& mr_presets() {
  static const std::vector<NamedPreset> presets = {{"MR-Angio", mr_angio},
                                                   {"MR-Default", mr_default},
                                                   {"MR-MIP", mr_mip},
                                                   {"MR-T2-Brain", mr_t2_brain}};
  return presets;
}

}  // namespace supple
