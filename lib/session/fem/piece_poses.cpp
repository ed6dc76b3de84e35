#include "lib/session/fem/piece_poses.h"

#include <algorithm>
#include <cmath>

#include "lib/body/node_offsets.h"

namespace supple {

std::pair<std::int64_t, double> fit_pieces(Body& body) {
  std::int64_t pieces = 0;
  double max_voxels = 0;
  if (body.rigid.empty()) return {pieces, max_voxels};
  NodeOffsets offsets(body);
  for (RigidPiece& piece : body.rigid.list) {
    RigidPiece at_rest = piece;
    at_rest.pose = {};
    const auto deviation = [&](const RigidPiece& posed) {
      const PoseOffsets by_pose(body.geometry, posed);
      double most = 0;
      piece.elements->for_each([&](Slot slot) {
        const auto q = by_pose(voxel_of(body.elements, slot));
        for (int c = 0; c < 3; ++c) {
          const double there = offset_with_fraction(body, c, slot);
          most = std::max(most, std::abs(there - double(q[std::size_t(c)]) / kFixedOne));
        }
      });
      return most;
    };
    if (deviation(piece) == 0) continue;
    RigidFit fit;
    piece.elements->for_each([&](Slot slot) {
      const Vec3d rest(voxel_of(body.elements, slot));
      Vec3d now = rest;
      for (int c = 0; c < 3; ++c) now[c] += offset_with_fraction(body, c, slot);
      fit.add(body.geometry.world_from_index(rest), body.geometry.world_from_index(now));
    });
    piece.pose = moved_by(fit.motion(), at_rest, body.geometry);
    max_voxels = std::max(max_voxels, deviation(piece));
    ++pieces;
    const PoseOffsets by_pose(body.geometry, piece);
    piece.elements->for_each([&](Slot slot) {
      const auto q = by_pose(voxel_of(body.elements, slot));
      for (int c = 0; c < 3; ++c) {
        offsets.set_offset(c, slot, double(q[std::size_t(c)]) / kFixedOne);
      }
    });
  }
  if (pieces > 0) offsets.give(body);
  return {pieces, max_voxels};
}

}  // namespace supple
