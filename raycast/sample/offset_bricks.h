// The brick table of the output lattice, {empty, identity, deformed} (design.md section 5), and the
// offsets of deformed bricks with their apron. A brick without an entry is empty; identity bricks
// cost as much as straight rays; straight rendering is the table whose bricks are all identity. In
// pointwise bricks each sample asks for its own offset (offset_field.h).
// Cost: 8.8 kB per deformed brick, 1.5 kB with every second offset.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "raycast/sample/source_bricks.h"
#include "volumes/field/brick_nodes.h"
#include "volumes/field/offset_field.h"

namespace supple {

class OffsetBricks {
 public:
  /// Straight: every source brick is an identity brick. The source outlives the bricks.
  explicit OffsetBricks(const SourceBricks& source);
  /// Samples whose cell has a corner without offset (neither valid nor extrapolated) are empty.
  /// `node_spacing`: 1, or 2 to keep every second offset only.
  OffsetBricks(const SourceBricks& source, const VectorBricks& offsets,
               std::shared_ptr<const PointwiseOffsets> pointwise = nullptr, int node_spacing = 1);

  /// Follows a change of the offsets: those in the bricks at these origins (unique) are now those
  /// that `offsets` finds, and may be gone; all others are unchanged. Bricks of `pointwise` that
  /// are new, gone, or find other offsets or faces than before are among them. The bricks are then
  /// those that the changed offsets would have given. Returns the bricks that may read other
  /// densities than before.
  std::vector<std::size_t> update(const std::vector<Vec3i>& changed,
                                  const VectorBrickFinder& offsets,
                                  std::shared_ptr<const PointwiseOffsets> pointwise = nullptr);
  /// Replaces the pointwise offsets of bricks that are otherwise straight; null: none.
  void set_pointwise(std::shared_ptr<const PointwiseOffsets> pointwise);

  const BrickIndex& index() const { return m_index; }
  std::size_t brick_count() const { return m_states.size(); }
  std::int32_t find(const Vec3i& voxel) const { return m_index.find(voxel); }
  bool is_identity(std::size_t b) const { return m_states[b] == kIdentity; }
  bool is_deformed(std::size_t b) const { return m_states[b] >= kDeformed; }
  bool is_pointwise(std::size_t b) const { return m_states[b] <= kPointwise; }
  /// The pointwise offsets; null: there are no pointwise bricks.
  const PointwiseOffsets* pointwise() const { return m_pointwise.get(); }
  /// Number of a pointwise brick among the bricks of the pointwise offsets.
  std::size_t pointwise_brick(std::size_t b) const { return std::size_t(kPointwise - m_states[b]); }
  /// For each pointwise brick, its place among offsets(), or -1, and its cells in which these are
  /// interpolated. Null: in none.
  const std::int32_t* pointwise_slots() const {
    return m_pointwise_slots.empty() ? nullptr : m_pointwise_slots.data();
  }
  const BrickMask* interpolated() const { return m_interpolated.data(); }
  /// Place of a deformed brick among offsets().
  std::int32_t slot(std::size_t b) const { return m_states[b]; }
  /// The source brick with the same origin, or -1.
  std::int32_t beneath(std::size_t b) const { return m_beneath[b]; }
  /// Nodes along an axis of a brick: 9, or 5 where every second one is kept.
  int node_dim() const { return kBrickDim / m_node_spacing + 1; }
  /// node_dim()^3 offsets per slot, x slowest, three floats each; not a number where there is none.
  const float* offsets() const { return m_offsets.data(); }
  /// Offset of a node of a deformed brick, counted in nodes. Four floats may be read.
  const float* node(std::size_t b, const Vec3i& local) const {
    return m_offsets.at(slot(b)) + 3 * ((local.x * node_dim() + local.y) * node_dim() + local.z);
  }
  /// Encoded densities that samples in brick b can read, wherever their offsets lead.
  const EncodedRange& range(std::size_t b) const { return m_ranges[b]; }
  /// Smallest box of voxels that holds every offset given, extrapolated ones left out.
  const IndexBox& valid_bounds() const { return m_valid_bounds; }

  std::size_t bytes() const;

 private:
  static constexpr std::int32_t kIdentity = -1, kEmpty = -2, kPointwise = -3;
  static constexpr std::int32_t kDeformed = 0;  // or more

  std::size_t add_brick(const Vec3i& origin);
  void take_over(const VectorBricks& offsets);
  void join_valid();
  void gather(const std::vector<std::size_t>& bricks, const VectorBrickFinder& offsets);
  std::int32_t gather_brick(std::size_t b, const VectorBrickFinder& offsets);
  bool is_straight(std::size_t b, const BrickNodes& nodes) const;
  EncodedRange range_beneath(std::size_t b) const;
  EncodedRange range_of(std::size_t b, const BrickNodes& nodes) const;
  void unmark_pointwise();
  void mark_pointwise();
  void find_pointwise_ranges(const std::vector<std::size_t>& bricks);
  bool keep_interpolated(std::size_t n, std::int32_t slot);

  const SourceBricks* m_source;
  int m_node_spacing = 1;
  BrickIndex m_index;
  std::vector<std::int32_t> m_states;  // slot, or kPointwise - n: pointwise brick n
  std::vector<std::int32_t> m_beneath;
  std::vector<EncodedRange> m_ranges;
  std::vector<IndexBox> m_valid;  // voxels with an offset given
  IndexBox m_valid_bounds;
  NodeSlots m_offsets{BrickNodes::kDim};
  std::shared_ptr<const PointwiseOffsets> m_pointwise;
  std::vector<std::int32_t> m_pointwise_slots;
  std::vector<BrickMask> m_interpolated;
};

/// (I + grad o)^T g at a place of the index frame, with differences of the trilinear offset half
/// a cell to both sides: derivatives that do not jump where cells meet, for about six times the
/// cost of pull_back_gradient(). Not beside a jump. False where some of it is void.
bool pull_back_smoothly(const OffsetBricks& bricks, const Vec3d& place, const Vec3f& gradient,
                        Vec3f& pulled);

/// A place in a cell of a deformed brick.
struct NodeCell {
  const float* node = nullptr;  // of the low corner
  float x = 0, y = 0, z = 0;    // 0 … 1
  int dim = BrickNodes::kDim;   // nodes along an axis
};

/// (I + grad o)^T g with the derivatives of the trilinear offset in its cell.
Vec3f pull_back_gradient(const NodeCell& cell, const Vec3f& gradient);

}  // namespace supple
