#include "raycast/march/shading.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr double kMostTrust = 1e30;  // for each density per mm; finite, so that 0 stays 0

Vec3f world_direction(const Light& light, const CameraFrame& frame) {
  if (!light.is_of_camera) return Vec3f(light.direction.normalized());
  const Vec3d& d = light.direction;
  return Vec3f((frame.up * d.y + frame.right * d.x - frame.forward * d.z).normalized());
}

}  // namespace

void Light::validate(const std::string& file) const {
  const double length = direction.length();
  if (!(length > 0 && std::isfinite(length))) {
    throw InputError({file, "light", "a direction of length " + number_text(length),
                      "a finite vector that is not 0"});
  }
  for (const double channel : rgb) {
    require(channel >= 0 && channel <= 1, "light.colour", channel, "a value between 0 and 1", file);
  }
  require(intensity >= 0 && intensity <= 100, "light.intensity", intensity, "0 to 100", file);
}

void Lighting::validate(const std::string& file) const {
  if (lights.size() > std::size_t(kMaxLights)) {
    throw InputError({file, "light", std::to_string(lights.size()) + " lights",
                      "at most " + std::to_string(kMaxLights)});
  }
  for (const Light& light : lights) light.validate(file);
  require(occlusion_radius_mm >= 0 && occlusion_radius_mm <= 1000, "ambient_occlusion",
          occlusion_radius_mm, "a radius of 0 to 1000 mm", file);
  require(volume_mm >= 0 && volume_mm <= 1000, "light_volume", volume_mm,
          "a spacing of 0 to 1000 mm", file);
  require(std::abs(exposure_stops) <= 20, "exposure", exposure_stops, "-20 to 20 stops", file);
}

Shading::Shading(const Camera& camera, const TransferFunction& function, const Lighting& lighting)
    : m_model(lighting.model),
      m_ambient(float(function.ambient)),
      m_specular_power(float(function.specular_power)),
      m_trust_per_gradient(float(std::min(1 / function.full_shading_gradient, kMostTrust))) {
  const CameraFrame frame = camera_frame(camera);
  std::vector<Light> lights = lighting.lights;
  if (lights.empty()) lights.emplace_back();
  for (const Light& light : lights) {
    FarLight& far = m_lights[m_light_count++];
    far.towards = world_direction(light, frame);
    far.diffuse = far.specular = Float4{0, 0, 0, 0};
    for (int c = 0; c < 3; ++c) {
      const double rgb = light.rgb[c] * light.intensity;
      far.diffuse[c] = float(function.diffuse * rgb);
      far.specular[c] = float(function.specular * rgb);
    }
  }
}

Shading::View Shading::view(const Ray& ray) const {
  View view;
  view.towards_eye = Vec3f(-ray.direction_lps);
  for (int n = 0; n < light_count(); ++n) {
    view.half[n] = (view.towards_eye + m_lights[n].towards).normalized();
  }
  return view;
}

}  // namespace supple
