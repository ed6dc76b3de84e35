// Light on one place of a picture: Blinn-Phong or Phong with two-sided normals (B. T. Phong,
// Illumination for computer generated pictures, CACM 18(6), 1975; J. F. Blinn, Models of light
// reflection for computer synthesized pictures, SIGGRAPH 1977). Lights are far away and add up.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "raycast/camera.h"
#include "raycast/offset_bricks.h"
#include "raycast/transfer_function.h"

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

  bool has_paths() const { return shadows || occlusion_radius_mm > 0; }
  /// Throws InputError: more than kMaxLights, a bad light, an occlusion radius outside 0…1000.
  void validate(const std::string& file) const;
};

/// How a place lies to the light: a unit normal on the viewer's side and the share, 0…1, in which
/// it counts; the rest counts as facing every light.
struct Facing {
  Vec3f normal{0, 0, 0};
  float trust = 0;
};

/// What of each light reaches a place, and of the light from all around, 0…1.
struct Reach {
  std::array<float, Lighting::kMaxLights> lights;
  float openness = 1;
  Reach() { lights.fill(1); }
};

class Shading {
 public:
  Shading(const Camera& camera, const TransferFunction& function, const Lighting& lighting);

  /// Of the ray under way: what depends on its direction alone.
  struct View {
    Vec3f towards_eye;
    std::array<Vec3f, Lighting::kMaxLights> half;  // between the eye and each light
  };
  View view(const Ray& ray) const;

  /// Of a sample with a gradient (density per mm, LPS) and its length, near a face (unit normal
  /// towards the viewer) with that share; 1: the sample lies at the face.
  Facing facing(const Vec3f& gradient, float magnitude, const Vec3f& face, float face_share,
                const View& view) const;

  /// `reach` null: all light reaches the place.
  Float4 shaded(const Float4& colour, const Facing& facing, const View& view,
                const Reach* reach = nullptr) const;

  int light_count() const { return m_light_count; }
  /// Unit, towards the light, LPS.
  const Vec3f& towards_light(int n) const { return m_lights[n].towards; }

 private:
  struct FarLight {
    Vec3f towards;
    Float4 rgb;
  };
  float highlight(const Facing& facing, const View& view, int n) const;

  ShadingModel m_model;
  std::array<FarLight, Lighting::kMaxLights> m_lights;
  int m_light_count = 0;
  float m_ambient, m_diffuse, m_specular, m_specular_power;
  float m_full_gradient;
};

// Inline: once per visible sample.

inline Facing Shading::facing(const Vec3f& gradient, float magnitude, const Vec3f& face,
                              float face_share, const View& view) const {
  if (!(magnitude > 0) && face_share == 0) return {view.towards_eye, 0};
  Facing facing;
  facing.normal = magnitude > 0 ? gradient / magnitude : face;
  if (facing.normal.dot(view.towards_eye) < 0) facing.normal = -facing.normal;
  facing.trust = magnitude < m_full_gradient ? magnitude / m_full_gradient : 1.0f;
  if (face_share > 0) {
    facing.normal = (facing.normal * (1 - face_share) + face * face_share).normalized();
    facing.trust += face_share * (1 - facing.trust);
  }
  return facing;
}

/// Cosine between the normal and the half vector, or between the reflected light and the eye.
inline float Shading::highlight(const Facing& facing, const View& view, int n) const {
  if (m_model == ShadingModel::blinn) return std::max(facing.normal.dot(view.half[n]), 0.0f);
  const Vec3f& towards = m_lights[n].towards;
  const float cosine = facing.normal.dot(towards);
  if (cosine <= 0) return 0;
  return std::max((facing.normal * (2 * cosine) - towards).dot(view.towards_eye), 0.0f);
}

inline Float4 Shading::shaded(const Float4& colour, const Facing& facing, const View& view,
                              const Reach* reach) const {
  Float4 diffuse{0, 0, 0, 0}, specular{0, 0, 0, 0};
  for (int n = 0; n < m_light_count; ++n) {
    const float cosine = facing.normal.dot(m_lights[n].towards);
    const float lobe = facing.trust * highlight(facing, view, n);
    const float lit = 1 - facing.trust + (cosine > 0 ? facing.trust * cosine : 0);
    const float shine = m_specular * std::pow(lobe, m_specular_power);
    const Float4 rgb = reach != nullptr ? m_lights[n].rgb * reach->lights[n] : m_lights[n].rgb;
    diffuse += rgb * lit;
    specular += rgb * shine;
  }
  const Float4 light = colour * (m_ambient + m_diffuse * diffuse) + specular;
  return reach != nullptr ? light * reach->openness : light;
}

}  // namespace supple
