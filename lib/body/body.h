// A body: voxels as nodes, the six lattice neighbours as implied 2-connectors (thesis chapter 5).
// ECM, relaxation and mass-spring share this node state and nothing else.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "lib/body/rigid_pieces.h"
#include "lib/material/material.h"
#include "lib/state/state.h"

namespace supple {

/// Node state in brick order: slot 512 * brick + offset of `elements`.
struct Body {
  Geometry geometry;
  BrickTopology elements;
  std::vector<std::uint8_t> classes;  // material class per voxel
  std::array<BrickValues, 3> q;       // offsets from rest, 2^-16 voxel; stored where they moved
  /// Links between elements that are absent: cut, or between two elements of rigid pieces.
  LinkCuts cuts;
  RestStretch rest;  // of the links' springs; empty without plastic flow
  /// Node state of the models beside ECM, empty unless one of them has left some. The fraction is
  /// the rest of an offset beyond q, in 2^-32 voxel, at most half a unit of q. Code that writes q
  /// drops the fractions of the voxels that it moved.
  std::array<BrickArray<std::int16_t>, 3> fraction;
  Velocities velocity_mm_s;  // LPS
  RigidPieces rigid;         // sets of elements that move as rigid bodies
  SlackTable slacks;
  MaterialTable material;
  /// True while all links are known to hold, so that a drag need not check them. Code that writes q
  /// other than through a model that keeps links valid sets it to false.
  bool links_known_valid = false;
  /// How far each offset is beyond an admissible one (beyond_limits.h): the links that are known to
  /// hold are those of q less this, and ECM keeps the rest. Null: ECM projects an invalid q.
  BeyondLimits beyond;

  /// Offset of coordinate c of a voxel that is an element; 0 for a coordinate that never moved.
  std::int32_t offset(const Vec3i& voxel, int c) const;
  std::size_t bytes() const;
  /// Drops the fractions of a brick's offsets that differ from those `before`.
  void drop_fractions(int c, std::size_t brick, const std::int32_t* before);
};

/// Elements at rest; `labels`, on their bricks, choose among the material's tables.
Body make_body(const Geometry& geometry, const DensityGrid& density, const BrickTopology& elements,
               const MaterialTable& material, const BrickValues& labels = {});
/// Continues a state under its own or another material.
Body make_body(const State& state, const MaterialTable& material);

/// Links whose limits the present offsets break, with the largest excess in voxels. A link counts
/// once, however many of its coordinates are broken.
struct LinkCheck {
  std::int64_t links = 0;
  std::int64_t violated = 0;
  double worst_excess_voxels = 0;
  /// True when min_length > shear1 + shear2 (that is 2 * shear) holds on every link, so that no
  /// cell can fold. An axis along which the body is one voxel thick does not count: > shear in 2D.
  /// False where links are cut: nothing keeps the sides of a cut from passing through each other.
  bool fold_free = false;
};
/// One parallel pass over all links; about 30 ns per element.
LinkCheck check_links(const Body& body);

/// Nearest element (Euclidean, in voxels) for an error message; false when the body is empty.
bool nearest_element(const Body& body, const Vec3i& voxel, Vec3i& nearest);

}  // namespace supple
