// The source volume as the marcher reads it: int16 bricks of 8^3 cells with an apron, mirrored from
// the leaves of the density grid (design.md section 5). Exact for integers that span at most 65534
// values; other data are rounded to 1/65534 of their range.
// Cost: 2.7 kB per occupied brick; a sample touches one brick, its central-difference gradient too.
#pragma once

#include <cstdint>
#include <vector>

#include "volumes/grid/density_grid.h"

namespace supple {

/// Closed range of encoded densities; empty when lo > hi.
struct EncodedRange {
  float lo = 1;
  float hi = 0;
  bool empty() const { return lo > hi; }
  void add(float value);
  void add(const EncodedRange& other);
};

class SourceBricks {
 public:
  static constexpr int kDim = 11;  // nodes -1 … 9: eight cells and one more node on every side
  static constexpr int kStepX = kDim * kDim, kStepY = kDim, kStepZ = 1;
  static constexpr std::int16_t kVoid = -32768;

  explicit SourceBricks(const DensityGrid& density) : SourceBricks(density, density.bricks()) {}
  /// Sampled where `where` is active; its voxels that are inactive in the grid hold the background.
  SourceBricks(const DensityGrid& density, const BrickTopology& where);

  const BrickTopology& topology() const { return m_topology; }
  /// Node `local` (0 … 8 per axis, apron beyond) of brick b.
  const std::int16_t* node(std::size_t b, const Vec3i& local) const {
    return &m_nodes[b * kBrickNodes + (local.x + 1) * kStepX + (local.y + 1) * kStepY + local.z +
                    1];
  }
  /// Encoded densities that samples in the cells of brick b can take.
  const EncodedRange& range(std::size_t b) const { return m_ranges[b]; }
  const EncodedRange& range() const { return m_range; }

  double density(double encoded) const { return m_offset + m_scale * encoded; }
  double encoded(double density) const { return (density - m_offset) / m_scale; }
  double scale() const { return m_scale; }
  std::size_t bytes() const;

 private:
  static constexpr std::size_t kBrickNodes = kDim * kDim * kDim + 1;

  /// The 512 densities under brick b; null where the grid has none and all are background.
  using Values = std::vector<const float*>;
  void choose_encoding(const DensityGrid& density, const Values& values);
  std::int16_t encode(float density) const;
  void fill_brick(const Values& values, float background, std::size_t b);

  BrickTopology m_topology;
  std::vector<std::int16_t> m_nodes;
  std::vector<EncodedRange> m_ranges;
  EncodedRange m_range;
  double m_offset = 0, m_scale = 1;  // density = offset + scale * encoded
};

/// A place in a cell: the node at its low corner and the position within, 0 … 1.
struct SourceCell {
  const std::int16_t* node = nullptr;
  float x = 0, y = 0, z = 0;
};

/// Bilinear value on the four nodes spanned by two steps; false when one of them is void.
inline bool sample_plane(const std::int16_t* node, int step_u, int step_v, float u, float v,
                         float& value) {
  const std::int16_t a = node[0], b = node[step_u], c = node[step_v], d = node[step_u + step_v];
  if ((a == SourceBricks::kVoid) | (b == SourceBricks::kVoid) | (c == SourceBricks::kVoid) |
      (d == SourceBricks::kVoid)) {
    return false;
  }
  const float low = float(a) + u * float(b - a);
  const float high = float(c) + u * float(d - c);
  value = low + v * (high - low);
  return true;
}

/// Trilinear value; false (empty) when any of the eight corners is void.
inline bool sample_cell(const SourceCell& cell, float& value) {
  constexpr int sx = SourceBricks::kStepX, sy = SourceBricks::kStepY, sz = SourceBricks::kStepZ;
  float low = 0, high = 0;
  if (!sample_plane(cell.node, sy, sz, cell.y, cell.z, low)) return false;
  if (!sample_plane(cell.node + sx, sy, sz, cell.y, cell.z, high)) return false;
  value = low + cell.x * (high - low);
  return true;
}

/// Index-space gradient by central differences of the trilinear density over +-1 voxel, one-sided
/// where a neighbour is void, 0 where both are. `value` is the density at the cell's position.
Vec3f sample_gradient(const SourceCell& cell, float value);

}  // namespace supple
