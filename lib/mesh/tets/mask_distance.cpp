#include "lib/mesh/tets/mask_distance.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lib/mesh/tets/voxel_lines.h"

namespace supple {

namespace {

constexpr int kReachVoxels = 4;  // distances end there
constexpr int kMargin = 2;       // voxels around the box

/// Distance of voxel centres from the surface, at the least, in the smallest voxel size.
constexpr double kLeastDistance = 0.1;

/// One axis of the squared distances to the other side: positive outside, negative inside.
void min_along(const Box<float>& box, int axis, double spacing_mm, double reach_mm) {
  const int radius = std::max(1, int(std::ceil(reach_mm / spacing_mm)));
  const float limit = float(reach_mm * reach_mm);
  for_each_lines(box, axis, radius, [&](const float* source, int width, int length, auto&& line) {
    const int count = axis == 0 ? length : width;
    std::vector<float> outer(static_cast<std::size_t>(count)), inner(outer.size());
    for (int m = 0; m < (axis == 0 ? 1 : length); ++m) {
      std::fill(outer.begin(), outer.end(), limit);
      std::fill(inner.begin(), inner.end(), limit);
      for (int d = -radius; d <= radius; ++d) {
        const float away = float(d * d * spacing_mm * spacing_mm);
        const float* from = source + std::size_t(m + d + radius) * std::size_t(width);
        for (int i = 0; i < count; ++i) {
          outer[std::size_t(i)] = std::min(outer[std::size_t(i)], std::max(from[i], 0.0F) + away);
          inner[std::size_t(i)] = std::min(inner[std::size_t(i)], std::max(-from[i], 0.0F) + away);
        }
      }
      float* out = line(m);
      for (int i = 0; i < count; ++i) {
        out[i] = out[i] > 0 ? outer[std::size_t(i)] : -inner[std::size_t(i)];
      }
    }
  });
}

/// Voxels of parts of fewer than three voxels across, of the set (1) or around it, and those beside
/// them.
VoxelFlags thin_parts(const Vec3i& dims, const VoxelFlags& inside) {
  VoxelFlags thin(inside.size(), 0);
  for (int side = 0; side < 2; ++side) {
    VoxelFlags near(inside.size());
    for_each_value(dims, [&](std::size_t n) { near[n] = inside[n] == side ? 0 : 1; });
    spread(dims, Vec3i(1), near);
    for_each_value(dims, [&](std::size_t n) { near[n] ^= 1U; });  // a voxel inside of all 26
    spread(dims, Vec3i(2), near);
    for_each_value(dims, [&](std::size_t n) {
      thin[n] = std::uint8_t(thin[n] | (inside[n] == side && near[n] == 0 ? 1 : 0));
    });
  }
  spread(dims, Vec3i(1), thin);
  return thin;
}

/// Half of a Gaussian's weights, the middle one first; together they are 1.
std::vector<float> gaussian_weights(double sigma) {
  const int radius = int(std::ceil(3 * sigma));
  std::vector<double> weights;
  for (int d = 0; d <= radius; ++d) weights.push_back(std::exp(-d * d / (2 * sigma * sigma)));
  const double sum = 2 * std::accumulate(weights.begin(), weights.end(), 0.0) - weights[0];
  std::vector<float> floats;
  for (const double weight : weights) floats.push_back(float(weight / sum));
  return floats;
}

void blur_along(const Box<float>& box, int axis, const std::vector<float>& weights) {
  const int radius = int(weights.size()) - 1;
  for_each_lines(box, axis, radius, [&](const float* source, int width, int length, auto&& line) {
    const int count = axis == 0 ? length : width;
    for (int m = 0; m < (axis == 0 ? 1 : length); ++m) {
      float* out = line(m);
      std::fill_n(out, count, 0.0F);
      for (int d = -radius; d <= radius; ++d) {
        const float weight = weights[std::size_t(std::abs(d))];
        const float* from = source + std::size_t(m + d + radius) * std::size_t(width);
        for (int i = 0; i < count; ++i) out[i] += weight * from[i];
      }
    }
  });
}

}  // namespace

MaskDistance::MaskDistance(const VoxelMask& mask, double sigma_voxels, Progress* progress)
    : m_lo(mask.box.lo - Vec3i(kMargin)), m_dims(mask.dims() + Vec3i(2 * kMargin)) {
  stage(progress, "distances");
  const Vec3d spacing = mask.geometry.spacing_mm();
  m_reach = kReachVoxels * std::cbrt(spacing.x * spacing.y * spacing.z);
  find_distances(mask, spacing);
  poll(progress);
  const double least = kLeastDistance * std::min({spacing.x, spacing.y, spacing.z});
  if (sigma_voxels > 0) smooth(sigma_voxels, least);
}

void MaskDistance::find_distances(const VoxelMask& mask, const Vec3d& spacing_mm) {
  const float limit = float(m_reach * m_reach);
  m_values.assign(std::size_t(m_dims.x) * std::size_t(m_dims.y) * std::size_t(m_dims.z), limit);
  const Box<float> box{m_dims, m_values};
  const Vec3i dims = mask.dims();
  parallel_for(dims.z, [&](int k) {
    for (int j = 0; j < dims.y; ++j) {
      const std::uint8_t* from =
          mask.inside.data() + (std::size_t(k) * std::size_t(dims.y) + std::size_t(j)) * dims.x;
      float* out = box.row(j + kMargin, k + kMargin) + kMargin;
      for (int i = 0; i < dims.x; ++i) out[i] = from[i] != 0 ? -limit : limit;
    }
  });
  // A voxel of the other side is at distance 0 along an axis; max() and the signs say so.
  for (int axis = 0; axis < 3; ++axis) min_along(box, axis, spacing_mm[axis], m_reach);
  const float half = float(0.5 * std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z}));
  parallel_for(m_dims.z, [&](int k) {
    float* values = box.row(0, k);
    for (int n = 0; n < m_dims.x * m_dims.y; ++n) {
      values[n] = std::copysign(std::sqrt(std::abs(values[n])) - half, values[n]);
    }
  });
  m_reach -= half;
}

