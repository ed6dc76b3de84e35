#include "volumes/field/dense/nearest_void.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "volumes/base/error.h"
#include "volumes/base/parallel.h"

namespace supple {

namespace {

/// Which of the eight voxels along k of a voxel's brick are active.
unsigned row_of(const BrickTopology& topology, const Vec3i& voxel) {
  const std::int32_t b = topology.find(voxel);
  if (b < 0) return 0;
  return unsigned(topology.mask(std::size_t(b))[voxel.x & 7] >> ((voxel.y & 7) << 3)) & 0xff;
}

constexpr std::int32_t kNone = -1;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMaxWindow = 2147483647.0;

/// Nearest void voxel of every voxel in a window, as its index in the window; i slowest.
class FeatureWindow {
 public:
  FeatureWindow(const IndexBox& box, const Vec3d& spacing_mm, const BrickTopology& source);

  /// Void voxel nearest to `voxel`; false when the window has none.
  bool nearest(const Vec3i& voxel, Vec3i& found) const {
    const std::int32_t feature = m_feature[index(voxel - m_box.lo)];
    if (feature == kNone) return false;
    found = m_box.lo + place(feature);
    return true;
  }
  double distance_squared(const Vec3i& a, const Vec3i& b) const {
    return (Vec3d(a - b) * m_spacing).length2();
  }

 private:
  std::size_t index(const Vec3i& p) const {
    return (std::size_t(p.x) * m_dims.y + p.y) * m_dims.z + p.z;
  }
  Vec3i place(std::int32_t n) const {
    return {n / (m_dims.y * m_dims.z), n / m_dims.z % m_dims.y, n % m_dims.z};
  }
  void fill_rows(const BrickTopology& source);
  void sweep(int axis);
  void sweep_line(int axis, const Vec3i& start);

