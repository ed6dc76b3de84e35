// Light on one place of a picture: Blinn-Phong or Phong with two-sided normals (B. T. Phong,
// Illumination for computer generated pictures, CACM 18(6), 1975; J. F. Blinn, Models of light
// reflection for computer synthesized pictures, SIGGRAPH 1977). Lights are far away and add up.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "raycast/march/render_settings.h"
#include "raycast/sample/offset_bricks.h"
#include "raycast/scene/camera.h"
#include "raycast/scene/transfer_function.h"

namespace supple {

/// Orientation of a place to the light: a unit normal on the viewer's side and the share, 0…1, in
/// which it counts; the rest counts as facing every light.
struct Facing {
  Vec3f normal{0, 0, 0};
  float trust = 0;
};

/// Terms of a light at a place, 0…1, without its colour and shadows: diffuse, and its highlight.
struct LightTerms {
  float diffuse, specular;
};

/// Share of each light, and of the light from all around, that reaches a place, 0…1.
struct LightReached {
  std::array<float, Lighting::kMaxLights> lights;
  float openness = 1;
  LightReached() { lights.fill(1); }
};

class Shading {
 public:
  Shading(const Camera& camera, const TransferFunction& function, const Lighting& lighting);

  /// Data of the ray under way that depend on its direction alone.
  struct View {
    Vec3f towards_eye;
    std::array<Vec3f, Lighting::kMaxLights> half;  // between the eye and each light
  };
  View view(const Ray& ray) const;

  /// Colour of a place of which the terms of light n are terms_of(n). `light_reached` null: all
  /// light reaches it.
  template <class TermsOf>
  Float4 lit(const Float4& colour, const TermsOf& terms_of,
             const LightReached* light_reached) const;
  Float4 shaded(const Float4& colour, const Facing& facing, const View& view,
                const LightReached* light_reached) const;

  ShadingModel model() const { return m_model; }
  float specular_power() const { return m_specular_power; }
  /// Facing::trust of a gradient of one density per mm, were it not at most 1.
  float trust_per_gradient() const { return m_trust_per_gradient; }
  int light_count() const { return m_light_count; }
  /// Unit vector towards the light, LPS.
  const Vec3f& towards_light(int n) const { return m_lights[n].towards; }

 private:
  struct FarLight {
    Vec3f towards;
    Float4 diffuse, specular;  // rgb
  };
  float highlight(const Facing& facing, const View& view, int n) const;

  ShadingModel m_model;
  std::array<FarLight, Lighting::kMaxLights> m_lights;
  int m_light_count = 0;
  float m_ambient, m_specular_power, m_trust_per_gradient;
};

// These are inline, as they run once per visible sample.

/// Cosine between the normal and the half vector, or between the reflected light and the eye.
inline float Shading::highlight(const Facing& facing, const View& view, int n) const {
  if (m_model == ShadingModel::blinn) return std::max(facing.normal.dot(view.half[n]), 0.0f);
  const Vec3f& towards = m_lights[n].towards;
  const float cosine = facing.normal.dot(towards);
  if (cosine <= 0) return 0;
  return std::max((facing.normal * (2 * cosine) - towards).dot(view.towards_eye), 0.0f);
}

template <class TermsOf>
Float4 Shading::lit(const Float4& colour, const TermsOf& terms_of,
                    const LightReached* light_reached) const {
  Float4 diffuse{m_ambient, m_ambient, m_ambient, m_ambient}, specular{0, 0, 0, 0};
  for (int n = 0; n < m_light_count; ++n) {
    LightTerms terms = terms_of(n);
    if (light_reached != nullptr)
      terms.diffuse *= light_reached->lights[n], terms.specular *= light_reached->lights[n];
    diffuse += m_lights[n].diffuse * terms.diffuse;
    specular += m_lights[n].specular * terms.specular;
  }
  const Float4 light = colour * diffuse + specular;
  return light_reached != nullptr ? light * light_reached->openness : light;
}

inline Float4 Shading::shaded(const Float4& colour, const Facing& facing, const View& view,
                              const LightReached* light_reached) const {
  const auto terms_of = [&](int n) -> LightTerms {
    const float cosine = facing.normal.dot(m_lights[n].towards);
    const float lobe = facing.trust * highlight(facing, view, n);
    return {1 - facing.trust + (cosine > 0 ? facing.trust * cosine : 0),
            std::pow(lobe, m_specular_power)};
  };
  return lit(colour, terms_of, light_reached);
}

}  // namespace supple
