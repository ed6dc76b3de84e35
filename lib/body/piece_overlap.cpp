#include "lib/body/piece_overlap.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>
#include <vector>

#include "volumes/grid/voxel_sets.h"

namespace supple {

namespace {

using VoxelSet = std::unordered_set<Vec3i, VoxelHash>;

Vec3d place_of(const Body& body, const Vec3i& voxel) {
  Vec3d at(voxel);
  for (int c = 0; c < 3; ++c) at[c] += double(body.offset(voxel, c)) / kFixedOne;
  return at;
}

struct PlacedBone {
  VoxelSet voxels;
  Vec3i lo, hi;
  /// From where the bone is to where it was, in mm.
  RigidMotion back;
};

std::vector<PlacedBone> bones_of(const Body& body) {
  std::vector<PlacedBone> bones;
  for (const RigidPiece& piece : body.rigid.list) {
    PlacedBone bone{{}, Vec3i(1 << 20), Vec3i(-(1 << 20)), {}};
    RigidFit fit;
    piece.elements->for_each([&](Slot slot) {
      const Vec3i voxel = voxel_of(body.elements, slot);
      bone.voxels.insert(voxel);
      for (int a = 0; a < 3; ++a) {
        bone.lo[a] = std::min(bone.lo[a], voxel[a]);
        bone.hi[a] = std::max(bone.hi[a], voxel[a]);
      }
      fit.add(body.geometry.world_from_index(place_of(body, voxel)),
              body.geometry.world_from_index(Vec3d(voxel)));
    });
    bone.back = fit.motion();
    bones.push_back(std::move(bone));
  }
  return bones;
}

double overlap_in(const PlacedBone& bone, const Vec3d& at) {
  for (int a = 0; a < 3; ++a) {
    if (at[a] < bone.lo[a] - 1 || at[a] > bone.hi[a] + 1) return 0;
  }
  double deepest = 0;
  const Vec3i base(int(std::floor(at.x)), int(std::floor(at.y)), int(std::floor(at.z)));
  for (int n = 0; n < 8; ++n) {
    const Vec3i voxel = base + Vec3i(n & 1, n >> 1 & 1, n >> 2);
    if (bone.voxels.count(voxel) == 0) continue;
    const Vec3d way = at - Vec3d(voxel);
    deepest = std::max(deepest, 1 - std::max({std::abs(way.x), std::abs(way.y), std::abs(way.z)}));
  }
  return deepest;
}

}  // namespace

double deepest_overlap(const Body& body) {
  const std::vector<PlacedBone> bones = bones_of(body);
  double deepest = 0;
  for (const PlacedBone& bone : bones) {
    for (const Vec3i& voxel : bone.voxels) {
      const Vec3d now = body.geometry.world_from_index(place_of(body, voxel));
      for (const PlacedBone& other : bones) {
        if (&other == &bone) continue;
        deepest =
            std::max(deepest, overlap_in(other, body.geometry.index_from_world(other.back(now))));
      }
    }
  }
  return deepest;
}

}  // namespace supple
