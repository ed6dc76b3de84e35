// Colours of a packet of rays: surfaces from the nearest to the first opaque one, the lamp's light
// on each with its shadows, and balls between them.
#pragma once

#include <array>
#include <vector>

#include "raycast/microscope/eye_lanes.h"
#include "raycast/microscope/layer_lanes.h"
#include "raycast/microscope/packet.h"
#include "raycast/microscope/shape_scene.h"

namespace supple {

/// A translucent ball, which needs no light.
struct BallFloats {
  Vec3f centre;
  float radius;
  Vec3f colour;  // linear
  float opacity;
};

/// Samples of shadows over the lamp's disc.
struct LampDisc {
  static constexpr int kTurns = 64;
  int samples = 1;
  Vec3f across{0, 0, 0}, aside{0, 0, 0};             // radii
  std::array<std::array<float, 2>, kTurns> turns{};  // cosines and sines
};
LampDisc lamp_disc(const Vec3d& direction, double radius_mm, int samples);

/// Everything that all rays of a picture share.
struct EyeScene {
  LensFloats lens;
  const GlobeFloats* globe = nullptr;
  const ShapeScene* shapes = nullptr;
  const std::vector<SurfaceFloats>* surfaces = nullptr;  // of each shape
  std::vector<BallFloats> balls;                         // the nearest to the camera first
  LampFloats lamp;
  LampDisc disc;
};

/// A thread's own.
struct ShaderRoom {
  TriangleRoom seen, shading;
  bool is_timed = false;
  double shadow_ms = 0, whole_ms = 0;  // of packets that were timed
};

/// Shades the rays through pixel coordinates, which may meet the listed triangles.
void shade_packet(const EyeScene& scene, const LaneFloats& x, const LaneFloats& y,
                  const TriangleList& list, ShaderRoom& room, PacketPicture& picture);

}  // namespace supple
