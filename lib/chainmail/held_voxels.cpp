#include "lib/chainmail/held_voxels.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <unordered_set>

#include "volumes/base/error.h"

namespace supple {

namespace {

std::string nearest_text(const Body& body, const Vec3i& voxel) {
  Vec3i nearest;
  if (!nearest_element(body, voxel, nearest)) return "; the body has no elements";
  return "; the nearest is " + voxel_text(nearest);
}

void hold_box(const Body& body, const IndexBox& box, std::map<std::size_t, BrickMask>& masks) {
  const BrickTopology& elements = body.elements;
  bool any = false;
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    const Vec3i& lo = elements.origin(b);
    const Vec3i hi = lo + Vec3i(kBrickDim - 1);
    if (lo.x > box.hi.x || lo.y > box.hi.y || lo.z > box.hi.z || hi.x < box.lo.x ||
        hi.y < box.lo.y || hi.z < box.lo.z) {
      continue;
    }
    for_each_active(elements.mask(b), [&](int offset) {
      if (!box.contains(lo + brick_local(offset))) return;
      mask_set(masks.try_emplace(b, BrickMask{}).first->second, offset);
      any = true;
    });
  }
  if (any) return;
  const bool single = box.lo == box.hi;
  const std::string text = voxel_text(box.lo) + (single ? "" : ":" + voxel_text(box.hi));
  throw InputError({"", "fix " + text, "no element",
                    "a voxel or box that holds elements" + nearest_text(body, box.lo)});
}

void require_range(const Body& body, const Handle& handle) {
  for (int c = 0; c < 3; ++c) {
    const std::int64_t target = std::int64_t(body.offset(handle.voxel, c)) + handle.by_q[c];
    const std::int64_t by = handle.by_q[c];
    if (std::llabs(target) <= kMaxOffset && std::llabs(by) < kMaxOffset) continue;
    throw InputError({"", "grab " + voxel_text(handle.voxel),
                      "a move by " + number_text(double(by) / kFixedOne) +
                          " voxels to an offset of " + number_text(double(target) / kFixedOne) +
                          " voxels along axis " + "ijk"[c],
                      "moves and offsets within +-16383 voxels"});
  }
}

}  // namespace

std::string voxel_text(const Vec3i& voxel) {
  return std::to_string(voxel.x) + "," + std::to_string(voxel.y) + "," + std::to_string(voxel.z);
}

bool HeldVoxels::is_anchored(Slot slot) const {
  const std::size_t brick = slot / kBrickVoxels;
  const auto found = std::lower_bound(anchor_bricks.begin(), anchor_bricks.end(), brick);
  return found != anchor_bricks.end() && *found == brick &&
         mask_test(anchor_masks[std::size_t(found - anchor_bricks.begin())],
                   int(slot % kBrickVoxels));
}

HeldVoxels hold(const Body& body, const std::vector<Handle>& handles,
                const std::vector<IndexBox>& anchors) {
  HeldVoxels held;
  std::map<std::size_t, BrickMask> masks;
  for (const IndexBox& box : anchors) hold_box(body, box, masks);
  for (const auto& [brick, mask] : masks) {
    held.anchor_bricks.push_back(brick);
    held.anchor_masks.push_back(mask);
  }

  std::unordered_set<Slot> grabbed;
  for (const Handle& handle : handles) {
    const std::string field = "grab " + voxel_text(handle.voxel);
    Slot slot;
    if (!slot_of(body.elements, handle.voxel, slot)) {
      throw InputError(
          {"", field, "no element", "a voxel of the body" + nearest_text(body, handle.voxel)});
    }
    if (!grabbed.insert(slot).second) {
      throw InputError({"", field, "the voxel grabbed twice", "one handle per voxel"});
    }
    if (held.is_anchored(slot)) {
      throw InputError({"", field, "the voxel grabbed and fixed", "one of both"});
    }
    require_range(body, handle);
    held.slots.push_back(slot);
    held.by_q.push_back(handle.by_q);
  }
  return held;
}

}  // namespace supple
