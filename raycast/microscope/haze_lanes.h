// Emission and absorption along up to sixteen rays at a time through a deformed volume of haze, in
// vector registers; the instruction set is chosen when the program starts (Google Highway).
//
// Each sample at x reads the source at x + o(x) (design.md section 5): o is interpolated between
// the nodes of the present space, the density between the voxels of the source. Links of elements
// bound the gradient of their ways u, so that o is found by iteration. Cost per sample,
// AVX-512: two gathers where nothing moved, ten where something did.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "volumes/base/vec.h"

namespace supple {

/// Offset of a node, or way of an element, in 32 bits: ten for each component, in units of 1/32
/// voxel, and two that say whether it is known.
namespace packed_offset {
constexpr int kBits = 10;
constexpr float kUnit = 1 / 32.0f;
constexpr std::int32_t kMiddle = 1 << (kBits - 1);
constexpr float kLargest = float(kMiddle - 1) * kUnit;  // voxels
constexpr std::uint32_t kKnown = 3, kUnknown = 0;
constexpr std::uint32_t kRest =
    std::uint32_t(kMiddle) << 2 | std::uint32_t(kMiddle) << 12 | std::uint32_t(kMiddle) << 22;
}  // namespace packed_offset

/// What samples in a brick of 8^3 cells need.
enum class HazeBrick : std::int32_t { empty, resting, moved };

/// Nodes in the order of x, y, z, z fastest; the cells between them make bricks of 8^3, in the same
/// order.
struct HazeTables {
  Vec3i dims{0, 0, 0};
  Vec3i brick_dims{0, 0, 0};
  std::vector<std::uint32_t> offsets;  // packed, per node of the present space
  std::vector<std::uint32_t> ways;     // packed, per node of the source: what elements went
  /// Densities of the source, 0 … 255, at a node and the next ones along z, along y, and both.
  std::vector<std::uint32_t> quads;
  std::vector<std::int32_t> bricks;  // HazeBrick

  std::size_t node(int x, int y, int z) const {
    return (std::size_t(x) * std::size_t(dims.y) + std::size_t(y)) * std::size_t(dims.z) +
           std::size_t(z);
  }
};

/// Light on the haze; places and directions in index space, lengths in voxels of the first axis.
struct HazeLight {
  float extinction = 0;  // per voxel, of density 255
  float ambient = 0, power = 0;
  Vec3f place{0, 0, 0}, direction{0, 0, 0};
  float inner_cosine = 1, outer_cosine = 1;  // between which the cone fades
  float half_square = 1;                     // squared distance at which light has halved
};

/// Rays in index space; those with count 0 are not marched.
struct HazeRays {
  static constexpr int kMost = 16;
  alignas(64) float origin[3][kMost];
  alignas(64) float step[3][kMost];  // from sample to sample
  alignas(64) float length[kMost];   // of a step in voxels
  alignas(64) float count[kMost];    // samples, the first half a step behind the origin
  // Results.
  alignas(64) float light[kMost];
  alignas(64) float passes[kMost];  // part of the light behind
};

/// Finds the offsets of up to 16 nodes: fixed points of o = -u(x + o) from those that the tables
/// hold, u interpolated between elements that are left. Nodes that come to none are unknown.
void solve_offsets(HazeTables& tables, const std::uint32_t* nodes, int count);

void march_haze(const HazeTables& tables, const HazeLight& light, HazeRays& rays);

}  // namespace supple
