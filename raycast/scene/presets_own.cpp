// Presets of our own for CT in Hounsfield units. Their colours change little across the densities
// of a surface: where they do, samples at fixed steps meet the ramp at varying depths and draw
// rings.
#include "raycast/scene/presets.h"

namespace supple {

namespace {

TransferFunction bone() {
  TransferFunction f;
  f.name = "Bone";
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

TransferFunction muscle() {
  TransferFunction f;
  f.name = "Muscle";
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

TransferFunction skin() {
  TransferFunction f;
  f.name = "Skin";
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

}  // namespace

const std::vector<NamedPreset>& own_presets() {
  static const std::vector<NamedPreset> presets = {
      {"Bone", bone}, {"Muscle", muscle}, {"Skin", skin}};
  return presets;
}

}  // namespace supple
