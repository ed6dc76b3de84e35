#include "lib/contact/piece_overlap.h"

#include <algorithm>
#include <cmath>

namespace supple {

namespace {

Vec3d place_of(const Body& body, const Vec3i& voxel) {
  Vec3d at(voxel);
  for (int c = 0; c < 3; ++c) at[c] += double(body.offset(voxel, c)) / kFixedOne;
  return body.geometry.world_from_index(at);
}

}  // namespace

OverlapJudge::OverlapJudge(const Body& body) : m_geometry(body.geometry) {
  for (const RigidPiece& piece : body.rigid.list) {
    Bone bone{{}, {}, Vec3i(1 << 20), Vec3i(-(1 << 20)), {}};
    RigidFit fit;
    piece.elements->for_each([&](Slot slot) {
      const Vec3i voxel = voxel_of(body.elements, slot);
      bone.voxels.insert(voxel);
      for (int a = 0; a < 3; ++a) {
        bone.lo[a] = std::min(bone.lo[a], voxel[a]);
        bone.hi[a] = std::max(bone.hi[a], voxel[a]);
      }
      bone.places_mm.push_back(place_of(body, voxel));
      fit.add(bone.places_mm.back(), m_geometry.world_from_index(Vec3d(voxel)));
    });
    bone.back = fit.motion();
    m_bones.push_back(std::move(bone));
  }
}

double OverlapJudge::overlap_in(const Bone& bone, const Vec3d& place_mm) const {
  const Vec3d at = m_geometry.index_from_world(bone.back(place_mm));
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

double OverlapJudge::deepest() const {
  double deepest = 0;
  for (const Bone& bone : m_bones) {
    for (const Vec3d& place : bone.places_mm) {
      for (const Bone& other : m_bones) {
        if (&other != &bone) deepest = std::max(deepest, overlap_in(other, place));
      }
    }
  }
  return deepest;
}

double OverlapJudge::deepest_on_way(const std::vector<std::size_t>& moved, const RigidMotion& way,
                                    int samples, double enough) const {
  std::vector<char> goes(m_bones.size(), 0);
  for (const std::size_t n : moved) goes[n] = 1;
  double deepest = 0;
  for (int sample = 1; sample <= samples && deepest <= enough; ++sample) {
    const RigidMotion so_far = way.part(double(sample) / samples);
    for (const std::size_t n : moved) {
      for (const Vec3d& place : m_bones[n].places_mm) {
        const Vec3d now = so_far(place);
        for (std::size_t other = 0; other < m_bones.size(); ++other) {
          if (goes[other] == 0) deepest = std::max(deepest, overlap_in(m_bones[other], now));
        }
      }
    }
  }
  return deepest;
}

double deepest_overlap(const Body& body) {
  return OverlapJudge(body).deepest();
}

}  // namespace supple
