#include "raycast/microscope/deformed_haze.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "raycast/microscope/haze_lanes.h"
#include "raycast/microscope/haze_nodes.h"
#include "volumes/base/error.h"
#include "volumes/base/parallel.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

constexpr int kPacketWidth = 4;  // of pixels, and height
static_assert(kPacketWidth * kPacketWidth == HazeRays::kMost);

void check_geometry(const Geometry& geometry) {
  const Vec3d h = geometry.spacing_mm();
  const double widest = std::max({h.x, h.y, h.z}), least = std::min({h.x, h.y, h.z});
  require(geometry.is_orthogonal() && widest <= least * (1 + 1e-6), "spacing of a haze", widest,
          "perpendicular axes, evenly spaced");
  const Vec3i& dims = geometry.dims();
  const int fewest = std::min({dims.x, dims.y, dims.z});
  require(fewest >= 2, "voxels of a haze along an axis", fewest, "2 or more");
}

void check_look(const HazeLook& look) {
  require(look.extinction_per_mm > 0, "extinction of a haze", look.extinction_per_mm,
          "a positive number per mm");
  require(look.largest_density > 0, "largest density of a haze", look.largest_density,
          "a positive number");
  require(look.half_mm > 0, "distance at which light halves", look.half_mm, "a positive length");
  require(look.step_voxels > 0, "step in a haze", look.step_voxels, "a positive number of voxels");
}

/// Part of a ray in the box from 0 to `most`, along which it goes forwards; false: none.
bool clip(const Vec3d& origin, const Vec3d& direction, const Vec3d& most, double& from,
          double& to) {
  for (int c = 0; c < 3; ++c) {
    if (direction[c] == 0) {
      if (origin[c] < 0 || origin[c] > most[c]) return false;
      continue;
    }
    const double a = -origin[c] / direction[c], b = (most[c] - origin[c]) / direction[c];
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  return to > from;
}

}  // namespace

struct DeformedHaze::Impl {
  explicit Impl(const HazeLook& given) : look(given) { check_look(look); }

  HazeLight light_now() const;
  void set_ray(const Ray& ray, double end_mm, int lane, HazeRays& rays) const;
  void draw_packet(const CameraRays& camera, const RayDepths& depths, const PixelTile& tile,
                   const HazeLight& light, FloatImage& picture) const;

  HazeLook look;
  Geometry geometry;
  HazeNodes nodes;
  LampLight lamp;
};

HazeLight DeformedHaze::Impl::light_now() const {
  const double h = geometry.spacing_mm().x;
  HazeLight light;
  light.extinction = float(look.extinction_per_mm * h);
  light.ambient = float(look.ambient);
  if (!lamp.is_on) return light;
  light.power = float(look.lamp * lamp.power);
  light.place = Vec3f(geometry.index_from_world(lamp.place_mm));
  light.direction = Vec3f(geometry.index_vector_from_world(lamp.direction).normalized());
  light.outer_cosine = float(std::cos(lamp.cone_degrees * kRadiansPerDegree));
  const double inner = std::max(0.0, lamp.cone_degrees - lamp.edge_degrees);
  light.inner_cosine = float(std::cos(inner * kRadiansPerDegree));
  light.half_square = float(look.half_mm * look.half_mm / (h * h));
  return light;
}

/// Samples lie in the middles of equal steps over the part of the ray in the box.
void DeformedHaze::Impl::set_ray(const Ray& ray, double end_mm, int lane, HazeRays& rays) const {
  const Vec3d origin = geometry.index_from_world(ray.origin_lps_mm);
  const Vec3d direction = geometry.index_vector_from_world(ray.direction_lps);  // per mm
  double from = 0, to = end_mm;
  rays.count[lane] = 0;
  if (!clip(origin, direction, Vec3d(geometry.dims() - Vec3i(1)), from, to)) return;
  const double voxels = (to - from) * direction.length();
  const double count = std::ceil(voxels / look.step_voxels);
  const Vec3d start = origin + direction * from;
  for (int c = 0; c < 3; ++c) {
    rays.origin[c][lane] = float(start[c]);
    rays.step[c][lane] = float(direction[c] * ((to - from) / count));
  }
  rays.length[lane] = float(voxels / count);
  rays.count[lane] = float(count);
}

void DeformedHaze::Impl::draw_packet(const CameraRays& camera, const RayDepths& depths,
                                     const PixelTile& tile, const HazeLight& light,
                                     FloatImage& picture) const {
  HazeRays rays{};
  const auto for_each_pixel = [&](const auto& visit) {
    for (int y = tile.row_begin; y < tile.row_end; ++y) {
      for (int x = tile.column_begin; x < tile.column_end; ++x) {
        const int lane = (y - tile.row_begin) * kPacketWidth + x - tile.column_begin;
        visit(x, y, std::size_t(y) * std::size_t(picture.width) + std::size_t(x), lane);
      }
    }
  };
  for_each_pixel([&](int x, int y, std::size_t pixel, int lane) {
    set_ray(camera.at(x + 0.5, y + 0.5), double(depths.mm[pixel]), lane, rays);
  });
  march_haze(nodes.tables(), light, rays);
  for_each_pixel([&](int, int, std::size_t pixel, int lane) {
    float* rgba = picture.rgba.data() + 4 * pixel;
    for (std::size_t c = 0; c < 3; ++c) rgba[c] = float(look.rgb[c]) * rays.light[lane];
    rgba[3] = 1 - rays.passes[lane];
  });
}

DeformedHaze::DeformedHaze(const HazeLook& look) : m_impl(std::make_unique<Impl>(look)) {}
DeformedHaze::~DeformedHaze() = default;

void DeformedHaze::set_body(const Geometry& geometry, const DensityGrid& density) {
  check_geometry(geometry);
  m_impl->geometry = geometry;
  m_impl->nodes = HazeNodes(geometry.dims(), density, m_impl->look.largest_density);
}

void DeformedHaze::update(const std::vector<HazeElements>& bricks) {
  m_impl->nodes.follow(bricks);
}

void DeformedHaze::set_light(const LampLight& lamp) {
  m_impl->lamp = lamp;
}

FloatImage DeformedHaze::draw(const Camera& camera, const RayDepths& depths) {
  FloatImage picture(depths.width, depths.height);
  if (m_impl->nodes.tables().offsets.empty()) return picture;
  const CameraRays rays(camera, depths.width, depths.height);
  const HazeLight light = m_impl->light_now();
  parallel_tiles(depths.height, depths.width, Grain{32}, [&](const PixelTile& tile) {
    for (int y = tile.row_begin; y < tile.row_end; y += kPacketWidth) {
      for (int x = tile.column_begin; x < tile.column_end; x += kPacketWidth) {
        m_impl->draw_packet(rays, depths,
                            {y, std::min(y + kPacketWidth, tile.row_end), x,
                             std::min(x + kPacketWidth, tile.column_end)},
                            light, picture);
      }
    }
  });
  return picture;
}

}  // namespace supple
