// The brick table of the output lattice, {empty, identity, deformed} (design.md section 5), and
// the offsets of deformed bricks with their apron. A brick without an entry is empty; identity
// bricks cost what straight rays cost; straight rendering is the table whose bricks are all
// identity. In split bricks the offsets jump, and each sample asks for its own (split_offsets.h).
// Cost: 8.8 kB per deformed brick.
#pragma once

#include <cstdint>
#include <vector>

#include "raycast/source_bricks.h"
#include "volumes/field/split_offsets.h"

namespace supple {

/// Four packed floats; the marcher's vectors and colours.
using Float4 = float __attribute__((vector_size(16)));

class OffsetBricks {
 public:
  static constexpr int kDim = 9;                                                 // nodes 0 … 8
  static constexpr int kStepX = 3 * kDim * kDim, kStepY = 3 * kDim, kStepZ = 3;  // in floats
  static constexpr std::int32_t kIdentity = -1;

  /// Straight: every source brick is an identity brick.
  explicit OffsetBricks(const SourceBricks& source);
  /// Samples whose cell has a corner without offset (neither valid nor extrapolated) are empty.
  OffsetBricks(const SourceBricks& source, const VectorBricks& offsets,
               std::shared_ptr<const SplitOffsets> split = nullptr);

  const BrickTopology& topology() const { return m_topology; }
  bool is_identity(std::size_t b) const { return m_slots[b] == kIdentity; }
  bool is_split(std::size_t b) const { return m_slots[b] < kIdentity; }
  bool has_split() const { return m_split != nullptr; }
  const SplitOffsets& split() const { return *m_split; }
  /// Which of their bricks a split brick is.
  std::size_t split_brick(std::size_t b) const { return std::size_t(kIdentity - 1 - m_slots[b]); }
  /// Place of a deformed brick among offsets(); negative for others.
  std::int32_t slot(std::size_t b) const { return m_slots[b]; }
  /// Three floats per node, x slowest, kDim^3 nodes per slot.
  const float* offsets() const { return m_offsets.data(); }
  /// Offset (three floats) of node `local` of a deformed brick; NaN where there is none. Four
  /// floats may be read.
  const float* node(std::size_t b, const Vec3i& local) const {
    return &m_offsets[m_slots[b] * kBrickFloats + local.x * kStepX + local.y * kStepY +
                      local.z * kStepZ];
  }
  /// Encoded densities that samples in brick b can read, wherever their offsets lead.
  const EncodedRange& range(std::size_t b) const { return m_ranges[b]; }
  /// Smallest box of voxels that holds every offset given, extrapolated ones left out.
  const IndexBox& valid_bounds() const { return m_valid_bounds; }

  std::size_t deformed_count() const { return m_offsets.size() / kBrickFloats; }
  std::size_t bytes() const;

 private:
  static constexpr std::size_t kBrickFloats = 3 * kDim * kDim * kDim;

  struct Gathered;
  static Gathered gather(const VectorBricks& extrapolated, const SourceBricks& source,
                         std::size_t b);

  void mark_split_bricks(const SourceBricks& source);

  BrickTopology m_topology;
  std::vector<std::int32_t> m_slots;  // kIdentity - 1 - n: split brick n
  std::shared_ptr<const SplitOffsets> m_split;
  std::vector<EncodedRange> m_ranges;
  std::vector<float> m_offsets;
  IndexBox m_valid_bounds;
};

/// A place in a cell of a deformed brick.
struct OffsetCell {
  const float* node = nullptr;  // null: identity
  float x = 0, y = 0, z = 0;
};

/// (I + grad o)^T g with the derivatives of the trilinear offset in its cell.
Vec3f pull_back_gradient(const OffsetCell& cell, const Vec3f& gradient);

}  // namespace supple
