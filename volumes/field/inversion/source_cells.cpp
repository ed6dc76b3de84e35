#include "volumes/field/inversion/source_cells.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "volumes/base/simd.h"
#include "volumes/field/ring_fill.h"
#include "volumes/grid/cell.h"
#include "volumes/grid/mask_steps.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

namespace {

/// The brick at `origin` and its seven upper neighbours, index 4 x + 2 y + z.
std::array<std::int32_t, 8> upper_bricks(const BrickTopology& voxels, const Vec3i& origin) {
  std::array<std::int32_t, 8> bricks;
  for (int n = 0; n < 8; ++n) bricks[n] = voxels.find(origin + cell_corner(n) * kBrickDim);
  return bricks;
}

/// Bits z = 0…8 of the active voxels in row (x, y).
unsigned voxel_row(const BrickTopology& voxels, const std::array<std::int32_t, 8>& bricks, int x,
                   int y) {
  const int column = 4 * (x >> 3) + 2 * (y >> 3);
  const auto row = [&](int n) -> unsigned {
    if (bricks[n] < 0) return 0;
    return unsigned((voxels.mask(bricks[n])[x & 7] >> (8 * (y & 7))) & 0xff);
  };
  return row(column) | (row(column + 1) & 1) << 8;
}

using Floats8 = Pack<float, 8>;
using Floats16 = Pack<float, 16>;

/// Row (x, y) of the corners: eight voxels and the first of the brick above.
void copy_row(const Vec3f* row, const Vec3f* above, int x, int y, SourceCells& cells) {
  // The 24 components of the row, the middle ones in both halves.
  const auto low = load_pack<Floats16>(&row[0].x), high = load_pack<Floats16>(&row[0].x + 8);
  const Floats8 u[3] = {__builtin_shufflevector(low, high, 0, 3, 6, 9, 12, 15, 26, 29),
                        __builtin_shufflevector(low, high, 1, 4, 7, 10, 13, 24, 27, 30),
                        __builtin_shufflevector(low, high, 2, 5, 8, 11, 14, 25, 28, 31)};
  for (int a = 0; a < 3; ++a) {
    const Floats8 next = Floats8{} + above[0][a];
    const Floats8 upper = __builtin_shufflevector(u[a], next, 1, 2, 3, 4, 5, 6, 7, 8);
    std::memcpy(cells.lower[a][x][y], &u[a], sizeof upper);
    std::memcpy(cells.upper[a][x][y], &upper, sizeof upper);
  }
}

using CornerRows = std::uint16_t[kCornerDim][kCornerDim];

void voxel_rows(const BrickTopology& voxels, const std::array<std::int32_t, 8>& bricks,
                CornerRows& rows) {
  for (int x = 0; x < kCornerDim; ++x) {
    for (int y = 0; y < kCornerDim; ++y) {
      rows[x][y] = std::uint16_t(voxel_row(voxels, bricks, x, y));
    }
  }
}

BrickMask cell_mask(const BrickTopology& voxels, const std::array<std::int32_t, 8>& bricks) {
  std::array<BrickMask, 8> corners;
  for (int n = 0; n < 8; ++n) corners[n] = bricks[n] < 0 ? BrickMask{} : voxels.mask(bricks[n]);
  return cells_in(corners);
}

/// Copies of the voxels with coordinate 0 along `axis`, one below and one above.
BrickTopology slice_and_its_copies(const BrickTopology& voxels, int axis) {
  constexpr int kStride[3] = {64, 8, 1};
  std::vector<Vec3i> origins[2];
  std::vector<BrickMask> masks[2];
  for (std::size_t b = 0; b < voxels.brick_count(); ++b) {
    if (voxels.origin(b)[axis] != 0) continue;
    BrickMask below{}, above{};
    for_each_active(voxels.mask(b), [&](int offset) {
      if (brick_local(offset)[axis] != 0) return;
      mask_set(below, offset + 7 * kStride[axis]);
      mask_set(above, offset + kStride[axis]);
    });
    Vec3i origin = voxels.origin(b);
    origins[1].push_back(origin);
    masks[1].push_back(above);
    origin[axis] -= kBrickDim;
    origins[0].push_back(origin);
    masks[0].push_back(below);
  }
  return unite(unite(voxels, {origins[0], masks[0]}), {origins[1], masks[1]});
}

}  // namespace

BrickMask cell_mask(const BrickTopology& voxels, std::size_t b) {
  return cell_mask(voxels, upper_bricks(voxels, voxels.origin(b)));
}

bool gather_cells(const VectorBricks& u, std::size_t b, SourceCells& cells) {
  const std::array<std::int32_t, 8> bricks = upper_bricks(u.topology, u.topology.origin(b));
  cells.origin = u.topology.origin(b);
  cells.mask = cell_mask(u.topology, bricks);
  if (std::all_of(cells.mask.begin(), cells.mask.end(), [](auto word) { return word == 0; })) {
    return false;
  }
  for (int x = 0; x < kCornerDim; ++x) {
    for (int y = 0; y < kCornerDim; ++y) {
      const int column = 4 * (x >> 3) + 2 * (y >> 3);
      const int offset = ((x & 7) << 6) | ((y & 7) << 3);
      const auto row = [&](int n) {
        return u.vectors.brick_or_zero(std::size_t(bricks[n])) + offset;
      };
      copy_row(row(column), row(column + 1), x, y, cells);
    }
  }
  return true;
}

