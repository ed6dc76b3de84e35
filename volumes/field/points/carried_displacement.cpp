#include "volumes/field/points/carried_displacement.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

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
    const Vec3i step = cell_corner(n);
    bool has_weight = true;
    for (int a = 0; a < 3; ++a) has_weight = has_weight && (step[a] == 0 || t[a] > 0);
    if (has_weight && !m_u.topology.is_active(voxel + step)) return false;
  }
  return true;
}

/// One step beyond the border of the volume it goes on linearly, along each axis that leaves, as
/// the border voxels do for half of that.
Vec3d CarriedDisplacement::at_node(const Vec3i& voxel) const {
  Vec3i border = voxel;
  for (int a = 0; a < 3; ++a) {
    if (m_dims[a] > 1) border[a] = std::clamp(voxel[a], 0, m_dims[a] - 1);
  }
  const Vec3i out = voxel - border;
  const int steps = std::max({std::abs(out.x), std::abs(out.y), std::abs(out.z)});
  if (steps != 1) return m_smooth.at(voxel);
  Vec3d sum(0);
  for (int n = 0; n < kCellCorners; ++n) {
    const Vec3i inwards = cell_corner(n);
    double weight = 1;
    for (int a = 0; a < 3; ++a)
      weight *= inwards[a] != 0 ? (out[a] == 0 ? 0 : -1) : 1 + (out[a] != 0);
    Vec3f u;
    if (weight == 0) continue;
    if (!m_u.at(border - out * inwards, u)) return m_smooth.at(voxel);
    sum += Vec3d(u) * weight;
  }
  return sum;
}

bool CarriedDisplacement::cell(const Vec3i& voxel, TrilinearCell& cell) const {
  for (int n = 0; n < kCellCorners; ++n) cell.u[n] = at_node(voxel + cell_corner(n));
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

/// The cell around a place. Those at the border of the volume go on for half a voxel, as the voxels
/// there do.
Vec3i CarriedDisplacement::cell_around(const Vec3d& X) const {
  Vec3i cell = floor_voxel(X);
  for (int a = 0; a < 3; ++a) {
    const int last = m_dims[a] - 1;
    const bool is_near = X[a] >= -kBeyondBorder && X[a] <= last + kBeyondBorder;
    if (last > 0 && is_near) cell[a] = std::clamp(cell[a], 0, last - 1);
  }
  return cell;
}

bool CarriedDisplacement::is_in_torn_cell(const Vec3d& X) const {
  return has_torn_cells() && m_sides.count(cell_around(clamped(X))) != 0;
}

CarriedDisplacement::Place CarriedDisplacement::at(const Vec3d& X) const {
  const Vec3d near = clamped(X);
  Vec3i voxel = floor_voxel(near);
  const auto torn = m_sides.find(cell_around(near));
  if (torn != m_sides.end()) voxel = torn->first;
  const Vec3d t = near - Vec3d(voxel);
  Place place;
  TrilinearCell corners;
  cell(voxel, corners);
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
