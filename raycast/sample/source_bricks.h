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

/// How densities between the voxels are read. `linear`: trilinear, through every voxel's density.
/// `cubic`: the tricubic B-spline whose coefficients are the densities themselves. It has
/// continuous second derivatives and never leaves the range of the 4^3 voxels around, so that it
/// rings nowhere. It smooths: a quadratic comes out a third of its second derivative's half higher
/// (x^2 as x^2 + 1/3), linear densities are kept. `interpolating`: the one through every voxel's
/// density, as smooth; thin walls stay, and beside sharp edges it overshoots, which may show as
/// shells around bone (volumes/grid/b_spline.h).
enum class Interpolation { linear, cubic, interpolating };

class SourceBricks {
 public:
  static constexpr int kDim = 11;  // nodes -1 … 9: eight cells and one more node on every side
  static constexpr int kStepX = kDim * kDim, kStepY = kDim, kStepZ = 1;
  static constexpr std::int16_t kVoid = -32768;
  static constexpr std::size_t kBrickNodes = kDim * kDim * kDim + 1;  // even: pairs stay aligned

  explicit SourceBricks(const DensityGrid& density,
                        Interpolation interpolation = Interpolation::linear)
      : SourceBricks(density, density.bricks(), interpolation) {}
  /// Sampled where `where` is active; its voxels that are inactive in the grid hold the background.
  SourceBricks(const DensityGrid& density, const BrickTopology& where,
               Interpolation interpolation = Interpolation::linear);

  Interpolation interpolation() const { return m_interpolation; }

  const BrickTopology& topology() const { return m_topology; }
  /// Node `local` (0 … 8 per axis, apron beyond) of brick b.
  const std::int16_t* node(std::size_t b, const Vec3i& local) const {
    return &m_nodes[b * kBrickNodes + (local.x + 1) * kStepX + (local.y + 1) * kStepY + local.z +
                    1];
  }
  const std::int16_t* nodes() const { return m_nodes.data(); }
  /// Encoded densities that samples in the cells of brick b can take.
  const EncodedRange& range(std::size_t b) const { return m_ranges[b]; }
  const EncodedRange& range() const { return m_range; }

  double density(double encoded) const { return m_offset + m_scale * encoded; }
  double encoded(double density) const { return (density - m_offset) / m_scale; }
  double scale() const { return m_scale; }
  std::size_t bytes() const;

 private:
  /// The 512 densities under brick b; null where the grid has none and all are background.
  using Values = std::vector<const float*>;
  void choose_encoding(const DensityGrid& density, const Values& values);
  std::int16_t encode(float density) const;
  void fill_brick(const Values& values, float background, std::size_t b);

  Interpolation m_interpolation;
  BrickTopology m_topology;
  std::vector<std::int16_t> m_nodes;
  std::vector<EncodedRange> m_ranges;
  EncodedRange m_range;
  double m_offset = 0, m_scale = 1;  // density = offset + scale * encoded
};

}  // namespace supple
