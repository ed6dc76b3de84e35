#include "tools/lab/bench/bodies/ecm_motion.h"

#include <algorithm>
#include <cmath>

namespace supple::tools {

namespace {

/// The largest slack of a link in any of the benchmark's materials, in voxels.
constexpr double kLargestSlack = 0.7;
/// Displacements add up to less than the engine's range.
constexpr double kRangeVoxels = 16000;

Vec3i direction_of(const std::string& name) {
  if (name == "-x") return {-1, 0, 0};
  if (name == "+y") return {0, 1, 0};
  return {1, name == "xy" || name == "xyz", name == "xyz"};
}

/// More than the slack of any path from the voxel through the body's box.
double displacement_that_moves_all(const Body& body, const Vec3i& voxel) {
  const IndexBox& bounds = body.elements.active_bounds();
  int steps = 0;
  for (int a = 0; a < 3; ++a) steps += std::max(voxel[a] - bounds.lo[a], bounds.hi[a] - voxel[a]);
  return std::ceil(kLargestSlack * steps) + 1;
}

}  // namespace

BenchDrag pull_of(const Vec3i& voxel, const std::string& direction, double voxels) {
  BenchDrag pull{voxel, {}};
  for (int c = 0; c < 3; ++c) {
    pull.by_q[c] = direction_of(direction)[c] * std::int32_t(voxels * kFixedOne);
  }
  return pull;
}

Vec3i middle_element(const Body& body) {
  const IndexBox& bounds = body.elements.active_bounds();
  Vec3i voxel = (bounds.lo + bounds.hi + Vec3i(1)) / 2;
  if (!body.elements.is_active(voxel)) nearest_element(body, voxel, voxel);
  return voxel;
}

Vec3i cheek_element(const Body& body) {
  const Vec3i& dims = body.geometry.dims();
  Vec3i voxel(dims.x * 2 / 3, dims.y - 1, dims.z / 6);
  while (voxel.y > 0 && !body.elements.is_active(voxel)) --voxel.y;
  return voxel;
}

Motion motion_of_all(const EcmWorkload& workload, const Body& body) {
  const Vec3i voxel = middle_element(body);
  const double voxels = displacement_that_moves_all(body, voxel);
  const BenchDrag pull = pull_of(voxel, workload.direction, voxels);
  if (workload.start == "rest") return {{pull}, {pull}, true};
  return {{pull, pull}, {pull}, false, int(kRangeVoxels / voxels) - 2};
}

Motion local_motion(const EcmWorkload& workload, const Vec3i& voxel, double amplitude) {
  const BenchDrag out = pull_of(voxel, workload.direction, amplitude);
  if (workload.start == "rest" || workload.start == "pull") return {{out}, {out}, true};
  const BenchDrag back = pull_of(voxel, workload.direction, -2 * amplitude);
  const BenchDrag forth = pull_of(voxel, workload.direction, 2 * amplitude);
  return {{out, back, forth}, {back, forth}, false};
}

double find_amplitude(const EcmWorkload& workload, Body& body, const Vec3i& voxel,
                      std::int64_t wanted, Progress& cancel) {
  const auto engine = make_engine("supple", body, &cancel);
  double amplitude = 0.3 * std::cbrt(double(wanted));
  // The moved elements grow with the cube of the amplitude, so a few steps do.
  for (int step = 0; step < 8; ++step) {
    engine->reset();
    for (const BenchDrag& pull : local_motion(workload, voxel, amplitude).script)
      engine->pull(pull);
    const double moved = double(engine->moved());
    if (std::abs(moved - double(wanted)) < 0.03 * double(wanted)) break;
    amplitude *= std::clamp(std::cbrt(double(wanted) / moved), 0.5, 2.0);
  }
  release_offsets(body);
  return amplitude;
}

}  // namespace supple::tools
