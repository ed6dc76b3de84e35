// Colours of a packet of rays: surfaces from the nearest to the first opaque one, the lamp's light
// on each with its shadows, and balls between them.
#pragma once

#include <array>
#include <vector>

#include "raycast/microscope/eye_lanes.h"
#include "raycast/microscope/packet.h"
#include "raycast/microscope/shape_scene.h"

namespace supple {

/// A shape's surface, linear.
struct SurfaceFloats {
  Vec3f colour;
  float opacity, specular, shininess;
  float lift_mm;  // of shadow rays
};

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

struct PacketPicture {
  PacketColours colour;                // linear, of surfaces and what lies behind the first of them
  PacketColours front;                 // of balls before the first surface, premultiplied
  LaneFloats front_opacity, front_mm;  // endless: no ball
  LaneFloats depth_mm;                 // of the nearest surface; endless: none
  std::uint32_t key[kPacketRays];      // tells surfaces and shadows of neighbours apart
};

/// Milliseconds of shadows, of those packets that were timed.
struct ShadowClock {
  double shadow_ms = 0, whole_ms = 0;
};

/// Shades the rays through pixel coordinates; `meets_shapes`: false where they cannot; `clock`:
/// null where the packet is not timed.
void shade_packet(const EyeScene& scene, const LaneFloats& x, const LaneFloats& y,
                  bool meets_shapes, PacketPicture& picture, ShadowClock* clock = nullptr);

}  // namespace supple
