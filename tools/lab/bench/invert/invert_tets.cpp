#include "tools/lab/bench/invert/invert_tets.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "volumes/base/parallel.h"
#include "volumes/field/inversion/displacement_range.h"
#include "volumes/field/inversion/offset_accumulator.h"
#include "volumes/field/inversion/reachable_bricks.h"
#include "volumes/field/inversion/source_cells.h"
#include "volumes/grid/cell.h"

namespace supple::tools {

namespace {

/// Paths from corner 0 to corner 7 along the axes in every order.
constexpr int kPaths[6][2] = {{4, 6}, {4, 5}, {2, 6}, {2, 3}, {1, 5}, {1, 3}};
// Barycentric coordinates this far outside still count, so that no gap opens between neighbours.
constexpr double kEdge = 1e-9;

Vec3d rest_corner(int n) {
  return Vec3d(cell_corner(n));
}

/// The nodes in one tetrahedron: corners 0, path[0], path[1], 7.
void rasterise(const CellCorners& corners, const int (&path)[2], const Vec3i& cell,
               std::vector<OffsetAccumulator::NodeSolution>& hits) {
  const int n[4] = {0, path[0], path[1], 7};
  Vec3d p[4], lo(1e30), hi(-1e30);
  for (int c = 0; c < 4; ++c) {
    p[c] = corners.corner(n[c]);
    for (int a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], p[c][a]);
      hi[a] = std::max(hi[a], p[c][a]);
    }
  }
  const Vec3d e1 = p[1] - p[0], e2 = p[2] - p[0], e3 = p[3] - p[0];
  const Vec3d c23 = e2.cross(e3), c31 = e3.cross(e1), c12 = e1.cross(e2);
  const double volume = e1.dot(c23);
  if (volume == 0) return;
  const double inverse = 1 / volume;
  for (int x = int(std::ceil(lo.x)); x <= hi.x; ++x) {
    for (int y = int(std::ceil(lo.y)); y <= hi.y; ++y) {
      for (int z = int(std::ceil(lo.z)); z <= hi.z; ++z) {
        const Vec3d d = Vec3d(x, y, z) - p[0];
        const double l1 = d.dot(c23) * inverse, l2 = d.dot(c31) * inverse,
                     l3 = d.dot(c12) * inverse;
        if (std::min({l1, l2, l3, 1 - l1 - l2 - l3}) < -kEdge) continue;
        const Vec3d source =
            rest_corner(n[1]) * l1 + rest_corner(n[2]) * l2 + rest_corner(n[3]) * l3;
        hits.push_back({cell + Vec3i(x, y, z), Vec3f(source - Vec3d(x, y, z)), Content::air});
      }
    }
  }
}

struct Worker {
  SourceCells cells;
  std::vector<OffsetAccumulator::NodeSolution> hits;
  std::vector<OpenNode> no_doubts;
};

}  // namespace

VectorBricks invert_by_tetrahedra(const Displacement& displacement) {
  const VectorBricks& u = displacement.u;
  const std::size_t count = u.topology.brick_count();
  std::vector<std::int32_t> all(count);
  std::iota(all.begin(), all.end(), 0);
  DisplacementRanges ranges(displacement.geometry.dims());
  ranges.update(u, all);
  std::vector<BrickReach> reach(count);
  parallel_for(count, [&](std::size_t b) {
    reach[b] = {std::int32_t(b), ranges.reach(u.topology, b)};
  });
  OffsetAccumulator accumulator(reachable_origins(u, reach));
  PerThread<Worker> workers;
  parallel_for(count, [&](std::size_t b) {
    Worker& worker = workers.local();
    if (!gather_cells(u, b, worker.cells)) return;
    worker.hits.clear();
    for_each_active(worker.cells.mask, [&](int offset) {
      const CellCorners corners = cell_corners(worker.cells, offset);
      const Vec3i cell = worker.cells.origin + brick_local(offset);
      for (const auto& path : kPaths) rasterise(corners, path, cell, worker.hits);
    });
    if (is_torn(reach[b].nodes)) {
      accumulator.merge(worker.hits);
    } else {
      accumulator.merge(reach[b].nodes, worker.hits, worker.no_doubts);
    }
  });
  return accumulator.finish();
}

}  // namespace supple::tools
