// Sixteen rays side by side, and what they meet: the form in which parts of the microscope hand
// rays on to each other.
#pragma once

#include <cstdint>

#include "volumes/base/vec.h"

namespace supple {

constexpr int kPacketRays = 16;
constexpr std::uint32_t kWholePacket = 0xffff;

/// A number of each ray.
struct alignas(64) LaneFloats {
  float of[kPacketRays];
  float& operator[](int lane) { return of[lane]; }
  float operator[](int lane) const { return of[lane]; }
};

struct LaneVectors {
  LaneFloats x, y, z;
  Vec3f operator[](int lane) const { return {x[lane], y[lane], z[lane]}; }
  void set(int lane, const Vec3f& v) { x[lane] = v.x, y[lane] = v.y, z[lane] = v.z; }
};

/// Rays between two distances, in lengths of their directions.
struct PacketRays {
  std::uint32_t active = 0;  // a bit for each ray
  LaneVectors origin, direction;
  LaneFloats near, far;
};

/// Triangles that rays meet first.
struct PacketHits {
  std::uint32_t met = 0;
  LaneFloats distance, u, v;  // weights of the second and third corner
  alignas(64) int triangle[kPacketRays], shape[kPacketRays];
};

/// Lit places of surfaces.
struct PacketPlaces {
  std::uint32_t active = 0;
  LaneVectors at, normal;       // normals are on the viewer's side
  LaneVectors from_eye;         // unit
  LaneFloats red, green, blue;  // linear albedo
  LaneFloats opacity, specular, shininess;
  LaneFloats lift_mm;  // along normals, to where shadows are asked for
};

struct PacketColours {
  LaneFloats red, green, blue;
};

}  // namespace supple
