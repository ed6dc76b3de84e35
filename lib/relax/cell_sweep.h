// One sweep of volume-conserving relaxation over one brick, in place: every free element steps to
// where its links and its eight cells balance, one coordinate after the other, no further than the
// limits allow.
//
// Elements that share a cell never step together: eight colours, by the parity of i, j and k. About
// 400 operations per element, four elements along k at a time.
#pragma once

#include <array>

#include "lib/body/body.h"
#include "lib/body/region.h"
#include "lib/body/slot_set.h"
#include "lib/relax/brick_springs.h"
#include "lib/relax/cell_brick.h"
#include "lib/relax/link_table.h"

namespace supple {

using LinkTables = std::array<const LinkTable*, 3>;  // per coordinate

/// Bounds of a brick's elements, 2^-32 voxel; infinite where there is none.
struct BrickBounds {
  double least[3][kBrickVoxels], most[3][kBrickVoxels];
};

/// Stiffness of an element without links and cells, whose step is then 0 / kNoStiffness.
constexpr double kNoStiffness = 1e-300;

/// Over-relaxation helps slow modes of the springs. Where cells are much stiffer, the slow modes
/// are those that keep volumes, which it does not help, and the others only ring. So the part
/// beyond 1 shrinks with the share of the links. Measured on a pressed ball of 24 voxels, kappa =
/// 10, 100 and 1000 times Young's modulus: the best fixed values were 1.65, 1.3 and 1.1.
template <class Number>
inline Number damped_relaxation(double relaxation, Number of_links, Number of_cells) {
  return 1 + (relaxation - 1) * of_links / (of_links + 0.25 * of_cells + kNoStiffness);
}

struct CellSweep {
  double relaxation = 1;  // part of the way to where forces balance, before it is damped; below 2
  /// Per coordinate: bulk modulus * rest volume / spacing^2 as seen by volumes in 2^-32 voxel:
  /// times the square of a cell's excess it is twice the cell's energy, N/m * (2^-32 voxel)^2.
  std::array<double, 3> weight{};
  std::array<BrickMask, 3> free;           // per coordinate
  const BrickBounds* bounds = nullptr;     // null: none
  std::array<const BrickRest*, 3> rest{};  // per coordinate; null: all elastic, undeformed at rest
};

/// Computes `excess` of all cells of the brick from its offsets; 0 where there is no cell.
void find_excess(CellBrick& brick);

/// Steps the free elements; returns the largest step, 2^-32 voxel. Keeps `excess` up to date.
double sweep_cells(CellBrick& brick, const BrickSprings& links, const LinkTables& tables,
                   const CellSweep& sweep);

struct CellEnergy {
  std::array<double, 3> links{};  // per coordinate, twice, N/m * (2^-32 voxel)^2
  double excess_squared = 0;      // (2^-32 voxel)^6
};
/// Energy of the links to next elements and of the cells that begin in the brick.
CellEnergy energy_of_cells(const CellBrick& brick, const BrickSprings& links,
                           const LinkTables& tables, const std::array<const BrickRest*, 3>& rest);

}  // namespace supple
