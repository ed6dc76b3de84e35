// Kernels of the microscope, all rays of a packet at once in vector registers: rays of a camera
// within a globe, the globe's texture, and a lamp's light. The instruction set is chosen when the
// program runs, as for light_lanes of raycast/march.
#pragma once

#include <cstdint>
#include <vector>

#include "raycast/microscope/packet.h"
#include "raycast/scene/camera.h"

namespace supple {

/// A perspective camera's rays: forward + right * x + up * y, of pixel coordinates.
struct LensFloats {
  Vec3f origin, forward, right, up;  // right and up: of one pixel
  float middle_x, middle_y;          // pixel coordinates of `forward`
};
LensFloats lens_of(const Camera& camera, int width, int height);

/// The inside of a sphere with what is painted on it.
struct GlobeFloats {
  Vec3f centre{0, 0, 0};
  float radius = 0;  // mm; 0: none
  int width = 0, height = 0;
  std::vector<std::uint32_t> texels;  // square roots of linear colours, 10 bits each, red lowest
  struct Spot {
    Vec3f direction;
    float radius_mm;
  };
  std::vector<Spot> spots;
};

struct LampFloats {
  bool is_on = false;
  Vec3f place{0, 0, 0}, direction{0, 0, -1};
  float cosine_full = 1, cosine_none = 1;  // between these angles light fades
  float power = 1;
  float ambient = 0;
};

/// Unit rays through pixel coordinates, within the globe or, without one, from the camera on.
void aim_rays(const LensFloats& lens, const GlobeFloats& globe, const LaneFloats& x,
              const LaneFloats& y, PacketRays& rays);

/// Places where rays end on the globe, with their colours.
void globe_places(const GlobeFloats& globe, const PacketRays& rays, PacketPlaces& places);

struct PacketLight {
  PacketColours lit;          // by the lamp: diffuse and mirrored, times opacity
  PacketColours ambient;      // times opacity
  LaneFloats opacity;         // of the way through a thin sheet
  std::uint32_t reached = 0;  // where the lamp's light is not 0
};
/// Light of the lamp without shadows.
void lamp_light(const LampFloats& lamp, const PacketPlaces& places, PacketLight& light);

/// Rays from places to a point of the lamp for each.
void shadow_rays(const PacketPlaces& places, const LaneVectors& lamp_points, std::uint32_t wanted,
                 PacketRays& rays);

/// Pixel coordinates of places.
struct PacketPixels {
  LaneFloats x, y;
};
PacketPixels project_packet(const LensFloats& lens, const LaneVectors& places);

/// The wanted ones of a packet within half a width of a pixel in x and y, and what they span.
struct PixelCluster {
  std::uint32_t lanes = 0;
  float left, top, right, bottom;
};
PixelCluster cluster_around(const PacketPixels& pixels, int lane, float half_width,
                            std::uint32_t wanted);

}  // namespace supple
