// Light on one place of a picture: Blinn-Phong with two-sided normals (J. F. Blinn, Models of light
// reflection for computer synthesized pictures, SIGGRAPH 1977).
#pragma once

#include "raycast/camera.h"
#include "raycast/offset_bricks.h"
#include "raycast/transfer_function.h"

namespace supple {

/// A place to be lit. Its normal is the direction of the gradient, fading to that of a face where
/// one is near; either may point to any side.
struct LitSample {
  Float4 colour{0, 0, 0, 0};  // its first three
  Vec3f gradient{0, 0, 0};    // density per mm, LPS
  float magnitude = 0;        // of the gradient
  Vec3f face{0, 0, 0};        // unit, LPS
  float face_share = 0;       // 1: the place lies at the face
};

/// The unit normal that a place is lit by, towards the eye; without gradient and face the direction
/// to the eye itself.
Vec3f facing_normal(const LitSample& sample, const Vec3f& towards_eye);

/// The light of a picture.
class Shading {
 public:
  Shading(const Camera& camera, const TransferFunction& function);

  /// Of the ray under way: what depends on its direction alone.
  struct View {
    Vec3f towards_eye;
    Vec3f half;  // between the eye and the light
  };
  View view(const Ray& ray) const;

  /// A place without gradient and face counts as facing the light.
  Float4 shaded(const LitSample& sample, const View& view) const;

 private:
  Vec3f m_light;  // towards the light: above and left of the camera
  float m_ambient, m_diffuse, m_specular, m_specular_power;
  float m_facing;  // of a place that counts as facing the light
  float m_full_gradient;
};

}  // namespace supple
