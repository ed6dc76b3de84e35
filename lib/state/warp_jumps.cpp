#include "lib/state/warp_jumps.h"

#include <algorithm>
#include <cstdio>

#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple {

WarpJumps::WarpJumps(const Geometry& grid) : m_grid(grid) {}

void WarpJumps::add(const Vec3f* slice) {
  const Vec3i& dims = m_grid.dims();
  const std::size_t count = std::size_t(dims.x) * dims.y;
  for (int axis = 0; axis < 3; ++axis) {
    if (axis == 2 && m_below.empty()) continue;
    const Vec3d axis_mm = m_grid.axes_mm()[axis];
    const double step_mm = axis_mm.length();
    const Vec3d along = axis_mm / step_mm;
    const std::size_t back = axis == 0 ? 1 : axis == 1 ? std::size_t(dims.x) : 0;
    for (std::size_t n = back; n < count; ++n) {
      if (axis == 0 && n % std::size_t(dims.x) == 0) continue;
      const Vec3d jump = Vec3d(slice[n]) - Vec3d(axis == 2 ? m_below[n] : slice[n - back]);
      m_largest_mm = std::max(m_largest_mm, jump.length());
      m_folded += jump.dot(along) <= -step_mm;
    }
  }
  m_below.assign(slice, slice + count);
}

void WarpJumps::add_pair(const Vec3f& lower, const Vec3f& upper, int axis) {
  const Vec3d axis_mm = m_grid.axes_mm()[axis];
  const double step_mm = axis_mm.length();
  const Vec3d jump = Vec3d(upper) - Vec3d(lower);
  m_largest_mm = std::max(m_largest_mm, jump.length());
  m_folded += jump.dot(axis_mm / step_mm) <= -step_mm;
}

/// Pairs of which one voxel at least lies in a brick that is stored.
void WarpJumps::add(const VectorBricks& vectors_mm) {
  const IndexBox box{Vec3i(0), m_grid.dims() - Vec3i(1)};
  const BrickTopology& bricks = vectors_mm.topology;
  const auto vector_at = [&](const Vec3i& voxel) {
    Vec3f vector(0);
    vectors_mm.at(voxel, vector);
    return vector;
  };
  for (std::size_t b = 0; b < bricks.brick_count(); ++b) {
    for (int n = 0; n < kBrickVoxels; ++n) {
      const Vec3i voxel = bricks.origin(b) + brick_local(n);
      if (!box.contains(voxel)) continue;
      const Vec3f own = vectors_mm.vectors.brick_or_zero(b)[n];
      for (int axis = 0; axis < 3; ++axis) {
        Vec3i upper = voxel, lower = voxel;
        ++upper[axis];
        --lower[axis];
        if (box.contains(upper)) add_pair(own, vector_at(upper), axis);
        // The pair with a lower voxel whose brick is not stored is counted nowhere else.
        if (box.contains(lower) && bricks.find(lower) < 0) add_pair(Vec3f(0), own, axis);
      }
    }
  }
}

std::string use_of_warp(VoidMode void_mode, const WarpJumps& jumps) {
  const bool is_smooth = void_mode == VoidMode::extend;
  std::string text = is_smooth ? "smooth beyond the tissue, for points, inversion and registration"
                               : "for resampling images";
  text += "; neighbouring vectors differ by up to " + number_text(jumps.largest_mm(), 4) + " mm";
  if (jumps.folded_pairs() == 0) return text + ", none fold";
  text += ", " + with_count(jumps.folded_pairs(), "pair") + " of them fold";
  return is_smooth ? text
                   : text +
                         " where tissue meets void (void extend is smooth: for points, "
                         "inversion and registration)";
}

}  // namespace supple
