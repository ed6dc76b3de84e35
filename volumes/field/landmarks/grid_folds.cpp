#include "volumes/field/landmarks/grid_folds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "volumes/base/parallel.h"
#include "volumes/field/inversion/cell_corners.h"

namespace supple {

namespace {

constexpr int kLanes = 16;

struct RowFolds {
  std::int64_t folded = 0;
  double smallest_det = std::numeric_limits<double>::infinity();
};

RowFolds joined(const RowFolds& a, const RowFolds& b) {
  return {a.folded + b.folded, std::min(a.smallest_det, b.smallest_det)};
}

/// Corners of cells side by side; corner 4 x + 2 y + z, relative to where they are at rest.
struct CellLanes {
  double u[8][3][kLanes];

  CellCorners cell(int lane) const {
    CellCorners corners;
    for (int corner = 0; corner < 8; ++corner) {
      for (int a = 0; a < 3; ++a) {
        corners.p[a][corner] = (corner >> (2 - a) & 1) + u[corner][a][lane];
      }
    }
    return corners;
  }
};

/// Smallest det F at the corners, and the largest row sum of |F - 1| over the cell: below 1 nothing
/// folds (F is diagonally dominant).
struct LaneBounds {
  double smallest_det[kLanes], largest_row[kLanes];
};

void bound(const CellLanes& cells, LaneBounds& bounds) {
  // Edges along x, y, z that begin at the corners whose bit of that axis is 0.
  double edge[3][4][3][kLanes], largest[3][3][kLanes] = {};
  for (int axis = 0; axis < 3; ++axis) {
    const int bit = 4 >> axis;
    int n = 0;
    for (int corner = 0; corner < 8; ++corner) {
      if ((corner & bit) != 0) continue;
      for (int a = 0; a < 3; ++a) {
        for (int lane = 0; lane < kLanes; ++lane) {
          const double along = cells.u[corner | bit][a][lane] - cells.u[corner][a][lane];
          largest[a][axis][lane] = std::max(largest[a][axis][lane], std::abs(along));
          edge[axis][n][a][lane] = along + (a == axis ? 1.0 : 0.0);
        }
      }
      ++n;
    }
  }
  for (int lane = 0; lane < kLanes; ++lane) {
    double row = 0;
    for (int a = 0; a < 3; ++a) {
      row = std::max(row, largest[a][0][lane] + largest[a][1][lane] + largest[a][2][lane]);
    }
    bounds.largest_row[lane] = row;
    bounds.smallest_det[lane] = std::numeric_limits<double>::infinity();
  }
  for (int corner = 0; corner < 8; ++corner) {
    const int x = corner >> 2, y = corner >> 1 & 1, z = corner & 1;
    const auto& ex = edge[0][2 * y + z];
    const auto& ey = edge[1][2 * x + z];
    const auto& ez = edge[2][2 * x + y];
    for (int n = 0; n < kLanes; ++n) {
      const double det = ex[0][n] * (ey[1][n] * ez[2][n] - ey[2][n] * ez[1][n]) -
                         ex[1][n] * (ey[0][n] * ez[2][n] - ey[2][n] * ez[0][n]) +
                         ex[2][n] * (ey[0][n] * ez[1][n] - ey[1][n] * ez[0][n]);
      bounds.smallest_det[n] = std::min(bounds.smallest_det[n], det);
    }
  }
}

}  // namespace

GridFolds::GridFolds(const Geometry& grid) : m_grid(grid) {}

void GridFolds::add(int k, const Vec3f* vectors_mm) {
  const Vec3i& dims = m_grid.dims();
  const std::size_t width = std::size_t(dims.x);
  std::swap(m_below, m_here);
  m_here.resize(width * std::size_t(dims.y));
  parallel_for(m_here.size(), Grain{4096}, [&](std::size_t n) {
    m_here[n] = Vec3f(m_grid.index_vector_from_world(Vec3d(vectors_mm[n])));
  });
  if (k == 0 || dims.x < 2 || dims.y < 2) return;
  const auto add_row = [&](int j, RowFolds& sum) {
    CellLanes cells;
    LaneBounds bounds;
    for (int begin = 0; begin + 1 < dims.x; begin += kLanes) {
      const int count = std::min(kLanes, dims.x - 1 - begin);
      for (int corner = 0; corner < 8; ++corner) {
        const std::vector<Vec3f>& slice = (corner & 1) != 0 ? m_here : m_below;
        const Vec3f* row = &slice[std::size_t(j + (corner >> 1 & 1)) * width];
        for (int lane = 0; lane < kLanes; ++lane) {
          const Vec3f& vector = row[begin + std::min(lane, count - 1) + (corner >> 2)];
          for (int a = 0; a < 3; ++a) cells.u[corner][a][lane] = double(vector[a]);
        }
      }
      bound(cells, bounds);
      for (int lane = 0; lane < count; ++lane) {
        sum.smallest_det = std::min(sum.smallest_det, bounds.smallest_det[lane]);
        if (bounds.largest_row[lane] < 1) continue;
        sum.folded += is_folded(cells.cell(lane));
      }
    }
  };
  const RowFolds layer = parallel_reduce(dims.y - 1, Grain{1}, RowFolds{}, add_row, joined);
  m_folded += layer.folded;
  m_smallest_det = k == 1 ? layer.smallest_det : std::min(m_smallest_det, layer.smallest_det);
}

VectorSliceSource counted(VectorSliceSource slices, GridFolds& folds) {
  return [slices = std::move(slices), &folds](int k, Vec3f* out) {
    slices(k, out);
    folds.add(k, out);
  };
}

GridFolds folds_of(const Geometry& grid, const VectorSliceSource& slices, const Progress* progress,
                   std::int64_t enough) {
  GridFolds folds(grid);
  std::vector<Vec3f> slice(std::size_t(grid.dims().x) * std::size_t(grid.dims().y));
  for (int k = 0; k < grid.dims().z && folds.folded_cells() < enough; ++k) {
    poll(progress);
    slices(k, slice.data());
    folds.add(k, slice.data());
  }
  return folds;
}

}  // namespace supple
