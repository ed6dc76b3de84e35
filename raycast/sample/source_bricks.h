// The source volume as the marcher reads it: int16 bricks of 8^3 cells with an apron, mirrored from
// the leaves of the density grid (design.md section 5). Exact for integers that span at most 65534
// values; other data are rounded to 1/65534 of their range. Bricks are filled when a ray first
// reads them: what no ray reads costs little. A sample touches one brick, its
// central-difference gradient too.
// Cost: per brick 0.25 µs, 0.5 where the grid does not know its extremes, and 0.1 kB, per brick
// that is read 15 µs and 2.7 kB; cubic ones all.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
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
  static constexpr std::size_t kBrickNodes = kDim * kDim * kDim + 1;  // even: pairs stay aligned

  explicit SourceBricks(const DensityGrid& density,
                        Interpolation interpolation = Interpolation::linear)
      : SourceBricks(density, density.bricks(), interpolation) {}
  /// Samples where `where` is active; its voxels that are inactive in the grid hold the background.
  SourceBricks(const DensityGrid& density, const BrickTopology& where,
               Interpolation interpolation = Interpolation::linear);

  Interpolation interpolation() const { return m_interpolation; }

  const BrickTopology& topology() const { return m_topology; }
  /// Makes the nodes of brick b what they are, once; from any thread.
  void ensure(std::size_t b) const {
    if (m_states[b].load(std::memory_order_acquire) != kFilled) fill_once(b);
  }
  /// Node `local` (0 … 8 per axis, apron beyond) of brick b.
  const std::int16_t* node(std::size_t b, const Vec3i& local) const {
    ensure(b);
    return &m_nodes[b * kBrickNodes + (local.x + 1) * kStepX + (local.y + 1) * kStepY + local.z +
                    1];
  }
  /// Nodes of all bricks; those of bricks that ensure() was asked for are filled.
  const std::int16_t* nodes() const { return m_nodes.get(); }
  /// Encoded densities that samples in the cells of brick b can take.
  const EncodedRange& range(std::size_t b) const { return m_ranges[b]; }
  const EncodedRange& range() const { return m_range; }

  double density(double encoded) const { return m_offset + m_scale * encoded; }
  double encoded(double density) const { return (density - m_offset) / m_scale; }
  double scale() const { return m_scale; }
  std::size_t bytes() const;

 private:
  enum State : std::uint8_t { kEmpty, kFilling, kFilled };

  /// The 512 densities under a brick; null: all are background.
  const float* values(std::size_t b) const {
    return m_values.empty() ? m_density.values(b) : m_values[b];
  }
  std::vector<BrickExtremes> look_for_extremes() const;
  void find_ranges();
  void fill_all();
  void choose_encoding(double lo, double hi, bool integers);
  std::int16_t encode(float density) const;
  EncodedRange fill(std::size_t b) const;
  void fill_once(std::size_t b) const;

  Interpolation m_interpolation;
  BrickTopology m_topology;
  DensityGrid m_density;                    // keeps the densities
  std::vector<const float*> m_values;       // see values(); empty: those of m_density's bricks
  std::unique_ptr<std::int16_t[]> m_nodes;  // memory is taken where they are written
  std::unique_ptr<std::atomic<std::uint8_t>[]> m_states;
  std::vector<EncodedRange> m_ranges;
  EncodedRange m_range;
  double m_offset = 0, m_scale = 1;  // density = offset + scale * encoded
};

}  // namespace supple
