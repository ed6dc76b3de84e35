#include "raycast/shading.h"

#include <algorithm>
#include <cmath>

namespace supple {

namespace {

/// The light stands this far above and to the left of the camera, per unit of view direction:
/// enough for relief, near enough to a headlight to leave no dark side.
constexpr double kLightUp = 0.35, kLightLeft = 0.25;

Vec3f light_of(const Camera& camera) {
  const CameraFrame frame = camera_frame(camera);
  return Vec3f((frame.up * kLightUp - frame.right * kLightLeft - frame.forward).normalized());
}

}  // namespace

Vec3f facing_normal(const LitSample& sample, const Vec3f& towards_eye) {
  if (!(sample.magnitude > 0) && sample.face_share == 0) return towards_eye;
  Vec3f normal = sample.magnitude > 0 ? sample.gradient / sample.magnitude : sample.face;
  if (normal.dot(towards_eye) < 0) normal = -normal;
  if (sample.face_share == 0) return normal;
  return (normal * (1 - sample.face_share) + sample.face * sample.face_share).normalized();
}

Shading::Shading(const Camera& camera, const TransferFunction& function)
    : m_light(light_of(camera)),
      m_ambient(float(function.ambient)),
      m_diffuse(float(function.diffuse)),
      m_specular(float(function.specular)),
      m_specular_power(float(function.specular_power)),
      m_facing(float(function.ambient + function.diffuse)),
      m_full_gradient(float(function.full_shading_gradient)) {}

Shading::View Shading::view(const Ray& ray) const {
  const Vec3f towards_eye(-ray.direction_lps);
  return {towards_eye, (towards_eye + m_light).normalized()};
}

Float4 Shading::shaded(const LitSample& sample, const View& view) const {
  const float magnitude = sample.magnitude, face_share = sample.face_share;
  if (!(magnitude > 0) && face_share == 0) return sample.colour * m_facing;
  const Vec3f normal = facing_normal(sample, view.towards_eye);
  float trust = magnitude < m_full_gradient ? magnitude / m_full_gradient : 1.0f;
  trust += face_share * (1 - trust);
  const float diffuse = 1 - trust + trust * std::max(normal.dot(m_light), 0.0f);
  const float highlight = trust * std::max(normal.dot(view.half), 0.0f);
  const float specular = m_specular * std::pow(highlight, m_specular_power);
  return sample.colour * (m_ambient + m_diffuse * diffuse) + specular;
}

}  // namespace supple
