#include "raycast/drawings/slice.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <oneapi/tbb/parallel_for.h>

#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr int kMaxPixels = 16384;

/// For L, P and S the grid axis that follows it most closely, every axis once.
std::array<int, 3> patient_axes(const Geometry& geometry) {
  const auto direction = geometry.direction();
  std::array<int, 3> order = {0, 1, 2}, best = order;
  double best_sum = -1;
  do {
    double sum = 0;
    for (int w = 0; w < 3; ++w) sum += std::abs(direction[std::size_t(order[w])][w]);
    if (sum <= best_sum + 1e-9) continue;
    best_sum = sum;
    best = order;
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

/// The unit vector of a grid axis, turned towards +world or -world.
Vec3d along(const Geometry& geometry, int axis, int world, double sign) {
  const Vec3d unit = geometry.direction()[std::size_t(axis)];
  return unit[world] * sign < 0 ? -unit : unit;
}

/// Grey levels of pixels, and whether the material at rest holds the pixel's nearest voxel.
struct Pixel {
  std::uint8_t grey = 0;
  bool at_rest = false;
};

Vec3i nearest_voxel(const Vec3d& index) {
  return {int(std::floor(index.x + 0.5)), int(std::floor(index.y + 0.5)),
          int(std::floor(index.z + 0.5))};
}

}  // namespace

void SliceStyle::validate() const {
  if (std::isfinite(grey_lo) && std::isfinite(grey_hi) && grey_lo < grey_hi) return;
  throw InputError({"", "window", number_text(grey_lo) + "," + number_text(grey_hi),
                    "two densities, the lower one first"});
}

Geometry slice_grid(const Geometry& geometry, SlicePlane plane, const Vec3d& through_index,
                    double pixel_mm) {
  if (!(pixel_mm > 0) || !std::isfinite(pixel_mm)) {
    throw InputError({"", "pixel", number_text(pixel_mm) + " mm", "a length of more than 0 mm"});
  }
  const Vec3d last(geometry.dims() - Vec3i(1));
  for (int a = 0; a < 3; ++a) {
    if (through_index[a] >= 0 && through_index[a] <= last[a]) continue;
    throw InputError({"", "position",
                      number_text(through_index.x) + "," + number_text(through_index.y) + "," +
                          number_text(through_index.z),
                      "a voxel from 0,0,0 to " + number_text(last.x) + "," + number_text(last.y) +
                          "," + number_text(last.z)});
  }
  const std::array<int, 3> axes = patient_axes(geometry);
  const bool is_sagittal = plane == SlicePlane::sagittal, is_axial = plane == SlicePlane::axial;
  const int right_world = is_sagittal ? 1 : 0, down_world = is_axial ? 1 : 2;
  const Vec3d right = along(geometry, axes[std::size_t(right_world)], right_world, 1);
  Vec3d down = along(geometry, axes[std::size_t(down_world)], down_world, is_axial ? 1 : -1);
  down = (down - right * down.dot(right)).normalized();  // square pixels on sheared grids

  // The box's outer faces, seen from the position, in pixels.
  const Vec3d through = geometry.world_from_index(through_index);
  std::array<double, 2> lo = {HUGE_VAL, HUGE_VAL}, hi = {-HUGE_VAL, -HUGE_VAL};
  for (int corner = 0; corner < 8; ++corner) {
    Vec3d index(-0.5);
    for (int a = 0; a < 3; ++a) index[a] = corner >> a & 1 ? last[a] + 0.5 : -0.5;
    const Vec3d seen = geometry.world_from_index(index) - through;
    const std::array<double, 2> at = {seen.dot(right) / pixel_mm, seen.dot(down) / pixel_mm};
    for (std::size_t n = 0; n < 2; ++n) {
      lo[n] = std::min(lo[n], at[n]);
      hi[n] = std::max(hi[n], at[n]);
    }
  }
  std::array<int, 2> first{}, pixels{};
  for (std::size_t n = 0; n < 2; ++n) {
    const double count = std::floor(hi[n] - 1e-6) - std::ceil(lo[n] + 1e-6) + 1;
    if (count > kMaxPixels) {
      throw InputError({"", "slice", number_text(count) + " pixels a side",
                        "at most " + std::to_string(kMaxPixels)});
    }
    first[n] = int(std::ceil(lo[n] + 1e-6));
    pixels[n] = std::max(1, int(count));
  }
  const Vec3d origin = through + right * (first[0] * pixel_mm) + down * (first[1] * pixel_mm);
  return {{pixels[0], pixels[1], 1},
          origin,
          {right * pixel_mm, down * pixel_mm, right.cross(down) * pixel_mm}};
}

Image draw_slice(const Geometry& geometry, const Geometry& slice, const DensityAt& density,
                 const SliceStyle& style) {
  style.validate();
  const int width = slice.dims().x, height = slice.dims().y;
  std::vector<Pixel> pixels(std::size_t(width) * height);
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const Vec3d index = geometry.index_from_world(slice.world_from_index(Vec3d(x, y, 0)));
      const double share = (density(index) - style.grey_lo) / (style.grey_hi - style.grey_lo);
      Pixel& pixel = pixels[std::size_t(y) * width + x];
      pixel.grey = std::uint8_t(std::lround(std::clamp(share, 0.0, 1.0) * 255));
      pixel.at_rest = style.rest != nullptr && style.rest->is_active(nearest_voxel(index));
    }
  });

  Image image(width, height);
  image.has_alpha = false;
  const auto at_rest = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < width && y < height &&
           pixels[std::size_t(y) * width + x].at_rest;
  };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool is_rim = at_rest(x, y) && !(at_rest(x - 1, y) && at_rest(x + 1, y) &&
                                             at_rest(x, y - 1) && at_rest(x, y + 1));
      std::uint8_t* rgba = &image.rgba[4 * (std::size_t(y) * width + x)];
      for (std::size_t c = 0; c < 3; ++c) {
        rgba[c] = is_rim ? style.outline[c] : pixels[std::size_t(y) * width + x].grey;
      }
      rgba[3] = 255;
    }
  }
  return image;
}

Image side_by_side(const std::vector<Image>& images, int gap) {
  int width = -gap, height = 0;
  for (const Image& image : images) {
    width += image.width + gap;
    height = std::max(height, image.height);
  }
  Image all(width, height);
  all.has_alpha = false;
  for (std::size_t n = 3; n < all.rgba.size(); n += 4) all.rgba[n] = 255;
  int left = 0;
  for (const Image& image : images) {
    for (int y = 0; y < image.height; ++y) {
      std::copy_n(&image.rgba[4 * std::size_t(y) * image.width], 4 * image.width,
                  &all.rgba[4 * (std::size_t(y) * width + left)]);
    }
    left += image.width + gap;
  }
  return all;
}

}  // namespace supple
