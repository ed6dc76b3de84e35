// What a drag holds: grabbed voxels with their displacements, and anchored ones that stay.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "lib/body/lattice.h"
#include "lib/chainmail/ecm.h"

namespace supple {

struct HeldVoxels {
  std::vector<Slot> slots;                        // grabbed, in the order of the handles
  std::vector<std::array<std::int32_t, 3>> by_q;  // and how far each is to move
  std::vector<std::size_t> anchor_bricks;         // ascending bricks with anchored voxels
  std::vector<BrickMask> anchor_masks;            // and which of their voxels

  /// Calls `visit(slot)` for every anchored voxel.
  template <class Visit>
  void for_each_anchor(Visit&& visit) const {
    for (std::size_t n = 0; n < anchor_bricks.size(); ++n) {
      for_each_active(anchor_masks[n], [&](int offset) {
        visit(Slot(anchor_bricks[n] * kBrickVoxels + std::size_t(offset)));
      });
    }
  }
  bool is_anchored(Slot slot) const;
};

/// "i,j,k", as on the command line.
std::string voxel_text(const Vec3i& voxel);

/// Finds handles and anchors in the body. Throws InputError: a handle on void (names the nearest
/// element) or grabbed twice or also fixed, an anchor box without elements, a target beyond the
/// range of +-16384 voxels.
HeldVoxels hold(const Body& body, const std::vector<Handle>& handles,
                const std::vector<IndexBox>& anchors);

}  // namespace supple
