// One brick with the data of its cells: the offsets of its elements and one layer around them,
// corners included, and the volume by which each cell that touches the brick exceeds its rest
// volume.
//
// Every other value along k lies side by side, since neighbours never step together: a row holds
// the values of even k, then those of odd k.
#pragma once

#include <array>
#include <cstdint>

#include "lib/body/body.h"
#include "lib/body/slot_set.h"
#include "lib/relax/brick_springs.h"

namespace supple {

/// The brick and the 26 around it, 9 (di + 1) + 3 (dj + 1) + dk + 1; -1 where there is none or no
/// chain of face neighbours along i, then j, then k leads there, in which case no cell does.
using BricksAround = std::array<std::int32_t, 27>;
BricksAround bricks_around(const BrickTopology& elements, std::size_t b);

/// Bit k + 1 of row [i + 1][j + 1]: a cell has its lowest corner at (i, j, k), each from -1 to 7.
struct CellRows {
  std::uint16_t rows[9][9];
  bool any = false;
};
CellRows find_cells(const Body& body, const BricksAround& around);

/// Calls visit(lowest) for the cells whose lowest corner lies in the brick, in brick order; local
/// coordinates.
template <class Visit>
void for_each_cell(const CellRows& cells, Visit&& visit) {
  for (int i = 0; i < 8; ++i) {
    for (int j = 0; j < 8; ++j) {
      for (unsigned bits = cells.rows[i + 1][j + 1] >> 1; bits != 0; bits &= bits - 1) {
        visit(Vec3i(i, j, __builtin_ctz(bits)));
      }
    }
  }
}

/// The slot at local coordinates from -1 to 8, in a brick that is there.
inline Slot slot_around(const BricksAround& around, int i, int j, int k) {
  const auto side = [](int local) { return local < 0 ? 0 : local > 7 ? 2 : 1; };
  const int n = 9 * side(i) + 3 * side(j) + side(k);
  const std::int32_t brick = around[std::size_t(n)];
  return Slot(brick) * kBrickVoxels + Slot(64 * (i & 7) + 8 * (j & 7) + (k & 7));
}

/// Edge of a cell at rest in 2^-32 voxel, and its volume in (2^-32 voxel)^3.
constexpr double kFineVoxel = 65536.0 * kFinePerUnit;
constexpr double kFineCell = kFineVoxel * kFineVoxel * kFineVoxel;

struct alignas(64) CellBrick {
  /// Values of a row, and the place of its first odd k: even k = 0 … 8, then odd k = -1 … 7.
  static constexpr int kRowLength = 10, kFirstOdd = 5;
  /// Places in a row where the four values at k - 1, k and k + 1 begin, for k even (0, 2, 4, 6) and
  /// for k odd.
  static constexpr int kPlace[2][3] = {{5, 0, 6}, {0, 6, 1}};

  double offsets[3][100 * kRowLength];  // per coordinate, 2^-32 voxel
  /// Root of a cell's share of the bulk modulus (cell_moduli.h), by its lowest corner: 0 where
  /// there is no cell, 1 where all are alike. Times the volume beyond rest it is `excess`, (2^-32
  /// voxel)^3, so that squares of excesses are energies.
  double root_share[81 * kRowLength];
  double excess[81 * kRowLength];

  /// First value of row (i, j), each from -1 to 8 for offsets and to 7 for cells.
  static constexpr int node_row(int i, int j) { return (10 * (i + 1) + j + 1) * kRowLength; }
  static constexpr int cell_row(int i, int j) { return (9 * (i + 1) + j + 1) * kRowLength; }
  /// Place of value k in its row.
  static constexpr int place(int k) { return (k & 1) != 0 ? kFirstOdd + (k + 1) / 2 : k / 2; }
};

/// Fills in offsets and a `root_share` of 1 per cell; absent elements are at rest.
void fill_cells(const std::array<BrickArray<double>, 3>& offsets, const BricksAround& around,
                const CellRows& cells, CellBrick& out);
/// Copies the offsets of the brick itself to `out`, 512 of coordinate c.
void take_offsets(const CellBrick& brick, int c, double* out);

}  // namespace supple
