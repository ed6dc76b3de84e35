#include "volumes/compare/compare_warps.h"

#include <cmath>
#include <memory>

#include "volumes/base/error.h"
#include "volumes/base/parallel.h"
#include "volumes/field/points/point_motion.h"

namespace supple {

namespace {

const char* name_of(WarpDirection direction) {
  return direction == WarpDirection::material ? "material" : "resample";
}

void require_one_direction(const Warp& a, const Warp& b) {
  const WarpDirection of_a = a.direction.value_or(WarpDirection::resample);
  const WarpDirection of_b = b.direction.value_or(WarpDirection::resample);
  if (of_a == of_b) return;
  throw InputError(
      {b.path, "direction", name_of(of_b),
       std::string(name_of(of_a)) + ", as in " + a.path + " (supple invert writes the other)"});
}

/// x -> x + v(x), whatever the direction of the warp.
std::unique_ptr<PointMotion> motion_along_vectors(const Warp& warp) {
  return motion_through(warp, warp.direction != WarpDirection::material);
}

/// Fills in the statistics of the errors that are numbers.
void sum_up(EndpointErrors& errors) {
  std::vector<float> lengths;
  lengths.reserve(errors.errors_mm.size());
  for (const float error : errors.errors_mm) {
    if (!std::isnan(error)) lengths.push_back(error);
  }
  errors.statistics = statistics_of(std::move(lengths));
}

}  // namespace

EndpointErrors compare_warps(const Warp& a, const Warp& b, const LabelLookup& mask,
                             Progress* progress) {
  require_one_direction(a, b);
  const bool same_grid = a.geometry == b.geometry;
  const auto along_b = motion_along_vectors(b);
  const Vec3i& dims = a.geometry.dims();
  EndpointErrors errors;
  errors.errors_mm.assign(a.vectors.size(), NAN);
  std::vector<std::int64_t> outside(std::size_t(dims.y));
  if (progress != nullptr) progress->stage("comparing");
  for (int k = 0; k < dims.z; ++k) {
    parallel_for(dims.y, [&](int j) {
      outside[std::size_t(j)] = 0;
      for (int i = 0; i < dims.x; ++i) {
        const std::size_t n = (std::size_t(k) * dims.y + j) * dims.x + i;
        const Vec3d place = a.geometry.world_from_index(Vec3d(i, j, k));
        if (mask && mask(place) == 0) continue;
        MovedPoint of_b;
        if (same_grid) {
          of_b.to_lps_mm = place + Vec3d(b.vectors[n]);
        } else {
          of_b = along_b->move(place);
        }
        if (of_b.kind == PlaceKind::outside) {
          ++outside[std::size_t(j)];
        } else {
          errors.errors_mm[n] = float((of_b.to_lps_mm - place - Vec3d(a.vectors[n])).length());
        }
      }
    });
    for (const std::int64_t count : outside) errors.outside += count;
    report(progress, double(k + 1) / dims.z);
  }
  sum_up(errors);
  return errors;
}

EndpointErrors compare_warps_at(const std::vector<Vec3d>& points_lps_mm, const Warp& a,
                                const Warp& b) {
  require_one_direction(a, b);
  const auto along_a = motion_along_vectors(a), along_b = motion_along_vectors(b);
  EndpointErrors errors;
  for (const Vec3d& point : points_lps_mm) {
    const MovedPoint of_a = along_a->move(point), of_b = along_b->move(point);
    const bool is_outside = of_a.kind == PlaceKind::outside || of_b.kind == PlaceKind::outside;
    errors.outside += is_outside;
    errors.errors_mm.push_back(is_outside ? NAN
                                          : float((of_a.to_lps_mm - of_b.to_lps_mm).length()));
  }
  sum_up(errors);
  return errors;
}

EndpointErrors compare_points(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b) {
  EndpointErrors errors;
  for (std::size_t n = 0; n < a.size(); ++n) {
    errors.errors_mm.push_back(float((a[n] - b[n]).length()));
  }
  sum_up(errors);
  return errors;
}

}  // namespace supple
