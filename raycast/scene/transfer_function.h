// Density to colour and opacity, looked up after interpolation (post-classified), and presets: our
// own and those of 3D Slicer.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace supple {

struct OpacityKey {
  double density;
  double opacity;  // per unit_distance_mm (maximum: of the ray), 0…1
};
struct ColourKey {
  double density;
  std::array<double, 3> rgb;  // 0…1, sRGB
};

/// composite: front to back; maximum: the largest density of a ray, which is looked up as it is
/// (maximum-intensity projection).
enum class Blend { composite, maximum };

struct TransferFunction {
  std::string name;
  Blend blend = Blend::composite;
  std::vector<OpacityKey> opacity;  // ascending; constant beyond the ends
  std::vector<ColourKey> colour;
  std::vector<OpacityKey> gradient_opacity;  // density per mm; empty: 1 everywhere
  double unit_distance_mm = 1.0;             // distance over which `opacity` is reached
  /// Density per mm from which a gradient is trusted as a normal. Weaker ones, as on the ridge
  /// inside a thin sheet, point anywhere; shading fades to facing the light, or samples that happen
  /// to fall there show as dark lines. 0 trusts all.
  double full_shading_gradient = 0;
  /// Background of pictures that ask for none: a name of parse_background(); empty: transparent.
  std::string background;
  double ambient = 0.2, diffuse = 0.9, specular = 0.2, specular_power = 10;

  double opacity_at(double density) const;
  std::array<double, 3> colour_at(double density) const;
  double gradient_opacity_at(double gradient_per_mm) const;
  /// Throws InputError naming the key point.
  void validate(const std::string& file) const;
};

/// "Bone", "CT-Bone" and the others of preset_names(). Throws InputError listing the names.
TransferFunction preset(const std::string& name);
std::vector<std::string> preset_names();  // sorted

}  // namespace supple