CellCorners cell_corners(const SourceCells& cells, int offset) {
  const Vec3i c = brick_local(offset);
  CellCorners corners;
  for (int n = 0; n < 8; ++n) {
    const auto [x, y, z] = cell_corner(n);
    const Vec3f u = cells.u(c.x + x, c.y + y, c.z + z);
    corners.p[0][n] = x + double(u.x);
    corners.p[1][n] = y + double(u.y);
    corners.p[2][n] = z + double(u.z);
  }
  return corners;
}

bool is_translated(const SourceCells& cells, int offset, Vec3f& shift) {
  const Vec3i c = brick_local(offset);
  shift = cells.u(c.x, c.y, c.z);
  for (int n = 7; n > 0; --n) {
    if (cells.u(c.x + (n >> 2), c.y + ((n >> 1) & 1), c.z + (n & 1)) != shift) return false;
  }
  return true;
}

void corner_rows(const BrickMask& cells, std::uint16_t (&rows)[kCornerDim][kCornerDim]) {
  for (auto& plane : rows) std::fill(std::begin(plane), std::end(plane), std::uint16_t(0));
  for (int x = 0; x < kBrickDim; ++x) {
    for (int y = 0; y < kBrickDim; ++y) {
      const unsigned row = unsigned((cells[x] >> (8 * y)) & 0xff);
      const std::uint16_t ends = std::uint16_t(row | row << 1);
      rows[x][y] |= ends;
      rows[x][y + 1] |= ends;
      rows[x + 1][y] |= ends;
      rows[x + 1][y + 1] |= ends;
    }
  }
}

bool is_flat(const Vec3i& dims) {
  return std::min({dims.x, dims.y, dims.z}) == 1;
}

BrickTopology thickened(const BrickTopology& voxels, const Vec3i& dims) {
  BrickTopology result = voxels;
  for (int axis = 0; axis < 3; ++axis) {
    if (dims[axis] == 1) result = slice_and_its_copies(result, axis);
  }
  return result;
}

VectorBricks thickened(const VectorBricks& u, const Vec3i& dims) {
  VectorBricks result = u;
  for (int axis = 0; axis < 3; ++axis) {
    if (dims[axis] != 1) continue;
    VectorBricks thick{slice_and_its_copies(result.topology, axis), {}};
    thick.vectors.resize(thick.topology.brick_count());
    for (std::size_t b = 0; b < thick.topology.brick_count(); ++b) {
      for_each_active(thick.topology.mask(b), [&](int offset) {
        Vec3i voxel = thick.topology.origin(b) + brick_local(offset);
        Vec3f vector(0);
        if (!result.at(voxel, vector)) {
          voxel[axis] = 0;
          result.at(voxel, vector);
        }
        if (vector != Vec3f(0)) thick.vectors.touch(b)[offset] = vector;
      });
    }
    result = std::move(thick);
  }
  return result;
}

CellContents::CellContents(const BrickTopology* elements, const Vec3i& origin) {
  if (elements == nullptr) {
    for (auto& plane : m_rows) std::fill(std::begin(plane), std::end(plane), 0x1ff);
    m_tissue.fill(~std::uint64_t(0));
  } else {
    const std::array<std::int32_t, 8> bricks = upper_bricks(*elements, origin);
    voxel_rows(*elements, bricks, m_rows);
    m_tissue = cell_mask(*elements, bricks);
  }
  m_is_all_tissue = mask_count(m_tissue) == kBrickVoxels;
}

Content CellContents::at(const Vec3d& place) const {
  Vec3i cell, nearest;
  for (int a = 0; a < 3; ++a) {
    cell[a] = std::clamp(int(std::floor(place[a])), 0, kBrickDim - 1);
    nearest[a] = std::clamp(int(std::floor(place[a] + 0.5)), 0, kBrickDim);
  }
  if (mask_test(m_tissue, brick_offset(cell))) return Content::tissue;
  const bool is_element = m_rows[nearest.x][nearest.y] >> nearest.z & 1;
  return is_element ? Content::surface : Content::air;
}

Content CellContents::best_in(int cell) const {
  if (mask_test(m_tissue, cell)) return Content::tissue;
  const Vec3i at = brick_local(cell);
  const unsigned rows = m_rows[at.x][at.y] | m_rows[at.x][at.y + 1] | m_rows[at.x + 1][at.y] |
                        m_rows[at.x + 1][at.y + 1];
  return (rows >> at.z & 3) != 0 ? Content::surface : Content::air;
}

}  // namespace supple
