// Presets for MRI. They have a fixed range, as in Slicer: they suit 8-bit and similarly scaled MRI
// (tissue between 40 and 250); other scalings want their own table.
#include "raycast/scene/presets.h"

namespace supple {

namespace {

/// Bright vessels, as in time-of-flight angiography.
TransferFunction mr_angio() {
  TransferFunction f;
  f.name = "MR-Angio";
  f.opacity = {{130, 0}, {180, 0.12}, {230, 0.6}, {255, 0.8}};
  f.colour = {{130, {0.55, 0.06, 0.04}}, {190, {0.8, 0.16, 0.1}}, {255, {1, 0.82, 0.62}}};
  f.ambient = 0.2, f.diffuse = 0.85, f.specular = 0.3, f.specular_power = 16;
  return f;
}

TransferFunction mr_default() {
  TransferFunction f;
  f.name = "MR-Default";
  f.opacity = {{0, 0}, {20, 0}, {45, 0.15}, {120, 0.3}, {220, 0.4}, {1024, 0.5}};
  f.colour = {{0, {0, 0, 0}},
              {20, {0.17, 0.02, 0.01}},
              {45, {0.42, 0.16, 0.09}},
              {120, {0.78, 0.60, 0.40}},
              {220, {0.86, 0.83, 0.78}},
              {1024, {1, 1, 1}}};
  f.ambient = 0.3, f.diffuse = 1.0, f.specular = 0.2, f.specular_power = 10;
  return f;
}

TransferFunction mr_mip() {
  TransferFunction f;
  f.name = "MR-MIP";
  f.blend = Blend::maximum;
  f.opacity = {{0, 0}, {20, 0}, {100, 1}, {1024, 1}};
  f.colour = {{0, {0, 0, 0}}, {250, {1, 1, 1}}, {1024, {1, 1, 1}}};
  return f;
}

/// T2-weighted brain: liquor is the brightest.
TransferFunction mr_t2_brain() {
  TransferFunction f;
  f.name = "MR-T2-Brain";
  f.opacity = {{30, 0}, {60, 0.03}, {120, 0.15}, {180, 0.4}, {255, 0.7}};
  f.colour = {{30, {0.25, 0.2, 0.22}},
              {100, {0.62, 0.52, 0.5}},
              {170, {0.85, 0.8, 0.78}},
              {255, {0.75, 0.9, 1}}};
  f.full_shading_gradient = 15;
  f.ambient = 0.25, f.diffuse = 0.9, f.specular = 0.15, f.specular_power = 10;
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