  IndexBox m_box;
  Vec3i m_dims;
  Vec3d m_spacing;
  std::vector<std::int32_t> m_feature;
};

FeatureWindow::FeatureWindow(const IndexBox& box, const Vec3d& spacing_mm,
                             const BrickTopology& source)
    : m_box(box), m_dims(box.hi - box.lo + Vec3i(1)), m_spacing(spacing_mm) {
  const double count = double(m_dims.x) * m_dims.y * m_dims.z;
  if (count > kMaxWindow) {
    throw InputError({"", "vacated region", std::to_string(count) + " voxels around it",
                      "at most 2^31 for the nearest void voxel"});
  }
  m_feature.assign(std::size_t(count), kNone);
  fill_rows(source);
  sweep(1);
  sweep(0);
}

/// Nearest void voxel in the same row along k, the lower one where two are equally near.
void FeatureWindow::fill_rows(const BrickTopology& source) {
  parallel_for(m_dims.x, [&](int x) {
    for (int y = 0; y < m_dims.y; ++y) {
      const std::size_t row = index({x, y, 0});
      std::int32_t last = kNone;
      unsigned active = 0;  // bit k & 7: of the present brick's row
      for (int z = 0; z < m_dims.z; ++z) {
        const Vec3i voxel = m_box.lo + Vec3i(x, y, z);
        if (z == 0 || (voxel.z & 7) == 0) active = row_of(source, voxel);
        if (!((active >> (voxel.z & 7)) & 1)) last = std::int32_t(row) + z;
        m_feature[row + z] = last;
      }
      last = kNone;
      for (int z = m_dims.z - 1; z >= 0; --z) {
        const std::int32_t here = std::int32_t(row) + z;
        std::int32_t& feature = m_feature[here];
        if (feature == here) last = here;
        if (last != kNone && (feature == kNone || last - here < here - feature)) feature = last;
      }
    }
  });
}

void FeatureWindow::sweep(int axis) {
  const int other = axis == 1 ? 0 : 1;
  parallel_for(m_dims[other], [&](int n) {
    Vec3i start(0);
    start[other] = n;
    for (start.z = 0; start.z < m_dims.z; ++start.z) sweep_line(axis, start);
  });
}

/// Lower envelope of the parabolas height[i] + (s (i - j))^2 of one line.
void FeatureWindow::sweep_line(int axis, const Vec3i& start) {
  const int count = m_dims[axis];
  const double s = m_spacing[axis];
  thread_local std::vector<std::int32_t> feature;
  thread_local std::vector<double> height, from;
  thread_local std::vector<int> apex;
  feature.resize(count);
  height.resize(count);
  from.resize(count);
  apex.resize(count);
  const auto slot = [&](int i) {
    Vec3i p = start;
    p[axis] = i;
    return index(p);
  };

  int hulls = 0;
  for (int i = 0; i < count; ++i) {
    feature[i] = m_feature[slot(i)];
    if (feature[i] == kNone) continue;
    Vec3i p = start;
    p[axis] = i;
    height[i] = distance_squared(place(feature[i]), p);
    // The place at which this parabola undercuts the last one of the envelope.
    double cross = -kInfinity;
    while (hulls > 0) {
      const int j = apex[hulls - 1];
      cross = ((height[i] - height[j]) / (s * s) + double(i) * i - double(j) * j) / (2.0 * (i - j));
      if (cross > from[hulls - 1]) break;
      --hulls;
      cross = -kInfinity;
    }
    apex[hulls] = i;
    from[hulls] = cross;
    ++hulls;
  }
  if (hulls == 0) return;
  for (int i = 0, h = 0; i < count; ++i) {
    while (h + 1 < hulls && from[h + 1] < i) ++h;
    m_feature[slot(i)] = feature[apex[h]];
  }
}

IndexBox grown(const IndexBox& box, int by, const Vec3i& dims) {
  IndexBox result = box;
  for (int a = 0; a < 3; ++a) {
    result.lo[a] = std::max(0, box.lo[a] - by);
    result.hi[a] = std::min(dims[a] - 1, box.hi[a] + by);
  }
  return result;
}

/// Distance in mm from a voxel to the nearest one of the source box beyond the window.
double distance_to_unseen(const Vec3i& voxel, const IndexBox& window, const Vec3i& dims,
                          const Vec3d& spacing_mm) {
  double distance = kInfinity;
  for (int a = 0; a < 3; ++a) {
    if (window.lo[a] > 0) {
      distance = std::min(distance, (voxel[a] - window.lo[a] + 1) * spacing_mm[a]);
    }
    if (window.hi[a] < dims[a] - 1) {
      distance = std::min(distance, (window.hi[a] - voxel[a] + 1) * spacing_mm[a]);
    }
  }
  return distance;
}

BrickTopology clipped(const BrickTopology& topology, const IndexBox& box) {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (std::size_t b = 0; b < topology.brick_count(); ++b) {
    BrickMask mask{};
    for_each_active(topology.mask(b), [&](int offset) {
      if (box.contains(topology.origin(b) + brick_local(offset))) mask_set(mask, offset);
    });
    origins.push_back(topology.origin(b));
    masks.push_back(mask);
  }
  return {std::move(origins), std::move(masks)};
}

/// True when no voxel of the source box is void.
bool is_solid(const BrickTopology& source, const Vec3i& dims) {
  const IndexBox& bounds = source.active_bounds();
  const IndexBox box{Vec3i(0), dims - Vec3i(1)};
  return box.contains(bounds.lo) && box.contains(bounds.hi) &&
         source.active_count() == std::int64_t(dims.x) * dims.y * dims.z;
}

/// Vectors that a window has for the wanted voxels: `exact` when nothing beyond it can be nearer.
struct Attempt {
  BrickVectors vectors;
  bool exact = true;
  bool found_any = false;
};

Attempt look_up(const FeatureWindow& window, const IndexBox& box, const BrickTopology& wanted,
                const Vec3i& dims, const Vec3d& spacing_mm) {
  Attempt attempt;
  attempt.vectors.resize(wanted.brick_count());
  for (std::size_t b = 0; b < wanted.brick_count(); ++b) {
    for_each_active(wanted.mask(b), [&](int offset) {
      const Vec3i voxel = wanted.origin(b) + brick_local(offset);
      const double unseen = distance_to_unseen(voxel, box, dims, spacing_mm);
      Vec3i found;
      if (!window.nearest(voxel, found)) {
        attempt.exact = attempt.exact && unseen == kInfinity;
        return;
      }
      attempt.found_any = true;
      attempt.exact = attempt.exact && window.distance_squared(voxel, found) <= unseen * unseen;
      attempt.vectors.touch(b)[offset] = Vec3f(found - voxel);
    });
  }
  return attempt;
}

}  // namespace

VectorBricks nearest_void(const BrickTopology& source, const BrickTopology& wanted,
                          const Vec3i& dims, const Vec3d& spacing_mm) {
  BrickTopology inside = clipped(wanted, {Vec3i(0), dims - Vec3i(1)});
  if (inside.empty() || is_solid(source, dims)) return {};
  for (int margin = kBrickDim;; margin *= 2) {
    const IndexBox box = grown(inside.active_bounds(), margin, dims);
    const FeatureWindow window(box, spacing_mm, source);
    Attempt attempt = look_up(window, box, inside, dims, spacing_mm);
    if (!attempt.exact) continue;
    if (!attempt.found_any) return {};
    return {std::move(inside), std::move(attempt.vectors)};
  }
}

}  // namespace supple
