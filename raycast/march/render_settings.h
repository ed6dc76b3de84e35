// Light on a picture, and how it is marched.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "raycast/scene/clip.h"
#include "raycast/scene/transfer_function.h"
#include "volumes/base/vec.h"

namespace supple {

enum class ShadingModel { none, phong, blinn };

struct Light {
  Vec3d direction{-0.25, 0.35, 1};  // towards the light, any length but 0
  bool is_of_camera = true;         // direction is right, up, towards the viewer; else LPS
  std::array<double, 3> rgb{1, 1, 1};
  double intensity = 1;

  /// Throws InputError: a direction that is not finite or 0, rgb outside 0…1, intensity outside
  /// 0…100.
  void validate(const std::string& file) const;
};

struct Lighting {
  static constexpr int kMaxLights = 8;

  ShadingModel model = ShadingModel::blinn;
  std::vector<Light> lights;  // empty: one as a Light is by default, above and left of the camera
  bool shadows = false;       // of the volume and the meshes on both
  double occlusion_radius_mm = 0;  // of ambient occlusion; 0: none
  double exposure_stops = 0;       // all that is drawn, in 2^stops times as much light
  /// Shadows and occlusion are interpolated on a lattice so many mm apart; 0: each sample has its
  /// own.
  double volume_mm = 0;

  bool has_paths() const { return shadows || occlusion_radius_mm > 0; }
  /// Throws InputError: more than kMaxLights, a bad light, an occlusion radius outside 0…1000, a
  /// lattice of light outside 0…1000, an exposure outside -20…20.
  void validate(const std::string& file) const;
};

/// Trade of the time that a picture takes for accuracy (docs/pictures.md).
enum class Quality { draft, standard, accurate };

/// "draft", "default", "accurate". Throws InputError listing them.
Quality parse_quality(const std::string& name);

/// Samples of a ray per voxel of the smallest spacing.
constexpr int samples_per_voxel(Quality quality) {
  return quality == Quality::draft ? 2 : quality == Quality::accurate ? 5 : 3;
}

/// The points where densities become colours: samples, or the way between two of them.
enum class Classification { post, pre_integrated };

struct RenderSettings {
  int width = 1024;
  int height = 1024;
  double step_voxels = 1.0 / samples_per_voxel(Quality::standard);  // of the smallest spacing
  /// Steps taken at once while transparent; 1 switches it off.
  int stride = samples_per_voxel(Quality::standard);
  Classification classification = Classification::post;
  bool jitter = false;  // begins each ray elsewhere within a step: fine noise instead of rings
  Lighting lighting;
  bool transform_gradient = true;   // the (I + grad o)^T term; off only to show its effect
  bool skip_empty_space = true;     // leaves out bricks known to be transparent; same picture
  double early_termination = 0.99;  // accumulated opacity that ends a ray
  std::vector<Clip> clips;          // a visible place lies in all of them
  bool auxiliary = false;           // depth, normal and offset beside the colours
  bool tells_surfaces = false;      // which surface is seen, beside the auxiliary channels
  bool clip_surfaces = false;       // clips of the deformed space cut surfaces, too

  /// Sets step_voxels and stride.
  void set_quality(Quality quality);

  /// Sets step_voxels, and a stride that still looks once in a voxel, or at every step of a longer
  /// one.
  void set_step(double voxels);

  /// Throws InputError: sizes < 1 or > 16384, step outside 0.01…16, stride outside 1…16,
  /// early_termination outside (0, 1], a bad clip or light.
  void validate() const;
  /// Checks the settings with the function of the picture. Throws InputError: gradient opacity
  /// along the way between samples.
  void validate_with(const TransferFunction& function) const;
};

}  // namespace supple
