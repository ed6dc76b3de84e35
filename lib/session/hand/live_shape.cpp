#include "lib/session/hand/live_shape.h"

#include <cstdint>

#include "lib/body/slot_set.h"
#include "volumes/base/parallel.h"

namespace supple {

namespace {

/// Rounds without a call.
std::int64_t nearest(double value) {
  return std::int64_t(value + (value < 0 ? -0.5 : 0.5));
}

}  // namespace

LiveShape::LiveShape(const Body& body)
    : m_geometry(body.geometry), m_elements(body.elements), m_rigid(body.rigid) {
  std::size_t count = 0;
  for (std::size_t b = 0; b < m_elements.brick_count(); ++b) {
    m_begin.push_back(count);
    for_each_active(m_elements.mask(b), [&](int) { ++count; });
  }
  m_begin.push_back(count);
}

void LiveShape::put(const LiveResponses& responses, const LivePose& pose, BodyShape& shape) const {
  std::vector<PoseOffsets> offsets;
  const std::vector<RigidPose> poses = responses.piece_poses(pose);
  for (std::size_t n = 0; n < poses.size(); ++n) {
    RigidPiece piece = m_rigid.list[n];
    piece.pose = poses[n];
    offsets.emplace_back(m_geometry, piece);
  }
  for (BrickValues& values : shape) values.touch_all();
  parallel_for(int(m_elements.brick_count()), [&](int brick) {
    const std::size_t b = std::size_t(brick);
    std::array<Vec3f, kBrickVoxels> u;
    responses.displacements(pose, m_begin[b], m_begin[b + 1], u.data());
    std::size_t n = 0;
    std::array<std::int32_t*, 3> out;
    for (std::size_t c = 0; c < 3; ++c) out[c] = shape[c].touch(b);
    for_each_active(m_elements.mask(b), [&](int offset) {
      const Vec3d index = m_geometry.index_vector_from_world(Vec3d(u[n++]));
      const Slot slot = Slot(b * kBrickVoxels + std::size_t(offset));
      const int piece = m_rigid.at(slot);
      std::array<std::int64_t, 3> by_piece{};
      if (piece >= 0) by_piece = offsets[std::size_t(piece)](voxel_of(m_elements, slot));
      for (std::size_t c = 0; c < 3; ++c) {
        const std::int64_t q =
            piece >= 0 ? by_piece[c] : nearest(index[int(c)] * double(kFixedOne));
        out[c][offset] = std::int32_t(q);
      }
    });
  });
}

void LiveShape::put_between(const BodyShape& from, const BodyShape& aim, double part,
                            BodyShape& shape) const {
  for (BrickValues& values : shape) values.touch_all();
  parallel_for(int(m_elements.brick_count()), [&](int brick) {
    const std::size_t b = std::size_t(brick);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::int32_t* const begin = from[c].brick_or_zero(b);
      const std::int32_t* const end = aim[c].brick_or_zero(b);
      std::int32_t* const out = shape[c].touch(b);
      for (int n = 0; n < kBrickVoxels; ++n) {
        const double way = double(end[n]) - double(begin[n]);
        out[n] = begin[n] + std::int32_t(nearest(part * way));
      }
    }
  });
}

}  // namespace supple
