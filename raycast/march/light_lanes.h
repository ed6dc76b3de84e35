// Light on the samples of a batch, all lanes at once in vector registers: normals from gradients,
// and the terms of each light (Shading adds them up). The instruction set is chosen as for
// sample_batch.
#pragma once

#include <array>
#include <cstdint>

#include "raycast/march/shading.h"
#include "raycast/sample/sample_batch.h"

namespace supple {

struct LitLanes {
  static constexpr int kLanes = SampleBatch::kLanes;
  struct Vectors {
    alignas(64) float x[kLanes], y[kLanes], z[kLanes];
    Vec3f at(int lane) const { return {x[lane], y[lane], z[lane]}; }
    void set(int lane, const Vec3f& v) { x[lane] = v.x, y[lane] = v.y, z[lane] = v.z; }
  };

  // Lanes near a face, with its normal (unit, LPS, towards the viewer) and a share, 0 … 1; 1: the
  // sample lies at it.
  std::uint32_t faces = 0;
  Vectors face;
  alignas(64) float face_share[kLanes];

  // Filled in by light_lanes; lanes that were not wanted hold nothing of use.
  alignas(64) float magnitude[kLanes];  // of the gradient, density per mm
  Vectors normal;                       // Facing
  alignas(64) float trust[kLanes];
  alignas(64) float diffuse[Lighting::kMaxLights][kLanes];  // LightTerms
  alignas(64) float specular[Lighting::kMaxLights][kLanes];

  Facing facing(int lane) const { return {normal.at(lane), trust[lane]}; }
  LightTerms terms(int light, int lane) const {
    return {diffuse[light][lane], specular[light][lane]};
  }
};

/// Lights the lanes `wanted` of a batch by its index-space gradients, which `columns` take to
/// density per mm, LPS.
void light_lanes(const Shading& shading, const Shading::View& view,
                 const std::array<Vec3f, 3>& columns, const SampleBatch& batch,
                 std::uint32_t wanted, LitLanes& lit);

}  // namespace supple
