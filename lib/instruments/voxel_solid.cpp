#include "lib/instruments/voxel_solid.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/parallel.h"

namespace supple {

namespace {

constexpr int kMargin = 3;     // voxels of the box around the solid
constexpr float kFar = 1e12F;  // mm², of a line without a source
constexpr double kInfinity = 1e30;

/// Lower envelope of parabolas along one line: squares of distances from where `squares` is 0.
class LineTransform {
 public:
  explicit LineTransform(std::size_t length) : m_at(length), m_from(length + 1), m_values(length) {}

  void run(float* squares, std::size_t stride, int length, double step_mm) {
    for (int n = 0; n < length; ++n) m_values[std::size_t(n)] = squares[std::size_t(n) * stride];
    const auto crossing = [&](int a, int b) {
      const auto of = [&](int n) {
        return m_values[std::size_t(n)] + step_mm * step_mm * double(n) * n;
      };
      return (of(b) - of(a)) / (2 * step_mm * step_mm * (b - a));
    };
    std::size_t last = 0;
    m_at[0] = 0;
    m_from[0] = -kInfinity;
    for (int n = 1; n < length; ++n) {
      double from = crossing(m_at[last], n);
      while (from <= m_from[last]) from = crossing(m_at[--last], n);
      m_at[++last] = n;
      m_from[last] = from;
    }
    m_from[last + 1] = kInfinity;
    std::size_t piece = 0;
    for (int n = 0; n < length; ++n) {
      while (m_from[piece + 1] < n) ++piece;
      const double way = step_mm * (n - m_at[piece]);
      squares[std::size_t(n) * stride] =
          float(std::min(double(kFar), m_values[std::size_t(m_at[piece])] + way * way));
    }
  }

 private:
  std::vector<int> m_at;
  std::vector<double> m_from, m_values;
};

/// Squares of distances from the places that are 0, along all axes; i is fastest in memory.
void transform(std::vector<float>& squares, const Vec3i& dims, const Vec3d& spacing_mm) {
  const std::array<std::size_t, 3> strides = {1, std::size_t(dims.x),
                                              std::size_t(dims.x) * std::size_t(dims.y)};
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    parallel_for(std::size_t(dims[v]), [&](std::size_t second) {
      LineTransform line{std::size_t(dims[axis])};
      for (int first = 0; first < dims[u]; ++first) {
        float* begin = squares.data() + std::size_t(first) * strides[std::size_t(u)] +
                       second * strides[std::size_t(v)];
        line.run(begin, strides[std::size_t(axis)], dims[axis], spacing_mm[axis]);
      }
    });
  }
}

/// The box of the voxels with a margin: its first voxel and its dimensions.
IndexBox box_around(const std::vector<Vec3i>& voxels) {
  IndexBox box{voxels.front(), voxels.front()};
  for (const Vec3i& voxel : voxels) {
    for (int c = 0; c < 3; ++c) {
      box.lo[c] = std::min(box.lo[c], voxel[c]);
      box.hi[c] = std::max(box.hi[c], voxel[c]);
    }
  }
  return {box.lo - Vec3i(kMargin), box.hi + Vec3i(kMargin)};
}

}  // namespace

VoxelSolid::VoxelSolid(const Geometry& geometry, const std::vector<Vec3i>& voxels) {
  const IndexBox box = box_around(voxels);
  const Vec3i dims = box.hi - box.lo + Vec3i(1);
  m_geometry = Geometry(dims, geometry.world_from_index(Vec3d(box.lo)), geometry.axes_mm());
  const std::size_t count = std::size_t(m_geometry.voxel_count());
  std::vector<float> outside(count, kFar), inside(count, 0);
  for (const Vec3i& voxel : voxels) {
    const Vec3i at = voxel - box.lo;
    const std::size_t n =
        std::size_t(at.x) +
        std::size_t(dims.x) * (std::size_t(at.y) + std::size_t(dims.y) * std::size_t(at.z));
    outside[n] = 0;
    inside[n] = kFar;
  }
  const Vec3d spacing = geometry.spacing_mm();
  transform(outside, dims, spacing);
  transform(inside, dims, spacing);
  const float half = float(std::min({spacing.x, spacing.y, spacing.z}) / 2);
  for (std::size_t n = 0; n < count; ++n) {
    outside[n] = outside[n] > 0 ? std::sqrt(outside[n]) - half : half - std::sqrt(inside[n]);
  }
  m_distances = std::make_shared<const std::vector<float>>(std::move(outside));
}

Approach VoxelSolid::distance_to(const Vec3d& place_mm) const {
  const Vec3d index = m_geometry.index_from_world(place_mm);
  const Vec3i& dims = m_geometry.dims();
  Vec3d in = index, part;
  Vec3i low;
  for (int c = 0; c < 3; ++c) {
    in[c] = std::clamp(index[c], 0.0, double(dims[c] - 1));
    low[c] = std::min(int(in[c]), dims[c] - 2);
    part[c] = in[c] - low[c];
  }
  const std::size_t row = std::size_t(dims.x), slab = row * std::size_t(dims.y);
  const float* v = m_distances->data() + std::size_t(low.x) + std::size_t(low.y) * row +
                   std::size_t(low.z) * slab;
  const auto mix = [](double a, double b, double t) { return a + (b - a) * t; };
  const auto along_x = [&](std::size_t at) { return mix(v[at], v[at + 1], part.x); };
  const double y0 = mix(along_x(0), along_x(row), part.y);
  const double y1 = mix(along_x(slab), along_x(slab + row), part.y);
  const auto slope_x = [&](std::size_t at) { return double(v[at + 1]) - v[at]; };
  const Vec3d gradient(mix(mix(slope_x(0), slope_x(row), part.y),
                           mix(slope_x(slab), slope_x(slab + row), part.y), part.z),
                       mix(along_x(row) - along_x(0), along_x(slab + row) - along_x(slab), part.z),
                       y1 - y0);
  Vec3d normal = m_geometry.world_gradient_from_index(gradient);
  normal = normal.length() > 0 ? normal.normalized() : Vec3d(0, 0, 1);
  double distance_mm = mix(y0, y1, part.z);
  const Vec3d beyond = m_geometry.world_vector_from_index(index - in);
  if (beyond.length2() > 0) {
    normal = (normal * distance_mm + beyond).normalized();
    distance_mm = std::sqrt(distance_mm * distance_mm + beyond.length2());
  }
  return {distance_mm, place_mm - normal * distance_mm, normal};
}

}  // namespace supple
