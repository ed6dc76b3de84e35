#include "volumes/field/points/carried_displacement.h"

#include <algorithm>
#include <cmath>

#include "volumes/field/inversion/source_cells.h"
#include "volumes/grid/cell.h"

namespace supple {

namespace {

// The displacement is constant long before that; voxels.
constexpr double kFarthestCarried = 1e8;

Vec3d clamped(Vec3d X) {
  for (int a = 0; a < 3; ++a) X[a] = std::clamp(X[a], -kFarthestCarried, kFarthestCarried);
  return X;
}

double depth_at(const CutPiece& piece, const Vec3d& t) {
  double sum = 0;
  for (int n = 0; n < 8; ++n) {
    sum += double(piece.depth[std::size_t(n)]) *
           ((n & 4 ? t.x : 1 - t.x) * (n & 2 ? t.y : 1 - t.y) * (n & 1 ? t.z : 1 - t.z));
  }
  return sum;
}

}  // namespace

CarriedDisplacement::CarriedDisplacement(const Displacement& displacement, const CutElements& body)
    : m_dims(displacement.geometry.dims()), m_u(thickened(displacement.u, m_dims)), m_smooth(m_u) {
  if (body.cuts.empty()) return;
  const CutBody cut(displacement.u, body.elements, body.cuts, displacement.geometry.dims());
  TornCells torn(cut.cells());
  torn.follow(m_u, cut, all_bricks(cut.cells()), {}, kClosedCut);
  CutFaces faces(cut.cells(), displacement.geometry, kClosedCut);
  faces.follow(torn, cut, all_bricks(cut.cells()));
  for (std::size_t b = 0; b < cut.cells().brick_count(); ++b) tear(torn.in(b), faces);
}

void CarriedDisplacement::tear(const std::vector<TornCell>& torn, const CutFaces& faces) {
  for (const TornCell& cell : torn) {
    std::vector<CutPiece>& sides = m_sides[cell.cell];
    for (int side = 0; side < cell.sides.count; ++side) {
      sides.emplace_back(cell.cell, cell.u[std::size_t(side)], faces.depths_of_corners(cell, side));
    }
  }
}

/// Corners without weight do not count.
bool CarriedDisplacement::is_known(const Vec3i& voxel, const Vec3d& t) const {
  for (int n = 0; n < 8; ++n) {
    const Vec3i step(n >> 2, n >> 1 & 1, n & 1);
    bool has_weight = true;
    for (int a = 0; a < 3; ++a) has_weight = has_weight && (step[a] == 0 || t[a] > 0);
    if (has_weight && !m_u.topology.is_active(voxel + step)) return false;
  }
  return true;
}

bool CarriedDisplacement::cell(const Vec3i& voxel, TrilinearCell& cell) const {
  for (int n = 0; n < 8; ++n) cell.u[n] = m_smooth.at(voxel + Vec3i(n >> 2, n >> 1 & 1, n & 1));
  return true;
}

bool CarriedDisplacement::cell_at(const Vec3d& X, Vec3i& voxel, TrilinearCell& cell) const {
  voxel = floor_voxel(clamped(X));
  return this->cell(voxel, cell);
}

CellPlace CarriedDisplacement::stretched(const Vec3d& X) const {
  Vec3i voxel;
  TrilinearCell cell;
  cell_at(X, voxel, cell);
  return cell.at(clamped(X) - Vec3d(voxel));
}

bool CarriedDisplacement::is_in_torn_cell(const Vec3d& X) const {
  return has_torn_cells() && m_sides.count(floor_voxel(clamped(X))) != 0;
}

CarriedDisplacement::Place CarriedDisplacement::at(const Vec3d& X) const {
  const Vec3d near = clamped(X);
  const Vec3i voxel = floor_voxel(near);
  const Vec3d t = near - Vec3d(voxel);
  Place place;
  TrilinearCell corners;
  cell(voxel, corners);
  const auto torn = m_sides.find(voxel);
  if (torn != m_sides.end()) {
    double deepest = -HUGE_VAL;
    for (const CutPiece& side : torn->second) {
      const double depth = depth_at(side, t);
      if (depth <= deepest) continue;
      deepest = depth;
      for (int n = 0; n < 8; ++n) corners.u[n] = Vec3d(side.u[std::size_t(n)]);
    }
    place.is_torn = deepest < 0;
  } else {
    const Vec3d inside = within_border(near, m_dims);
    const Vec3i known = floor_voxel(inside);
    place.is_known = is_known(known, inside - Vec3d(known));
  }
  static_cast<CellPlace&>(place) = corners.at(t);
  place.is_folded = corners.is_folded();
  return place;
}

}  // namespace supple
