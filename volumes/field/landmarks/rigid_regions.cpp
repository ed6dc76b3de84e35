#include "volumes/field/landmarks/rigid_regions.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <Eigen/Dense>

#include "volumes/base/error.h"
#include "volumes/field/dense/nearest_void.h"

namespace supple {

namespace {

constexpr double kFade = 1.5;         // power of distance by which motions of regions are weighed
constexpr double kOnALine = 1e-6;     // of the extent of a region's landmarks
constexpr double kInRegionMm = 1e-9;  // distances up to here are those of a place in it

Eigen::Vector3d column(const Vec3d& v) {
  return {v.x, v.y, v.z};
}

/// All voxels of the box, or those without the label.
BrickTopology voxels_of(const RegionLabels& labels, const std::int32_t* without) {
  const Vec3i& dims = labels.geometry.dims();
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (int x = 0; x < dims.x; x += kBrickDim) {
    for (int y = 0; y < dims.y; y += kBrickDim) {
      for (int z = 0; z < dims.z; z += kBrickDim) {
        BrickMask mask{};
        for (int n = 0; n < kBrickVoxels; ++n) {
          const Vec3i voxel = Vec3i(x, y, z) + brick_local(n);
          const bool is_inside = voxel.x < dims.x && voxel.y < dims.y && voxel.z < dims.z;
          if (is_inside && (without == nullptr || labels.at(voxel) != *without)) mask_set(mask, n);
        }
        origins.push_back({x, y, z});
        masks.push_back(mask);
      }
    }
  }
  return BrickTopology(std::move(origins), std::move(masks));
}

std::int64_t count_of(const BrickTopology& voxels) {
  std::int64_t count = 0;
  for (std::size_t b = 0; b < voxels.brick_count(); ++b) count += mask_count(voxels.mask(b));
  return count;
}

std::string region_name(std::int32_t label) {
  return "label " + std::to_string(label);
}

}  // namespace

RigidRegions::RigidRegions(const RegionLabels& labels, const std::vector<std::int32_t>& rigid,
                           const std::vector<Vec3d>& points, const std::vector<Vec3d>& vectors,
                           double width_mm)
    : m_geometry(labels.geometry), m_width_mm(width_mm) {
  const BrickTopology all = voxels_of(labels, nullptr);
  const Vec3d spacing = m_geometry.spacing_mm();
  const double near_mm = std::max({spacing.x, spacing.y, spacing.z});
  std::vector<bool> is_taken(points.size());
  for (const std::int32_t label : rigid) {
    const BrickTopology others = voxels_of(labels, &label);
    if (count_of(others) == count_of(all)) {
      throw InputError(
          {"", "rigid", "no voxel of " + region_name(label), "a label of the label volume"});
    }
    Region region;
    region.label = label;
    region.to_nearest = nearest_void(others, all, m_geometry.dims(), spacing);
    std::vector<Vec3d> from, by;
    for (std::size_t n = 0; n < points.size(); ++n) {
      if (is_taken[n] || distance_mm(region, points[n]) > near_mm) continue;
      is_taken[n] = true;
      from.push_back(points[n]);
      by.push_back(vectors[n]);
    }
    fit(region, from, by);
    m_regions.push_back(std::move(region));
  }
  for (std::size_t n = 0; n < points.size(); ++n) {
    if (!is_taken[n]) m_outside.push_back(n);
  }
}

/// The least-squares motion (Kabsch 1976), which never mirrors.
void RigidRegions::fit(Region& region, const std::vector<Vec3d>& from,
                       const std::vector<Vec3d>& by) {
  const std::string name = "landmarks in " + region_name(region.label);
  require(from.size() >= 3, name, double(from.size()), "at least 3, not on a line");
  const double share = 1 / double(from.size());
  for (std::size_t n = 0; n < from.size(); ++n) {
    region.middle += from[n] * share;
    region.shift += by[n] * share;
  }
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero(), spread = Eigen::Matrix3d::Zero();
  for (std::size_t n = 0; n < from.size(); ++n) {
    const Vec3d arm = from[n] - region.middle, moved = arm + by[n] - region.shift;
    products += column(moved) * column(arm).transpose();
    spread += column(arm) * column(arm).transpose();
  }
  const Eigen::Vector3d extents =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvalues().cwiseMax(0).cwiseSqrt();
  if (!(extents[1] > kOnALine * extents[2])) {
    throw InputError({"", name, "all on a line", "at least 3, not on a line"});
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(products, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs(1, 1, 1);
  signs[2] = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  const Eigen::Matrix3d turn = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  std::array<Vec3d, 3> axes;
  for (int a = 0; a < 3; ++a) axes[std::size_t(a)] = {turn(0, a), turn(1, a), turn(2, a)};
  region.turn = turn_to(axes);
  for (std::size_t n = 0; n < from.size(); ++n) {
    m_largest_misfit_mm = std::max(m_largest_misfit_mm, (region.way_of(from[n]) - by[n]).length());
  }
}

/// Beyond the label volume: to its border, and on from there.
double RigidRegions::distance_mm(const Region& region, const Vec3d& x) const {
  const Vec3d index = m_geometry.index_from_world(x);
  Vec3d inside;
  for (int a = 0; a < 3; ++a) inside[a] = std::clamp(index[a], 0.0, m_geometry.dims()[a] - 1.0);
  const Vec3i lo(int(inside.x), int(inside.y), int(inside.z));
  double distance = 0;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3i voxel = lo;
    double weight = 1;
    for (int a = 0; a < 3; ++a) {
      const bool is_upper = (corner >> a & 1) != 0;
      const double part = inside[a] - lo[a];
      weight *= is_upper ? part : 1 - part;
      voxel[a] += is_upper;
    }
    if (weight == 0) continue;
    Vec3f to_nearest(0);
    region.to_nearest.at(voxel, to_nearest);
    distance += weight * m_geometry.world_vector_from_index(Vec3d(to_nearest)).length();
  }
  return distance + m_geometry.world_vector_from_index(index - inside).length();
}

RigidRegions::Motion RigidRegions::at(const Vec3d& x) const {
  Motion motion;
  double weights = 0, nearest = std::numeric_limits<double>::infinity();
  for (const Region& region : m_regions) {
    const double distance = distance_mm(region, x);
    if (distance <= kInRegionMm) return {region.way_of(x), 0};
    const double weight = std::pow(distance, -kFade);
    motion.vector += region.way_of(x) * weight;
    weights += weight;
    nearest = std::min(nearest, distance);
  }
  motion.vector *= 1 / weights;
  motion.give = nearest / (nearest + m_width_mm);
  return motion;
}

}  // namespace supple
