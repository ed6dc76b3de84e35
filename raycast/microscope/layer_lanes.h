// Layers that rays meet one behind the other, all rays of a packet at once in vector registers. The
// instruction set is chosen when the program runs.
#pragma once

#include <cstdint>

#include "raycast/microscope/eye_lanes.h"
#include "raycast/microscope/packet.h"
#include "volumes/base/vec.h"

namespace supple {

/// A shape's surface, linear.
struct SurfaceFloats {
  Vec3f colour;
  float opacity, specular, shininess;
  float lift_mm;  // of shadow rays
};

/// Unit normals of a triangle's corners, in the world.
struct CornerNormals {
  Vec3f of[3];
};

struct PacketPicture {
  PacketColours colour;                // linear, of surfaces and what lies behind the first of them
  PacketColours front;                 // of balls before the first surface, premultiplied
  LaneFloats front_opacity, front_mm;  // endless: no ball
  LaneFloats depth_mm;                 // of the nearest surface; endless: none
  // Tells surfaces and shadows of neighbours apart.
  alignas(64) std::uint32_t key[kPacketRays];
};

/// State that a packet carries from layer to layer.
struct Layers {
  PacketRays rays;
  LaneFloats end_mm;  // of rays on the globe
  LaneFloats clear;   // part that is still seen of what comes
  LaneFloats front_clear;
  LaneFloats reached_mm;  // of balls that have been put in
};

/// Replaces places on the globe by those of shapes before it: `normals` of all triangles,
/// `surfaces` of all shapes.
void put_hits(const CornerNormals* normals, const SurfaceFloats* surfaces, const PacketHits& hits,
              const PacketRays& rays, PacketPlaces& places);

/// Adds a lit layer behind those before it, and goes on where something of the next is seen.
/// Shadows that differ by 1 / `levels` change keys.
void add_layer(const PacketLight& light, const LaneFloats& passing, const PacketHits& hits,
               const LaneFloats& distance, float levels, Layers& layers, PacketPicture& picture);

}  // namespace supple
