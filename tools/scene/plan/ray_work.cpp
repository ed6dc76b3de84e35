#include "tools/scene/plan/ray_work.h"

#include <algorithm>
#include <cmath>

#include "raycast/scene/clip.h"

namespace supple::tools {

namespace {

constexpr int kRays = 48;  // along the longer side of the picture

/// True if some density between these two is not transparent.
bool may_be_seen(const TransferFunction& function, double lo, double hi) {
  if (function.opacity_at(lo) > 0 || function.opacity_at(hi) > 0) return true;
  return std::any_of(function.opacity.begin(), function.opacity.end(), [&](const OpacityKey& key) {
    return key.opacity > 0 && key.density >= lo && key.density <= hi;
  });
}

class RayWork {
 public:
  RayWork(const DensityGrid& density, const Geometry& geometry, const TransferFunction& function,
          const RenderSettings& settings)
      : m_density(density), m_geometry(geometry), m_function(function), m_settings(settings) {
    const BrickTopology& bricks = density.bricks();
    m_seen.resize(bricks.brick_count());
    m_is_read.resize(bricks.brick_count());
    for (std::size_t b = 0; b < bricks.brick_count(); ++b) {
      const auto [lo, hi] =
          std::minmax_element(density.values(b), density.values(b) + kBrickVoxels);
      m_seen[b] = may_be_seen(function, *lo, *hi);
    }
  }

  double samples(const Ray& ray) {
    const IndexRay along{m_geometry.index_from_world(ray.origin_lps_mm),
                         m_geometry.index_vector_from_world(ray.direction_lps)};
    const Vec3d half(0.5);
    const Interval in_box =
        clip_to_box(along, -half, Vec3d(m_geometry.dims()) - half, {0, kEndless});
    const Vec3d& spacing = m_geometry.spacing_mm();
    const double voxel_mm = std::min({spacing.x, spacing.y, spacing.z});
    const double step_mm = voxel_mm / 2;
    const double per_step = step_mm / (m_settings.step_voxels * voxel_mm);
    double samples = 0, light = 1;
    for (double t = in_box.begin; t < in_box.end; t += step_mm) {
      const Vec3i voxel = floor_voxel(along.at(t) + half);
      const std::int32_t b = m_density.bricks().find(voxel);
      if (b < 0 || m_seen[std::size_t(b)] == 0) continue;
      m_is_read[std::size_t(b)] = 1;
      const double opacity =
          m_function.opacity_at(m_density.values(std::size_t(b))[brick_offset(voxel)]);
      samples += opacity > 0 ? per_step : per_step / m_settings.stride;
      light *= std::pow(1 - std::min(opacity, 1.0), step_mm / m_function.unit_distance_mm);
      if (m_function.blend == Blend::composite && 1 - light >= m_settings.early_termination) break;
    }
    return samples;
  }
  double bricks_read() const {
    return double(std::count(m_is_read.begin(), m_is_read.end(), std::uint8_t(1)));
  }

 private:
  const DensityGrid& m_density;
  const Geometry& m_geometry;
  const TransferFunction& m_function;
  const RenderSettings& m_settings;
  std::vector<std::uint8_t> m_seen, m_is_read;  // per brick
};

}  // namespace

PictureWork picture_work(const DensityGrid& density, const Geometry& geometry, const Camera& camera,
                         const TransferFunction& function, const RenderSettings& settings) {
  RayWork work(density, geometry, function, settings);
  const CameraRays rays(camera, settings.width, settings.height);
  const int longer = std::max(settings.width, settings.height);
  const int across = std::max(1, kRays * settings.width / longer);
  const int down = std::max(1, kRays * settings.height / longer);
  double samples = 0;
  for (int y = 0; y < down; ++y) {
    for (int x = 0; x < across; ++x) {
      samples += work.samples(
          rays.at((x + 0.5) * settings.width / across, (y + 0.5) * settings.height / down));
    }
  }
  return {samples / (double(across) * down) * settings.width * settings.height, work.bricks_read()};
}

double slice_pixels(const SliceChoice& slice, const Geometry& geometry) {
  const Vec3d& spacing = geometry.spacing_mm();
  const double pixel_mm = std::min({spacing.x, spacing.y, spacing.z}) / slice.scale;
  const Vec3d sides = Vec3d(geometry.dims()) * spacing / pixel_mm;
  return (sides.x * sides.y + sides.x * sides.z + sides.y * sides.z) * slice.count();
}

}  // namespace supple::tools
