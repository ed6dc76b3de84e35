#include "tools/lab/bench/bodies/invert_fields.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "tools/lab/bench/bodies/ecm_bodies.h"
#include "tools/lab/bench/bodies/ecm_engines.h"
#include "tools/lab/bench/bodies/ecm_motion.h"
#include "volumes/base/parallel.h"
#include "volumes/field/inversion/deformed_cell.h"
#include "volumes/field/inversion/invert.h"
#include "volumes/field/inversion/reachable_bricks.h"
#include "volumes/field/procedural.h"
#include "volumes/grid/cell.h"
#include "volumes/grid/voxel_sets.h"

namespace supple::tools {

namespace {

using Motion3 = std::function<Vec3d(const Vec3d&)>;

/// The motion of a bump: along `direction` by a Gaussian whose steepest slope is `slope`.
Motion3 gaussian_bump(const Vec3d& center, double width, const Vec3d& direction, double slope) {
  const double height = slope * width * std::exp(0.5);
  const Vec3d along = direction.normalized() * height;
  return [=](const Vec3d& p) {
    return p + along * std::exp(-(p - center).length2() / (2 * width * width));
  };
}

Motion3 twist(const Vec3d& center, double radians_per_voxel) {
  return [=](const Vec3d& p) {
    const double angle = (p.z - center.z) * radians_per_voxel;
    const double c = std::cos(angle), s = std::sin(angle);
    const Vec3d d = p - center;
    return center + Vec3d(c * d.x - s * d.y, s * d.x + c * d.y, d.z);
  };
}

Motion3 analytic_motion(const std::string& name, int size) {
  const Vec3d center((size - 1) / 2.0);
  const double width = size / 5.0;
  if (name == "smooth") return gaussian_bump(center, width, {1, 0.6, 0.3}, 0.3);
  if (name == "fold") return gaussian_bump(center, width, {1, 0.6, 0.3}, 1.5);
  const Motion3 bump = gaussian_bump(center, width, {1, 0.6, 0.3}, 0.85);
  const Motion3 twisted = twist(center, 2.0 / size);
  return [=](const Vec3d& p) { return twisted(bump(p)); };
}

/// All elements of a block of noise, moved by one pull.
Displacement pulled_noise(int size) {
  Body body = block_body("noise", Vec3i(size));
  EcmWorkload workload;
  workload.direction = "xyz";
  workload.start = "rest";
  const auto engine = make_engine("supple", body, nullptr);
  for (const BenchDrag& pull : motion_of_all(workload, body).script) engine->pull(pull);
  State state;
  state.geometry = body.geometry;
  state.elements = body.elements;
  state.q = body.q;
  Displacement displacement = displacement_of(state);
  // The mean is taken off, so that methods that fill the volume's own box can be compared.
  Vec3d sum(0);
  for (const Vec3f& u : displacement.u.vectors.all()) sum += Vec3d(u);
  const Vec3d mean = sum / double(displacement.u.vectors.brick_count() * kBrickVoxels);
  const Vec3f shared(float(std::round(mean.x)), float(std::round(mean.y)),
                     float(std::round(mean.z)));
  displacement.u.vectors.touch_all();
  for_each_stored(displacement.u.vectors, [&](Vec3f& u) { u -= shared; });
  return displacement;
}

bool has_all_neighbours(const BrickTopology& voxels, const Vec3i& cell) {
  for (int n = 0; n < 64; ++n) {
    if (!voxels.is_active(cell + Vec3i(n / 16 - 1, n / 4 % 4 - 1, n % 4 - 1))) return false;
  }
  return true;
}

CellCorners corners_of(const VectorBricks& u, const Vec3i& cell) {
  CellCorners corners;
  for (int n = 0; n < 8; ++n) {
    const Vec3i step = cell_corner(n);
    Vec3f moved(0);
    u.at(cell + step, moved);
    for (int a = 0; a < 3; ++a) corners.p[a][n] = step[a] + double(moved[a]);
  }
  return corners;
}

}  // namespace

Displacement field_to_invert(const std::string& name, int size) {
  if (name == "noisy") return pulled_noise(size);
  const Body block = block_body("smooth", Vec3i(size));
  const Motion3 motion = analytic_motion(name, size);
  const AnalyticWarp warp{[&](const Vec3d& p) { return motion(p) - p; }, nullptr};
  return sample_displacement(warp, block.geometry, block.elements);
}

std::int64_t missing_nodes(const VectorBricks& u, const VectorBricks& o) {
  std::atomic<std::int64_t> missing{0};
  parallel_for(u.topology.brick_count(), [&](std::size_t b) {
    for_each_active(u.topology.mask(b), [&](int offset) {
      const Vec3i cell = u.topology.origin(b) + brick_local(offset);
      if (!has_all_neighbours(u.topology, cell)) return;
      const CellCorners corners = corners_of(u, cell);
      const IndexBox nodes = nodes_of(corners, cell);
      for (int x = nodes.lo.x; x <= nodes.hi.x; ++x) {
        for (int y = nodes.lo.y; y <= nodes.hi.y; ++y) {
          for (int z = nodes.lo.z; z <= nodes.hi.z; ++z) {
            const Vec3i node(x, y, z);
            if (o.topology.is_active(cell + node)) continue;
            missing += covered_by_tetrahedra(corners, Vec3d(node));
          }
        }
      }
    });
  });
  return missing;
}

BrickTopology inner_nodes(const Displacement& displacement) {
  return intersect(invert(displacement).o.topology, displacement.u.topology);
}

Judgement judge(const VectorBricks& u, const VectorBricks& o, const BrickTopology& nodes) {
  constexpr double kLost = 0.5;
  Judgement judgement;
  std::vector<double> residuals;
  for (std::size_t b = 0; b < nodes.brick_count(); ++b) {
    for_each_active(nodes.mask(b), [&](int offset) {
      const Vec3i node = nodes.origin(b) + brick_local(offset);
      Vec3f found;
      Vec3d moved;
      const bool is_found = o.at(node, found) && u.sample(Vec3d(node) + Vec3d(found), moved) &&
                            (Vec3d(found) + moved).length() <= kLost;
      if (is_found) {
        residuals.push_back((Vec3d(found) + moved).length());
      } else {
        ++judgement.missing;
      }
    });
  }
  if (residuals.empty()) return judgement;
  const auto rank = residuals.begin() + std::ptrdiff_t(0.999 * double(residuals.size() - 1));
  std::nth_element(residuals.begin(), rank, residuals.end());
  judgement.residual_p999 = *rank;
  judgement.residual_max = *std::max_element(residuals.begin(), residuals.end());
  return judgement;
}

}  // namespace supple::tools
