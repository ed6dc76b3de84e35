// The presets. Names and intent follow 3D Slicer's volume rendering presets
// (Modules/Loadable/VolumeRendering/Resources/presets.xml); the tables are our own, with opacities
// per millimetre. CT presets expect Hounsfield units. MR-Default has a fixed range, as in Slicer:
// it suits 8-bit and similarly scaled MRI (tissue between 40 and 250); other scalings want their
// own table. Colours change little across the densities of a surface: where they do, samples at
// fixed steps meet the ramp at varying depths and draw rings.
#include "raycast/transfer_function.h"
#include "volumes/base/error.h"

namespace supple {

namespace {

TransferFunction ct_bone() {
  TransferFunction f;
  f.name = "CT-Bone";
  f.opacity = {{-1024, 0}, {180, 0}, {280, 0.15}, {420, 0.6}, {700, 0.85}, {3071, 0.9}};
  f.colour = {{-1024, {0.86, 0.72, 0.56}},
              {140, {0.86, 0.72, 0.56}},
              {500, {0.92, 0.84, 0.69}},
              {1200, {0.97, 0.93, 0.84}},
              {3071, {1, 1, 1}}};
  f.full_shading_gradient = 200;
  f.ambient = 0.12, f.diffuse = 0.8, f.specular = 0.2, f.specular_power = 12;
  return f;
}

TransferFunction ct_muscle() {
  TransferFunction f;
  f.name = "CT-Muscle";
  f.opacity = {{-1024, 0}, {-100, 0}, {20, 0.1}, {80, 0.28}, {220, 0.6}, {420, 0.85}, {3071, 0.85}};
  f.colour = {{-1024, {0.70, 0.31, 0.23}},
              {60, {0.72, 0.33, 0.24}},
              {160, {0.86, 0.58, 0.42}},
              {350, {0.95, 0.88, 0.76}},
              {3071, {1, 1, 1}}};
  f.full_shading_gradient = 60;
  f.ambient = 0.15, f.diffuse = 0.88, f.specular = 0.2, f.specular_power = 10;
  return f;
}

TransferFunction ct_soft_tissue() {
  TransferFunction f;
  f.name = "CT-Soft-Tissue";
  f.opacity = {{-1024, 0}, {-300, 0}, {-160, 0.9}, {3071, 0.95}};
  f.colour = {{-1024, {0.91, 0.72, 0.60}},
              {0, {0.91, 0.72, 0.60}},
              {150, {0.93, 0.76, 0.66}},
              {400, {0.98, 0.92, 0.84}},
              {3071, {1, 1, 1}}};
  f.full_shading_gradient = 150;
  f.ambient = 0.15, f.diffuse = 0.85, f.specular = 0.12, f.specular_power = 12;
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

/// The window of a bone scan's projection; air and fat stay transparent.
TransferFunction ct_mip() {
  TransferFunction f;
  f.name = "CT-MIP";
  f.blend = Blend::maximum;
  f.opacity = {{-1024, 0}, {-200, 0}, {0, 0.25}, {600, 1}, {3071, 1}};
  f.colour = {{-1024, {0, 0, 0}}, {-200, {0, 0, 0}}, {1600, {1, 1, 1}}, {3071, {1, 1, 1}}};
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

using Maker = TransferFunction (*)();
struct Entry {
  const char* name;
  Maker make;
};
constexpr Entry kPresets[] = {{"CT-Bone", ct_bone},       {"CT-MIP", ct_mip},
                              {"CT-Muscle", ct_muscle},   {"CT-Soft-Tissue", ct_soft_tissue},
                              {"MR-Default", mr_default}, {"MR-MIP", mr_mip}};

}  // namespace

TransferFunction preset(const std::string& name) {
  std::string known;
  for (const Entry& entry : kPresets) {
    if (name == entry.name) return entry.make();
    known += (known.empty() ? "" : ", ") + std::string(entry.name);
  }
  throw InputError({"", "preset", name, "one of " + known});
}

std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  for (const Entry& entry : kPresets) names.emplace_back(entry.name);
  return names;
}

}  // namespace supple
