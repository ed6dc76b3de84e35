// Small analytic volumes and views that the renderer's tests share.
#pragma once

#include <cmath>
#include <cstring>
#include <functional>

#include "raycast/render.h"
#include "volumes/grid/density_grid.h"

namespace supple {

using DensityFunction = std::function<double(const Vec3d&)>;
using VoxelPredicate = std::function<bool(const Vec3i&)>;

inline Geometry cube_geometry(int size, double spacing_mm = 1) {
  const double s = spacing_mm;
  return {{size, size, size}, Vec3d(-0.5 * s * (size - 1)), {Vec3d(s, 0, 0), {0, s, 0}, {0, 0, s}}};
}

/// All voxels of the box `dims` that satisfy the predicate.
inline BrickTopology voxels_of(const Vec3i& dims, const VoxelPredicate& active) {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (int x = 0; x < dims.x; x += kBrickDim) {
    for (int y = 0; y < dims.y; y += kBrickDim) {
      for (int z = 0; z < dims.z; z += kBrickDim) {
        BrickMask mask{};
        for (int n = 0; n < kBrickVoxels; ++n) {
          const Vec3i voxel = Vec3i(x, y, z) + brick_local(n);
          const bool inside = voxel.x < dims.x && voxel.y < dims.y && voxel.z < dims.z;
          if (inside && active(voxel)) mask_set(mask, n);
        }
        origins.push_back({x, y, z});
        masks.push_back(mask);
      }
    }
  }
  return {origins, masks};
}
/// The same vector at every voxel of the bricks.
inline BrickVectors vectors_of(const BrickTopology& bricks, const Vec3f& vector) {
  return BrickVectors::of(std::vector<Vec3f>(bricks.brick_count() * kBrickVoxels, vector));
}

inline bool everywhere(const Vec3i&) {
  return true;
}

/// `density` sampled at the voxels of `where`.
inline DensityGrid grid_of(const BrickTopology& where, const DensityFunction& density) {
  std::vector<float> values(where.brick_count() * kBrickVoxels);
  for (std::size_t b = 0; b < where.brick_count(); ++b) {
    for_each_active(where.mask(b), [&](int offset) {
      values[b * kBrickVoxels + offset] =
          float(density(Vec3d(where.origin(b) + brick_local(offset))));
    });
  }
  return make_density_grid(where, values, 0);
}

/// A lobed, smooth body of density 0…1000 around `center`, without symmetry.
inline DensityFunction lobed_body(const Vec3d& center, double radius) {
  return [=](const Vec3d& p) {
    const Vec3d d = (p - center) / radius;
    const double bumps = 0.15 * std::sin(5 * d.x + 1) * std::cos(4 * d.y) +
                         0.12 * std::sin(6 * d.z) * std::cos(3 * d.x + 2) + 0.1 * d.x;
    const double t = (1 + bumps - d.length()) * 4;
    return 1000 / (1 + std::exp(-3 * t));
  };
}

/// Opaque from mid density on, with a colour ramp.
inline TransferFunction surface_function() {
  TransferFunction f;
  f.name = "surface";
  f.opacity = {{350, 0}, {650, 0.9}};
  f.colour = {{0, {0.9, 0.7, 0.5}}, {1000, {1, 0.95, 0.9}}};
  return f;
}

/// Constant opacity per mm at every density, white.
inline TransferFunction fog_function(double opacity_per_mm) {
  TransferFunction f;
  f.opacity = {{0, opacity_per_mm}};
  f.colour = {{0, {1, 1, 1}}};
  return f;
}

/// Parallel camera from anterior; right is x, up is z. Its height is `height_mm`: in as many pixels
/// a voxel of cube_geometry has one.
inline Camera front_camera(double height_mm) {
  Camera camera;
  camera.projection = Projection::orthographic;
  camera.position_lps_mm = {0, -200, 0};
  camera.height_mm = height_mm;
  return camera;
}

/// True if all bits are the same, also where both are not a number.
inline bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

inline RenderSettings small_picture(int size, double step_voxels = 0.5) {
  RenderSettings settings;
  settings.width = settings.height = size;
  settings.step_voxels = step_voxels;
  return settings;
}

}  // namespace supple
