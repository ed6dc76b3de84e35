#include "volumes/field/inversion/reachable_bricks.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "volumes/base/error.h"
#include "volumes/base/parallel.h"
#include "volumes/base/text.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

namespace {

constexpr double kMaxNodesPerCell = 1 << 24;
// Rounding of a deformed corner, in voxels.
constexpr double kNodeSlack = 1e-5;
// A deformed brick in a larger box than this adds the bricks of its cells one by one.
constexpr double kLargeBox = 64.0 * kBrickVoxels;

/// The bricks of the cells of a torn source brick, one by one.
void add_bricks_of_cells(const VectorBricks& u, std::size_t b, std::vector<Vec3i>& origins) {
  SourceCells cells;
  if (!gather_cells(u, b, cells)) return;
  std::vector<Vec3i> reached;
  for_each_active(cells.mask, [&](int offset) {
    const Vec3i cell = cells.origin + brick_local(offset);
    const IndexBox nodes = nodes_of(cell_corners(cells, offset), cell);
    if (!nodes.empty()) add_box(cell + nodes.lo, cell + nodes.hi, reached);
  });
  sort_unique(reached);
  origins.insert(origins.end(), reached.begin(), reached.end());
}

}  // namespace

IndexBox nodes_of(const CellCorners& corners, const Vec3i& cell) {
  IndexBox nodes;
  double count = 1;
  for (int a = 0; a < 3; ++a) {
    const double* p = corners.p[a];
    double lo[4], hi[4];
    for (int n = 0; n < 4; ++n) {
      lo[n] = std::min(p[n], p[n + 4]);
      hi[n] = std::max(p[n], p[n + 4]);
    }
    const double min = std::min(std::min(lo[0], lo[1]), std::min(lo[2], lo[3]));
    const double max = std::max(std::max(hi[0], hi[1]), std::max(hi[2], hi[3]));
    nodes.lo[a] = int(std::ceil(min - kNodeSlack));
    nodes.hi[a] = int(std::floor(max + kNodeSlack));
    count *= std::max(0, nodes.hi[a] - nodes.lo[a] + 1);
  }
  if (count > kMaxNodesPerCell) {
    throw InputError({"", "displacement at voxel " + to_text(cell, " "),
                      "a cell stretched over " + to_text(nodes.hi - nodes.lo, " ") + " voxels",
                      "a field without tears (at most 2^24 voxels per cell)"});
  }
  return nodes;
}

std::vector<Vec3i> reachable_origins(const VectorBricks& u,
                                     const std::vector<BrickReach>& reaches) {
  PerThread<std::vector<Vec3i>> parts;
  parallel_for(reaches.size(), [&](std::size_t n) {
    const IndexBox& reach = reaches[n].nodes;
    if (is_torn(reach)) {
      add_bricks_of_cells(u, std::size_t(reaches[n].brick), parts.local());
    } else if (!reach.empty()) {
      add_box(reach.lo, reach.hi, parts.local());
    }
  });
  std::vector<Vec3i> origins;
  for (std::vector<Vec3i>& part : parts) {
    sort_unique(part);
    origins.insert(origins.end(), part.begin(), part.end());
  }
  sort_unique(origins);
  return origins;
}

bool is_torn(const IndexBox& reach) {
  const Vec3d extent = Vec3d(reach.hi) - Vec3d(reach.lo) + Vec3d(1);
  return !reach.empty() && extent.x * extent.y * extent.z > kLargeBox;
}

}  // namespace supple
