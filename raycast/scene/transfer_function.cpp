#include "raycast/scene/transfer_function.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/error.h"

namespace supple {

namespace {

double value_of(const OpacityKey& key) {
  return key.opacity;
}
std::array<double, 3> value_of(const ColourKey& key) {
  return key.rgb;
}

double mix(double a, double b, double t) {
  return a + (b - a) * t;
}
std::array<double, 3> mix(const std::array<double, 3>& a, const std::array<double, 3>& b,
                          double t) {
  return {mix(a[0], b[0], t), mix(a[1], b[1], t), mix(a[2], b[2], t)};
}

/// Linear between the key points, constant beyond them.
template <class Key>
auto interpolate(const std::vector<Key>& keys, double density) {
  const auto above = std::upper_bound(keys.begin(), keys.end(), density,
                                      [](double d, const Key& key) { return d < key.density; });
  if (above == keys.begin()) return value_of(keys.front());
  if (above == keys.end()) return value_of(keys.back());
  const Key& below = *(above - 1);
  const double t = (density - below.density) / (above->density - below.density);
  return mix(value_of(below), value_of(*above), t);
}

/// Names one key point, e.g. "opacity[2]".
class KeyChecker {
 public:
  KeyChecker(const std::string& file, const std::string& table) : m_file(file), m_table(table) {}

  void require_some(std::size_t count) const {
    if (count == 0) throw InputError({m_file, m_table, "no key points", "at least one"});
  }
  void check_density(std::size_t n, double density, double previous) const {
    if (!std::isfinite(density) || !(density > previous)) {
      fail(n, "density " + std::to_string(density), "finite densities in ascending order");
    }
  }
  void check_unit(std::size_t n, const char* what, double value) const {
    if (!(value >= 0 && value <= 1)) {
      fail(n, what + (" " + std::to_string(value)), "a value between 0 and 1");
    }
  }

 private:
  [[noreturn]] void fail(std::size_t n, const std::string& found,
                         const std::string& expected) const {
    throw InputError({m_file, m_table + "[" + std::to_string(n) + "]", found, expected});
  }
  std::string m_file, m_table;
};

void check_opacities(const KeyChecker& checker, const std::vector<OpacityKey>& keys) {
  for (std::size_t n = 0; n < keys.size(); ++n) {
    checker.check_density(n, keys[n].density, n == 0 ? -HUGE_VAL : keys[n - 1].density);
    checker.check_unit(n, "opacity", keys[n].opacity);
  }
}

}  // namespace

double TransferFunction::opacity_at(double density) const {
  return interpolate(opacity, density);
}

std::array<double, 3> TransferFunction::colour_at(double density) const {
  return interpolate(colour, density);
}

double TransferFunction::gradient_opacity_at(double gradient_per_mm) const {
  return gradient_opacity.empty() ? 1.0 : interpolate(gradient_opacity, gradient_per_mm);
}

void TransferFunction::validate(const std::string& file) const {
  const KeyChecker opacities(file, "opacity"), colours(file, "colour");
  opacities.require_some(opacity.size());
  check_opacities(opacities, opacity);
  colours.require_some(colour.size());
  for (std::size_t n = 0; n < colour.size(); ++n) {
    colours.check_density(n, colour[n].density, n == 0 ? -HUGE_VAL : colour[n - 1].density);
    for (const double channel : colour[n].rgb) colours.check_unit(n, "colour", channel);
  }
  check_opacities(KeyChecker(file, "gradient_opacity"), gradient_opacity);

  require(unit_distance_mm > 0 && std::isfinite(unit_distance_mm), "unit_distance",
          unit_distance_mm, "more than 0 mm", file);
  require(full_shading_gradient >= 0 && std::isfinite(full_shading_gradient),
          "full_shading_gradient", full_shading_gradient, "0 or more, in density per mm", file);
  require(ambient >= 0 && ambient <= 1, "ambient", ambient, "a value between 0 and 1", file);
  require(diffuse >= 0 && diffuse <= 1, "diffuse", diffuse, "a value between 0 and 1", file);
  require(specular >= 0 && specular <= 1, "specular", specular, "a value between 0 and 1", file);
  require(specular_power >= 1 && specular_power <= 1000, "specular_power", specular_power,
          "a value between 1 and 1000", file);
}

}  // namespace supple
