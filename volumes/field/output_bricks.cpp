#include "volumes/field/output_bricks.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr double kMaxNodesPerCell = 1 << 24;
// Rounding of a deformed corner, in voxels.
constexpr double kNodeSlack = 1e-5;
// A deformed brick in a larger box than this adds the bricks of its cells one by one.
constexpr double kLargeBox = 64.0 * kBrickVoxels;

void add_box(const Vec3i& lo, const Vec3i& hi, std::vector<Vec3i>& origins) {
  for (int x = lo.x & ~7; x <= hi.x; x += kBrickDim) {
    for (int y = lo.y & ~7; y <= hi.y; y += kBrickDim) {
      for (int z = lo.z & ~7; z <= hi.z; z += kBrickDim) origins.push_back({x, y, z});
    }
  }
}

/// Box of the moved corners of all cells, in nodes.
IndexBox box_of_corners(const SourceCells& cells) {
  std::uint16_t rows[kCornerDim][kCornerDim];
  corner_rows(cells.mask, rows);
  Vec3f lo(3e38f), hi(-3e38f);
  for (int x = 0; x < kCornerDim; ++x) {
    for (int y = 0; y < kCornerDim; ++y) {
      for (unsigned bits = rows[x][y]; bits != 0; bits &= bits - 1) {
        const int z = __builtin_ctz(bits);
        const Vec3f moved = Vec3f(float(x), float(y), float(z)) + cells.u[x][y][z];
        for (int a = 0; a < 3; ++a) {
          lo[a] = std::min(lo[a], moved[a]);
          hi[a] = std::max(hi[a], moved[a]);
        }
      }
    }
  }
  // Single precision may round a corner of a far displacement by a sixteenth of a voxel.
  IndexBox box;
  for (int a = 0; a < 3; ++a) {
    box.lo[a] = cells.origin[a] + int(std::floor(lo[a] - 0.1f));
    box.hi[a] = cells.origin[a] + int(std::ceil(hi[a] + 0.1f));
  }
  return box;
}

void add_reached_bricks(const VectorBricks& u, std::size_t b, std::vector<Vec3i>& origins) {
  SourceCells cells;
  if (!gather_cells(u, b, cells)) return;
  const IndexBox whole = box_of_corners(cells);
  const Vec3d extent = Vec3d(whole.hi - whole.lo) + Vec3d(1);
  if (extent.x * extent.y * extent.z <= kLargeBox) {
    add_box(whole.lo, whole.hi, origins);
    return;
  }
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
    throw InputError({"", "displacement at voxel " + to_text(cell),
                      "a cell stretched over " + to_text(nodes.hi - nodes.lo) + " voxels",
                      "a field without tears (at most 2^24 voxels per cell)"});
  }
  return nodes;
}

std::vector<Vec3i> output_origins(const VectorBricks& u, const std::vector<std::uint8_t>& still) {
  tbb::enumerable_thread_specific<std::vector<Vec3i>> parts;
  tbb::parallel_for(std::size_t(0), u.topology.brick_count(), [&](std::size_t b) {
    const Vec3i& origin = u.topology.origin(b);
    if (still[b]) {
      add_box(origin, origin + Vec3i(kBrickDim), parts.local());
    } else {
      add_reached_bricks(u, b, parts.local());
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

void sort_unique(std::vector<Vec3i>& voxels) {
  std::sort(voxels.begin(), voxels.end(), [](const Vec3i& a, const Vec3i& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  });
  voxels.erase(std::unique(voxels.begin(), voxels.end()), voxels.end());
}

std::string to_text(const Vec3i& v) {
  return std::to_string(v.x) + " " + std::to_string(v.y) + " " + std::to_string(v.z);
}

}  // namespace supple
