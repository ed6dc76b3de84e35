// Presets for CT in Hounsfield units.
#include "raycast/scene/presets.h"

namespace supple {

namespace {

/// Walls of airways and sinuses from the side of the air; the air around the body has one, too.
TransferFunction ct_air() {
  TransferFunction f;
  f.name = "CT-Air";
  f.opacity = {{-1024, 0.25}, {-700, 0.25}, {-450, 0}};
  f.colour = {{-1024, {0.55, 0.72, 0.9}}, {-450, {0.8, 0.9, 1}}};
  f.gradient_opacity = {{10, 0}, {80, 1}};
  f.full_shading_gradient = 150;
  f.ambient = 0.2, f.diffuse = 0.8, f.specular = 0.2, f.specular_power = 12;
  return f;
}

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

/// Whiter than CT-Bone, with cartilage and thin bone in red.
TransferFunction ct_bones() {
  TransferFunction f;
  f.name = "CT-Bones";
  f.opacity = {{110, 0}, {200, 0.06}, {320, 0.5}, {900, 0.95}};
  f.colour = {{110, {0.72, 0.3, 0.24}},
              {260, {0.88, 0.68, 0.54}},
              {500, {0.95, 0.9, 0.8}},
              {1200, {1, 1, 1}}};
  f.full_shading_gradient = 200;
  f.ambient = 0.15, f.diffuse = 0.8, f.specular = 0.25, f.specular_power = 20;
  return f;
}

/// A heart filled with contrast medium in a veil of muscle.
TransferFunction ct_cardiac() {
  TransferFunction f;
  f.name = "CT-Cardiac";
  f.opacity = {{-60, 0}, {10, 0.01}, {80, 0.05}, {140, 0.12}, {280, 0.6}, {800, 0.85}};
  f.colour = {{-60, {0.45, 0.1, 0.08}},
              {60, {0.62, 0.2, 0.14}},
              {160, {0.8, 0.28, 0.16}},
              {260, {0.93, 0.66, 0.4}},
              {600, {1, 0.96, 0.86}}};
  f.full_shading_gradient = 120;
  f.ambient = 0.15, f.diffuse = 0.85, f.specular = 0.25, f.specular_power = 16;
  return f;
}

/// Vessels with contrast medium and bone behind a veil of skin and fat.
TransferFunction ct_chest_contrast_enhanced() {
  TransferFunction f;
  f.name = "CT-Chest-Contrast-Enhanced";
  f.opacity = {{-400, 0},   {-250, 0.02}, {-80, 0.02}, {20, 0.02},
               {120, 0.15}, {250, 0.6},   {700, 0.85}};
  f.colour = {{-400, {0.8, 0.55, 0.42}},
              {0, {0.8, 0.48, 0.36}},
              {120, {0.76, 0.2, 0.14}},
              {250, {0.9, 0.52, 0.36}},
              {500, {0.98, 0.94, 0.84}}};
  f.full_shading_gradient = 120;
  f.ambient = 0.15, f.diffuse = 0.85, f.specular = 0.2, f.specular_power = 12;
  return f;
}

/// Vessels with contrast medium, red; bone.
TransferFunction ct_chest_vessels() {
  TransferFunction f;
  f.name = "CT-Chest-Vessels";
  f.opacity = {{90, 0}, {160, 0.15}, {260, 0.7}, {700, 0.8}};
  f.colour = {{90, {0.6, 0.05, 0.04}},
              {240, {0.82, 0.16, 0.1}},
              {420, {0.95, 0.72, 0.52}},
              {800, {1, 0.97, 0.9}}};
  f.full_shading_gradient = 150;
  f.ambient = 0.15, f.diffuse = 0.85, f.specular = 0.35, f.specular_power = 20;
  return f;
}

/// Bone with a trace of soft tissue, for volumes cut by clips.
TransferFunction ct_cropped_volume_bone() {
  TransferFunction f;
  f.name = "CT-Cropped-Volume-Bone";
  f.opacity = {{-180, 0}, {20, 0.02}, {150, 0.05}, {280, 0.4}, {700, 0.9}};
  f.colour = {{-180, {0.75, 0.4, 0.32}},
              {150, {0.8, 0.5, 0.38}},
              {320, {0.92, 0.82, 0.66}},
              {1000, {1, 0.98, 0.92}}};
  f.full_shading_gradient = 200;
  f.ambient = 0.15, f.diffuse = 0.85, f.specular = 0.2, f.specular_power = 12;
  return f;
}

/// Fat alone: between -220 and -10 HU, where skin borders on air, too.
TransferFunction ct_fat() {
  TransferFunction f;
  f.name = "CT-Fat";
  f.opacity = {{-220, 0}, {-130, 0.25}, {-60, 0.25}, {-10, 0}};
  f.colour = {{-220, {0.9, 0.72, 0.36}}, {-10, {0.96, 0.86, 0.58}}};
  f.full_shading_gradient = 100;
  f.ambient = 0.2, f.diffuse = 0.85, f.specular = 0.15, f.specular_power = 10;
  return f;
}

/// Lung, and whatever else lies between air and water, such as the surface of the skin.
TransferFunction ct_lung() {
  TransferFunction f;
  f.name = "CT-Lung";
  f.opacity = {{-920, 0}, {-850, 0.04}, {-600, 0.12}, {-450, 0.02}, {-350, 0}};
  f.colour = {{-920, {0.62, 0.7, 0.82}}, {-600, {0.86, 0.62, 0.56}}, {-350, {0.95, 0.8, 0.72}}};
  f.full_shading_gradient = 150;
  f.ambient = 0.2, f.diffuse = 0.85, f.specular = 0.15, f.specular_power = 10;
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

/// A radiograph: opacity in proportion to attenuation, white, without light.
TransferFunction ct_x_ray() {
  TransferFunction f;
  f.name = "CT-X-ray";
  f.opacity = {{-900, 0}, {0, 0.0022}, {200, 0.0035}, {1000, 0.012}, {3000, 0.03}};
  f.colour = {{0, {1, 1, 1}}};
  f.ambient = 1, f.diffuse = 0, f.specular = 0;
  return f;
}

}  // namespace

const std::vector<NamedPreset>& ct_presets() {
  static const std::vector<NamedPreset> presets = {
      {"CT-Air", ct_air},
      {"CT-Bone", ct_bone},
      {"CT-Bones", ct_bones},
      {"CT-Cardiac", ct_cardiac},
      {"CT-Chest-Contrast-Enhanced", ct_chest_contrast_enhanced},
      {"CT-Chest-Vessels", ct_chest_vessels},
      {"CT-Cropped-Volume-Bone", ct_cropped_volume_bone},
      {"CT-Fat", ct_fat},
      {"CT-Lung", ct_lung},
      {"CT-MIP", ct_mip},
      {"CT-Muscle", ct_muscle},
      {"CT-Soft-Tissue", ct_soft_tissue},
      {"CT-X-ray", ct_x_ray}};
  return presets;
}

}  // namespace supple
