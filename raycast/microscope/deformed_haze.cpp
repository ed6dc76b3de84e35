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

constexpr double kApartVoxels = 0.5;  // of rays between which a haze is interpolated, at most
constexpr double kAlikeVoxels = 0.5;  // by which the ends of such rays differ, at most

/// Depth of the pixel, or of the last one before it.
float depth_at(const RayDepths& depths, int x, int y) {
  const int column = std::min(x, depths.width - 1), row = std::min(y, depths.height - 1);
  return depths.mm[std::size_t(row) * std::size_t(depths.width) + std::size_t(column)];
}

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

  /// A ray, where it ends, and where its colour goes.
  struct Spot {
    Ray ray;
    float end_mm;
    float* rgba;
  };

  HazeLight light_now() const;
  void set_ray(const Ray& ray, double end_mm, int lane, HazeRays& rays) const;
  void march(const Spot* spots, int count, const HazeLight& light) const;
  int stride_of(const CameraRays& camera, const RayDepths& depths) const;
  FloatImage march_lattice(const CameraRays& camera, const RayDepths& depths, int stride,
                           const HazeLight& light) const;
  void fill_row(const CameraRays& camera, const RayDepths& depths, int stride,
                const FloatImage& lattice, int y, const HazeLight& light,
                FloatImage& picture) const;

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

void DeformedHaze::Impl::march(const Spot* spots, int count, const HazeLight& light) const {
  HazeRays rays{};
  for (int n = 0; n < count; ++n) set_ray(spots[n].ray, double(spots[n].end_mm), n, rays);
  march_haze(nodes.tables(), light, rays);
  for (int n = 0; n < count; ++n) {
    for (std::size_t c = 0; c < 3; ++c) spots[n].rgba[c] = float(look.rgb[c]) * rays.light[n];
    spots[n].rgba[3] = 1 - rays.passes[n];
  }
}

/// Pixels from one marched ray to the next, so that these are less than half a voxel apart.
int DeformedHaze::Impl::stride_of(const CameraRays& camera, const RayDepths& depths) const {
  const double x = depths.width / 2.0, y = depths.height / 2.0;
  const Ray ray = camera.at(x, y), next = camera.at(x, y + 1);
  const Vec3d middle = geometry.world_from_index(Vec3d(geometry.dims() - Vec3i(1)) / 2.0);
  const double away_mm = (middle - ray.origin_lps_mm).length();
  const Vec3d apart =
      next.origin_lps_mm - ray.origin_lps_mm + (next.direction_lps - ray.direction_lps) * away_mm;
  const double pixel = apart.length() / geometry.spacing_mm().x;  // voxels
  return pixel * 4 < kApartVoxels ? 4 : pixel * 2 < kApartVoxels ? 2 : 1;
}

FloatImage DeformedHaze::Impl::march_lattice(const CameraRays& camera, const RayDepths& depths,
                                             int stride, const HazeLight& light) const {
  const auto points = [&](int pixels) { return stride == 1 ? pixels : (pixels - 1) / stride + 2; };
  FloatImage lattice(points(depths.width), points(depths.height));
  parallel_tiles(lattice.height, lattice.width, Grain{32}, [&](const PixelTile& tile) {
    for (int top = tile.row_begin; top < tile.row_end; top += kPacketWidth) {
      for (int left = tile.column_begin; left < tile.column_end; left += kPacketWidth) {
        Spot spots[HazeRays::kMost];
        int count = 0;
        for (int y = top; y < std::min(top + kPacketWidth, tile.row_end); ++y) {
          for (int x = left; x < std::min(left + kPacketWidth, tile.column_end); ++x) {
            const std::size_t at = std::size_t(y) * std::size_t(lattice.width) + std::size_t(x);
            spots[count++] = {camera.at(x * stride + 0.5, y * stride + 0.5),
                              depth_at(depths, x * stride, y * stride), &lattice.rgba[4 * at]};
          }
        }
        march(spots, count, light);
      }
    }
  });
  return lattice;
}

/// Fills a row of pixels between those that were marched where all end alike, and marches the
/// others.
void DeformedHaze::Impl::fill_row(const CameraRays& camera, const RayDepths& depths, int stride,
                                  const FloatImage& lattice, int y, const HazeLight& light,
                                  FloatImage& picture) const {
  const float alike_mm = float(kAlikeVoxels * geometry.spacing_mm().x);
  const int j = y / stride;
  const float down = float(y % stride) / float(stride);
  Spot spots[HazeRays::kMost];
  int count = 0;
  for (int x = 0; x < depths.width; ++x) {
    const int i = x / stride;
    const float aside = float(x % stride) / float(stride);
    float* rgba = &picture.rgba[4 * (std::size_t(y) * std::size_t(depths.width) + std::size_t(x))];
    const float end_mm = depth_at(depths, x, y);
    float sum[4] = {};
    bool is_alike = true;
    for (int n = 0; n < 4; ++n) {
      const float weight = ((n & 1) != 0 ? aside : 1 - aside) * ((n & 2) != 0 ? down : 1 - down);
      if (weight == 0) continue;
      const int column = i + (n & 1), row = j + (n >> 1);
      const float end = depth_at(depths, column * stride, row * stride);
      is_alike = is_alike && (end == end_mm || std::abs(end - end_mm) <= alike_mm);
      const std::size_t at =
          4 * (std::size_t(row) * std::size_t(lattice.width) + std::size_t(column));
      for (std::size_t c = 0; c < 4; ++c) sum[c] += weight * lattice.rgba[at + c];
    }
    std::copy(sum, sum + 4, rgba);
    if (is_alike) continue;
    spots[count++] = {camera.at(x + 0.5, y + 0.5), end_mm, rgba};
    if (count < HazeRays::kMost) continue;
    march(spots, count, light);
    count = 0;
  }
  if (count > 0) march(spots, count, light);
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
  const int stride = m_impl->stride_of(rays, depths);
  FloatImage lattice = m_impl->march_lattice(rays, depths, stride, light);
  if (stride == 1) return lattice;
  parallel_for(depths.height, Grain{4},
               [&](int y) { m_impl->fill_row(rays, depths, stride, lattice, y, light, picture); });
  return picture;
}

}  // namespace supple
