// Presets for CT in Hounsfield units.
#include "raycast/scene/presets.h"

namespace supple {

namespace {

/// The three ways in which these presets answer to light.
TransferFunction glossy(const char* name) {
  TransferFunction f;
  f.name = name;
  f.full_shading_gradient = 60;
  f.ambient = 0.1, f.diffuse = 0.9, f.specular = 0.2, f.specular_power = 10;
  return f;
}
TransferFunction matte(const char* name) {
  TransferFunction f = glossy(name);
  f.ambient = 0.2, f.diffuse = 1, f.specular = 0, f.specular_power = 1;
  return f;
}
TransferFunction unlit(const char* name) {
  TransferFunction f = glossy(name);
  f.ambient = 1, f.diffuse = 0, f.specular = 0, f.specular_power = 1;
  return f;
}

/// Contrast medium in the aorta, and bone.
TransferFunction ct_aaa() {
  TransferFunction f = glossy("CT-AAA");
  f.opacity = {{144, 0}, {166, 0.69}, {214, 0.7}, {420, 0.83}, {3071, 0.8}};
  f.colour = {{144, {0.62, 0.36, 0.18}},
              {166, {0.88, 0.6, 0.29}},
              {214, {1, 1, 1}},
              {420, {1, 0.94, 0.95}},
              {3071, {0.83, 0.66, 1}}};
  return f;
}

/// The same in more colours.
TransferFunction ct_aaa2() {
  TransferFunction f = glossy("CT-AAA2");
  f.opacity = {{130, 0}, {145, 0.17}, {157, 0.5}, {170, 0.63}, {396, 0.81}};
  f.colour = {{130, {0.55, 0.25, 0.15}}, {145, {0.6, 0.63, 0.84}}, {157, {0.89, 0.47, 0.6}},
              {170, {0.99, 0.87, 0.39}}, {396, {1, 0.89, 0.66}},   {1580, {1, 0.83, 0.96}},
              {3071, {0.83, 0.66, 1}}};
  return f;
}

/// Air, bright against the background; clips take away what lies around the body.
TransferFunction ct_air() {
  TransferFunction f = glossy("CT-Air");
  f.opacity = {{-3024, 0.71}, {-900, 0.72}, {-500, 0}};
  f.colour = {{-3024, {1, 1, 1}}, {-900, {0.2, 1, 1}}, {-500, {0.3, 0.3, 1}}, {3071, {0, 0, 0}}};
  return f;
}

/// Muscle and skin dark red and translucent, bone pale.
TransferFunction ct_bone() {
  TransferFunction f = glossy("CT-Bone");
  f.opacity = {{-16, 0}, {641, 0.72}, {3071, 0.71}};
  f.colour = {{-16, {0.73, 0.25, 0.3}}, {641, {0.91, 0.82, 0.55}}, {3071, {1, 1, 1}}};
  return f;
}

/// Translucent: cartilage and thin bone red, dense bone yellow.
TransferFunction ct_bones() {
  TransferFunction f = matte("CT-Bones");
  f.opacity = {{152, 0}, {279, 0.19}, {952, 0.2}};
  f.colour = {
      {152, {0.51, 0.67, 0.1}}, {463, {1, 0, 0}}, {659, {1, 0.91, 0.04}}, {953, {1, 0.3, 0.3}}};
  return f;
}

/// Muscle brown, contrast medium and bone red.
TransferFunction ct_cardiac() {
  TransferFunction f = glossy("CT-Cardiac");
  f.opacity = {{-78, 0}, {95, 0.29}, {179, 0.55}, {260, 0.85}, {3071, 0.88}};
  f.colour = {{-78, {0.55, 0.25, 0.15}},
              {95, {0.88, 0.6, 0.29}},
              {179, {1, 0.94, 0.95}},
              {260, {0.62, 0, 0}},
              {3071, {0.83, 0.66, 1}}};
  return f;
}

/// Contrast medium and bone from brown to white.
TransferFunction ct_cardiac2() {
  TransferFunction f = glossy("CT-Cardiac2");
  f.opacity = {{43, 0}, {163, 0.43}, {278, 0.78}, {1587, 0.75}};
  f.colour = {{43, {0.55, 0.25, 0.15}},
              {163, {0.92, 0.64, 0.06}},
              {278, {1, 0.88, 0.62}},
              {1587, {1, 1, 1}},
              {3071, {0.83, 0.66, 1}}};
  return f;
}

/// Fat blue, muscle red, contrast medium pale, bone yellow.
TransferFunction ct_cardiac3() {
  TransferFunction f = glossy("CT-Cardiac3");
  f.opacity = {{-87, 0}, {45, 0.17}, {140, 0.59}, {348, 0.61}, {3071, 0.62}};
  f.colour = {{-87, {0, 0.25, 1}}, {45, {1, 0, 0}},   {140, {1, 0.89, 0.89}},
              {348, {1, 1, 0.25}}, {1224, {1, 1, 1}}, {3071, {0.83, 0.66, 1}}};
  return f;
}

/// Vessels with contrast medium brown, bone white.
TransferFunction ct_chest_contrast_enhanced() {
  TransferFunction f = glossy("CT-Chest-Contrast-Enhanced");
  f.opacity = {{67, 0}, {251, 0.45}, {439, 0.63}, {3071, 0.62}};
  f.colour = {{67, {0.55, 0.25, 0.15}},
              {251, {0.88, 0.6, 0.29}},
              {439, {1, 0.94, 0.95}},
              {3071, {0.83, 0.66, 1}}};
  return f;
}

/// Everything but air, lungs as a veil; for volumes cut by clips.
TransferFunction ct_chest_vessels() {
  TransferFunction f = matte("CT-Chest-Vessels");
  f.opacity = {{-1278, 0}, {23, 0.43}, {439, 0.63}, {3071, 0.62}};
  f.colour = {{-1278, {0.55, 0.25, 0.15}},
              {23, {0.88, 0.6, 0.29}},
              {439, {1, 0.94, 0.95}},
              {3071, {0.83, 0.66, 1}}};
  return f;
}

/// Contrast medium and bone in greys, without light.
TransferFunction ct_coronary_arteries() {
  TransferFunction f = unlit("CT-Coronary-Arteries");
  f.opacity = {{136, 0}, {159, 0.26}, {318, 0.57}, {479, 0.78}, {3661, 1}};
  f.colour = {
      {136, {0, 0, 0}}, {159, {0.16, 0.16, 0.16}}, {318, {0.76, 0.76, 0.76}}, {479, {1, 1, 1}}};
  return f;
}

/// The same from red to white.
TransferFunction ct_coronary_arteries_2() {
  TransferFunction f = matte("CT-Coronary-Arteries-2");
  f.opacity = {{143, 0}, {145, 0.12}, {192, 0.56}, {217, 0.78}, {384, 0.83}};
  f.colour = {{143, {0.3, 0, 0.01}},     {145, {0.62, 0, 0.02}}, {192, {0.91, 0.45, 0}},
              {217, {0.97, 0.81, 0.61}}, {384, {0.91, 0.91, 1}}, {3661, {1, 1, 1}}};
  return f;
}

/// The same, more opaque.
TransferFunction ct_coronary_arteries_3() {
  TransferFunction f = glossy("CT-Coronary-Arteries-3");
  f.opacity = {{129, 0}, {130, 0.1}, {174, 0.67}, {256, 0.86}, {585, 0.87}, {3661, 1}};
  f.colour = {{129, {0.3, 0, 0.01}},     {130, {0.62, 0, 0.02}},    {174, {0.91, 0.45, 0}},
              {256, {0.89, 0.89, 0.89}}, {585, {0.97, 0.97, 0.97}}, {3661, {1, 1, 1}}};
  return f;
}

/// Opaque greys from air to bone, without light: faces of clips are slices in a bone window.
TransferFunction ct_cropped_volume_bone() {
  TransferFunction f = unlit("CT-Cropped-Volume-Bone");
  f.opacity = {{-451, 0}, {-450, 1}};
  f.colour = {{-450, {0.06, 0.06, 0.06}}, {1050, {1, 1, 1}}};
  return f;
}

/// Fat alone, from blue to yellow, without light; skin borders on air there, too.
TransferFunction ct_fat() {
  TransferFunction f = unlit("CT-Fat");
  f.opacity = {{-100, 0}, {-99, 0.15}, {-60, 0.15}, {-59, 0}};
  f.colour = {{-99, {0, 0, 1}}, {-77, {0, 1, 0}}, {-65, {0.84, 0.89, 0.02}}, {84, {1, 0, 0}}};
  return f;
}

/// Vessels with contrast medium brown, bone white, without light.
TransferFunction ct_liver_vasculature() {
  TransferFunction f = unlit("CT-Liver-Vasculature");
  f.opacity = {{149, 0}, {158, 0.48}, {340, 0.66}, {389, 0.83}, {1198, 0.84}};
  f.colour = {{149, {0.3, 0.15, 0}},
              {158, {0.5, 0.25, 0}},
              {340, {0.7, 0.6, 0.37}},
              {389, {0.85, 0.85, 0.83}},
              {1198, {1, 1, 1}}};
  return f;
}

/// Lung, and whatever else lies between air and water, such as the surface of the skin.
TransferFunction ct_lung() {
  TransferFunction f = matte("CT-Lung");
  f.opacity = {{-600, 0}, {-599, 0.15}, {-400, 0.15}, {-399, 0}};
  f.colour = {{-600, {0, 0, 1}},
              {-530, {0.13, 0.78, 0.07}},
              {-460, {0.93, 1, 0.11}},
              {-400, {0.89, 0.25, 0.02}}};
  return f;
}

/// The window of a bone scan's projection; air stays transparent.
TransferFunction ct_mip() {
  TransferFunction f;
  f.name = "CT-MIP";
  f.blend = Blend::maximum;
  f.background = "black";
  f.opacity = {{-640, 0}, {700, 1}};
  f.colour = {{-640, {1, 1, 1}}};
  return f;
}

/// Fat and skin brown and translucent, muscle lighter, bone white.
TransferFunction ct_muscle() {
  TransferFunction f = glossy("CT-Muscle");
  f.opacity = {{-155, 0}, {218, 0.68}, {420, 0.83}, {3071, 0.8}};
  f.colour = {{-155, {0.55, 0.25, 0.15}},
              {218, {0.88, 0.6, 0.29}},
              {420, {1, 0.94, 0.95}},
              {3071, {0.83, 0.66, 1}}};
  return f;
}

/// Vessels of the lung red, bone grey.
TransferFunction ct_pulmonary_arteries() {
  TransferFunction f = matte("CT-Pulmonary-Arteries");
  f.opacity = {{-569, 0}, {-364, 0.07}, {-245, 0.4}, {18, 0.61}, {448, 0.83}, {3593, 0.84}};
  f.colour = {{-569, {0.2, 0.15, 0.09}}, {-364, {0.4, 0.3, 0.18}},  {-245, {0.61, 0.35, 0.07}},
              {18, {0.84, 0.02, 0.16}},  {448, {0.75, 0.75, 0.75}}, {3593, {1, 1, 1}}};
  return f;
}

/// Opaque greys from fat to muscle, without light: faces of clips are slices in a soft tissue
/// window.
TransferFunction ct_soft_tissue() {
  TransferFunction f = unlit("CT-Soft-Tissue");
  f.opacity = {{-167, 0}, {-160, 1}};
  f.colour = {{-160, {0.06, 0.06, 0.06}}, {240, {1, 1, 1}}};
  return f;
}

/// A radiograph: rays are dimmed by what is denser than air, white, without light.
TransferFunction ct_x_ray() {
  TransferFunction f = unlit("CT-X-ray");
  f.opacity = {{-200, 0}, {1500, 0.05}};
  f.colour = {{-200, {1, 1, 1}}};
  f.background = "black";
  return f;
}

}  // namespace

const std::vector<NamedPreset>& ct_presets() {
  static const std::vector<NamedPreset> presets = {
      {"CT-AAA", ct_aaa},
      {"CT-AAA2", ct_aaa2},
      {"CT-Air", ct_air},
      {"CT-Bone", ct_bone},
      {"CT-Bones", ct_bones},
      {"CT-Cardiac", ct_cardiac},
      {"CT-Cardiac2", ct_cardiac2},
      {"CT-Cardiac3", ct_cardiac3},
      {"CT-Chest-Contrast-Enhanced", ct_chest_contrast_enhanced},
      {"CT-Chest-Vessels", ct_chest_vessels},
      {"CT-Coronary-Arteries", ct_coronary_arteries},
      {"CT-Coronary-Arteries-2", ct_coronary_arteries_2},
      {"CT-Coronary-Arteries-3", ct_coronary_arteries_3},
      {"CT-Cropped-Volume-Bone", ct_cropped_volume_bone},
      {"CT-Fat", ct_fat},
      {"CT-Liver-Vasculature", ct_liver_vasculature},
      {"CT-Lung", ct_lung},
      {"CT-MIP", ct_mip},
      {"CT-Muscle", ct_muscle},
      {"CT-Pulmonary-Arteries", ct_pulmonary_arteries},
      {"CT-Soft-Tissue", ct_soft_tissue},
      {"CT-X-ray", ct_x_ray}};
  return presets;
}

}  // namespace supple
