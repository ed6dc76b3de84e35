// Offsets of the corners of held voxels.
//
// A held element says of its corners: its offset, and half of where a step along each axis goes
// (field_steps.h). In a rigid piece, steps are those of its pose. A corner goes where the elements
// around it say that come first (FemGrip::rank), in their mean: nothing depends on the order of
// handles, and forces on a corner are shared in the same way.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "lib/body/body.h"
#include "lib/fem/voxel/fem.h"
#include "lib/model/fem_grips.h"
#include "lib/model/voxel_corners.h"

namespace supple {

/// Nodes that elements hold, and the offsets that these ask of them.
class CornerOffsets {
 public:
  explicit CornerOffsets(const HexMesh& mesh) : m_place(std::size_t(mesh.node_count()), -1) {}

  /// Room for the nodes of so many more elements, nearly.
  void reserve(std::size_t elements) { m_sums.reserve(m_sums.size() + elements); }
  void say(NodeIndex node, const Vec3d& offset, int rank, std::int32_t grip);

  /// The mean of the offsets that elements of the first rank ask.
  Vec3d offset(NodeIndex node) const;
  int elements(NodeIndex node) const { return at(node).elements; }  // of the first rank
  int rank(NodeIndex node) const { return at(node).rank; }
  /// The grip whose all these elements are, or -1.
  std::int32_t owner(NodeIndex node) const { return at(node).owner; }

 private:
  struct CornerSum {
    Vec3d sum;  // or the offset, where it is one
    std::int32_t elements = 1, owner;
    std::int16_t rank;
    bool is_one = true;
  };
  const CornerSum& at(NodeIndex node) const {
    return m_sums[std::size_t(m_place[std::size_t(node)])];
  }

  std::vector<std::int32_t> m_place;  // in m_sums, of every node
  std::vector<CornerSum> m_sums;
};

/// Corners and nodes that grips hold, at the start of a move or at its end.
class HeldCorners {
 public:
  HeldCorners(const VoxelCorners& corners, const std::vector<FemGrip>& grips, bool is_end);

  /// The held elements of each grip, for loads.
  std::vector<HeldElements> elements() const;
  /// The reaches of grips with corners that are not theirs alone.
  std::vector<GripReach> reaches() const;

 private:
  void say_field(const std::vector<std::size_t>& members, bool is_end);
  void stay(const std::vector<std::size_t>& members);
  void refine();
  const CornerOffsets& nodes() const { return m_at_nodes ? *m_at_nodes : m_at_corners; }
  HeldElements held_by(std::int32_t number) const;

  const VoxelCorners& m_corners;
  const std::vector<FemGrip>& m_grips;
  CornerOffsets m_at_corners;
  std::optional<CornerOffsets> m_at_nodes;  // of a refined mesh, at all nodes
};

}  // namespace supple