void MaskDistance::smooth(double sigma_voxels, double least_mm) {
  const std::vector<float> weights = gaussian_weights(sigma_voxels);
  const std::vector<float> sharp = m_values;
  VoxelFlags is_inside(sharp.size());
  for_each_value(m_dims, [&](std::size_t n) { is_inside[n] = sharp[n] < 0 ? 1 : 0; });
  const VoxelFlags thin = thin_parts(m_dims, is_inside);
  std::vector<float> once;
  for (int pass = 0; pass < 2; ++pass) {
    for (int axis = 0; axis < 3; ++axis) blur_along({m_dims, m_values}, axis, weights);
    if (pass == 0) once = m_values;
  }
  const float least = float(least_mm), reach = float(m_reach);
  for_each_value(m_dims, [&](std::size_t n) {
    const float value = thin[n] != 0 ? sharp[n] : 2 * once[n] - m_values[n];
    m_values[n] =
        is_inside[n] != 0 ? std::clamp(value, -reach, -least) : std::clamp(value, least, reach);
  });
}

double MaskDistance::at(const Vec3d& index) const {
  const double x = index.x - m_lo.x, y = index.y - m_lo.y, z = index.z - m_lo.z;
  if (!(x >= 0 && y >= 0 && z >= 0 && x <= m_dims.x - 1 && y <= m_dims.y - 1 &&
        z <= m_dims.z - 1)) {
    return m_reach;
  }
  const int i = std::min(int(x), m_dims.x - 2), j = std::min(int(y), m_dims.y - 2),
            k = std::min(int(z), m_dims.z - 2);
  const double u = x - i, v = y - j, w = z - k;
  const std::size_t line = std::size_t(m_dims.x), slice = line * std::size_t(m_dims.y);
  const float* at = m_values.data() + slice * std::size_t(k) + line * std::size_t(j) + i;
  const auto along = [u](const float* a) { return a[0] + u * (double(a[1]) - a[0]); };
  const double low = along(at) + v * (along(at + line) - along(at));
  const double high = along(at + slice) + v * (along(at + slice + line) - along(at + slice));
  return low + w * (high - low);
}

}  // namespace supple
