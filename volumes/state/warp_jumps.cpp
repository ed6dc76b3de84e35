#include "volumes/state/warp_jumps.h"

#include <algorithm>
#include <cstdio>

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

std::string use_of_warp(VoidMode void_mode, const WarpJumps& jumps) {
  const bool is_smooth = void_mode == VoidMode::extend;
  std::string text = is_smooth ? "smooth beyond the tissue, for points, inversion and registration"
                               : "for resampling images";
  char largest[40];
  std::snprintf(largest, sizeof largest, "%.4g", jumps.largest_mm());
  text += std::string("; neighbouring vectors differ by up to ") + largest + " mm";
  if (jumps.folded_pairs() == 0) return text + ", none fold";
  text += ", " + with_count(jumps.folded_pairs(), "pair") + " of them fold";
  return is_smooth ? text
                   : text +
                         " where tissue meets void (void extend is smooth: for points, "
                         "inversion and registration)";
}

}  // namespace supple
