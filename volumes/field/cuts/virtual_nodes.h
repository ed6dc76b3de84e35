// A plan for the nodes of sides of a brick's parted cells that are not their own corners: which
// voxels carry on to which corner. It follows from the cut links alone, so that displacements are
// followed by evaluating it. Cells that share a corner of a side share what they extrapolate, so
// that a side is continuous from cell to cell. Cost: about 5 µs and 0.5 kB per parted cell once,
// 0.3 µs each time.
#pragma once

#include <array>
#include <vector>

#include "volumes/field/cuts/cut_body.h"

namespace supple {

/// Displacements of the corners of a parted cell, as each side has them.
struct TornCell {
  Vec3i cell;
  CellSides sides;
  std::vector<std::array<Vec3f, 8>> u;  // per side

  bool operator==(const TornCell& other) const {
    return cell == other.cell && sides == other.sides && u == other.u;
  }
};

class VirtualNodes {
 public:
  /// Plans for parted cells that begin in brick b of the body's cells. `voxels`: those of u.
  VirtualNodes(const BrickTopology& voxels, const CutBody& body, std::size_t b);

  /// The cells whose sides are anywhere further apart than `closed` voxels, sorted.
  std::vector<TornCell> torn(const BrickVectors& u, double closed) const;

 private:
  /// A voxel by where its vector is.
  struct Place {
    std::int32_t brick = -1, offset = 0;
  };
  /// A voxel that carries on to a node, and the one behind it, if that is joined to it.
  struct View {
    Place from, behind;
    int length2;
  };
  struct Cell {
    PartedCell parted;
    std::array<Place, 8> own;                  // its corners
    std::vector<std::array<int, 8>> of_sides;  // the nodes of every side; -1: its own corner
  };

  Vec3f value_of(int node, const BrickVectors& u) const;

  std::vector<Cell> m_cells;
  std::vector<View> m_views;  // by their nodes
  std::vector<int> m_first;   // views of every node; and the end
};

}  // namespace supple
