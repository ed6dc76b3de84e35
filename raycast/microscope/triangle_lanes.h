// Rays of a packet against triangles, all rays at once in vector registers. The instruction set is
// chosen when the program runs.
#pragma once

#include <array>
#include <cstdint>

#include "raycast/microscope/eye_lanes.h"
#include "raycast/microscope/packet.h"
#include "raycast/microscope/triangle_bins.h"

namespace supple {

/// A triangle as rays meet it.
struct TriangleFloats {
  Vec3f corner, to_second, to_third;
  Vec3f across;  // the product of the two ways
  int shape;
  int dim_steps;  // of light that passes; kBlocks: none does
  static constexpr int kBlocks = -1;
};
TriangleFloats triangle_floats(const std::array<Vec3f, 3>& corners);

/// First hits of the listed triangles. Hits of a ray at one distance: the first listed one's.
void first_hits(const TriangleFloats* triangles, const TriangleList& list, const PacketRays& rays,
                PacketHits& hits);

/// Light along rays: those that are blocked, and steps of dimming of the others.
struct PacketDimming {
  std::uint32_t blocked = 0;
  alignas(64) std::int32_t steps[kPacketRays];
};
/// Sums up all hits of the listed triangles.
void dim_rays(const TriangleFloats* triangles, const TriangleList& list, const PacketRays& rays,
              PacketDimming& dimming);

}  // namespace supple
