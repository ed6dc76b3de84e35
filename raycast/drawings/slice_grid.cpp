#include "raycast/drawings/slice_grid.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple {

namespace {

constexpr int kMaxPixels = 16384;
constexpr double kNearlyAxial = 0.9;  // cosine of 25 degrees

/// Finds for L, P and S the grid axis that follows it most closely, every axis once.
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

/// Points at which the plane through a place crosses the box's edges, relative to the place.
std::vector<Vec3d> cut_of_box(const Geometry& geometry, const Vec3d& through, const Vec3d& normal) {
  std::array<Vec3d, 8> corners;
  for (std::size_t c = 0; c < 8; ++c) {
    Vec3d index;
    for (int a = 0; a < 3; ++a) index[a] = c >> a & 1 ? geometry.dims()[a] - 0.5 : -0.5;
    corners[c] = geometry.world_from_index(index) - through;
  }
  std::vector<Vec3d> crossings;
  for (std::size_t c = 0; c < 8; ++c) {
    for (std::size_t bit = 1; bit < 8; bit <<= 1) {
      if (c & bit) continue;
      const Vec3d &a = corners[c], &b = corners[c | bit];
      const double da = a.dot(normal), db = b.dot(normal);
      if ((da < 0) != (db < 0)) crossings.push_back(a + (b - a) * (da / (da - db)));
    }
  }
  return crossings;
}

}  // namespace

SliceAxes slice_axes(const Geometry& geometry, SlicePlane plane) {
  const std::array<int, 3> axes = patient_axes(geometry);
  const bool is_sagittal = plane == SlicePlane::sagittal, is_axial = plane == SlicePlane::axial;
  const int right_world = is_sagittal ? 1 : 0, down_world = is_axial ? 1 : 2;
  const Vec3d right = along(geometry, axes[std::size_t(right_world)], right_world, 1);
  const Vec3d down = along(geometry, axes[std::size_t(down_world)], down_world, is_axial ? 1 : -1);
  return {right, (down - right * down.dot(right)).normalized()};  // square on sheared grids
}

SliceAxes oblique_axes(const Vec3d& normal_lps, const std::optional<Vec3d>& up_lps) {
  if (!is_finite(normal_lps) || !(normal_lps.length() > 0)) {
    throw InputError({"", "normal", "no direction", "a vector of LPS that is not 0"});
  }
  const Vec3d normal = normal_lps.normalized();
  const bool is_nearly_axial = std::abs(normal.z) > kNearlyAxial;
  const Vec3d up = up_lps.value_or(is_nearly_axial ? Vec3d(0, -1, 0) : Vec3d(0, 0, 1));
  const Vec3d right = up.cross(normal);
  if (!is_finite(up) || !(right.length() > 1e-6 * up.length())) {
    throw InputError({"", "up", "no direction across the normal", "a vector of LPS across it"});
  }
  return {right.normalized(), right.cross(normal).normalized()};
}

Geometry slice_grid(const Geometry& geometry, SlicePlane plane, const Vec3d& through_index,
                    double pixel_mm) {
  return slice_grid(geometry, slice_axes(geometry, plane), through_index, pixel_mm);
}

Geometry slice_grid(const Geometry& geometry, const SliceAxes& axes, const Vec3d& through_index,
                    double pixel_mm) {
  if (!(pixel_mm > 0) || !std::isfinite(pixel_mm)) {
    throw InputError({"", "pixel", number_text(pixel_mm) + " mm", "a length of more than 0 mm"});
  }
  const Vec3d last(geometry.dims() - Vec3i(1));
  for (int a = 0; a < 3; ++a) {
    if (through_index[a] >= 0 && through_index[a] <= last[a]) continue;
    throw InputError(
        {"", "position", to_text(through_index), "a voxel from 0,0,0 to " + to_text(last)});
  }
  const auto& [right, down] = axes;
  // The box's outer faces, seen from the position, in pixels.
  const Vec3d through = geometry.world_from_index(through_index);
  std::array<double, 2> lo = {0, 0}, hi = {0, 0};
  for (const Vec3d& crossing : cut_of_box(geometry, through, right.cross(down))) {
    const std::array<double, 2> at = {crossing.dot(right) / pixel_mm,
                                      crossing.dot(down) / pixel_mm};
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

std::vector<Vec3d> stacked_places(const Geometry& geometry, const SliceAxes& axes,
                                  const Vec3d& through_index, int count,
                                  const std::optional<double>& every_mm) {
  const Vec3d away = geometry.index_vector_from_world(axes.right.cross(axes.down));
  // How far the line through the place stays between the centres of the outermost voxels, mm.
  double first = -HUGE_VAL, last = HUGE_VAL;
  for (int a = 0; a < 3; ++a) {
    if (std::abs(away[a]) < 1e-12) continue;
    const double to_lo = -through_index[a] / away[a];
    const double to_hi = (geometry.dims()[a] - 1 - through_index[a]) / away[a];
    first = std::max(first, std::min(to_lo, to_hi));
    last = std::min(last, std::max(to_lo, to_hi));
  }
  std::vector<Vec3d> places;
  for (int n = 0; n < count; ++n) {
    const double mm =
        every_mm ? (n - 0.5 * (count - 1)) * *every_mm : first + (last - first) * (n + 0.5) / count;
    if (mm >= first - 1e-9 && mm <= last + 1e-9) {
      Vec3d place = through_index + away * std::clamp(mm, first, last);
      for (int a = 0; a < 3; ++a) place[a] = std::clamp(place[a], 0.0, geometry.dims()[a] - 1.0);
      places.push_back(place);
    }
  }
  return places;
}

}  // namespace supple
