// A body with cut links, as the inversion sees it: which corners of a lattice cell are still on the
// same side, and one value of u per side where there used to be one per voxel.
//
// Two corners of a cell are on the same side when uncut links of that cell connect them. A cut goes
// on through the shell around the elements, where each voxel belongs to its nearest element; beside
// a surface that is known, to the nearest on its own side of it (cut_planes.h). Links there are cut
// when a cut lies between the elements of their ends, or when no tissue joins these within a few
// voxels and they have moved apart by more than one, so that no tissue is stretched over a slit of
// air through which the cut goes. Cost: about 1 µs per cut link; beyond, 1 µs per shell voxel of
// bricks in which elements move apart.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "volumes/field/cuts/cut_planes.h"
#include "volumes/field/vector_bricks.h"
#include "volumes/grid/link_cuts.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

/// Sides of the corners of a cell, from 0; corner 4 x + 2 y + z.
struct CellSides {
  std::array<std::uint8_t, 8> of{};
  int count = 1;
};

class CutBody {
 public:
  struct Link {
    Vec3i low;  // its end at the lower index
    int axis;
  };

  /// `u`: on elements and shell; those of elements count. `cuts`: links between elements, bricks as
  /// in `elements`, which outlives the body. Along an axis of `dims` with one slice, its copies
  /// below and above count as voxels, too.
  CutBody(const VectorBricks& u, const BrickTopology& elements, const LinkCuts& cuts,
          const Vec3i& dims);

  bool is_cut(const Vec3i& low, int axis) const;
  /// Where the surface crosses a link that is cut; 0: unknown.
  LinkCuts::Place place(const Link& link) const;
  const BrickTopology& elements() const { return m_elements; }
  bool is_element(const Vec3i& voxel) const { return m_elements.is_active(in_slice(voxel)); }
  /// Whether uncut links lead from one corner of a cell to another.
  bool connects(const Vec3i& from, const Vec3i& to) const;
  CellSides sides(const Vec3i& cell) const;
  /// Sorted; all corners are voxels, and they have several sides.
  const std::vector<Vec3i>& parted_cells() const { return m_parted; }

 private:
  Vec3i in_slice(Vec3i voxel) const;
  bool is_voxel(const Vec3i& voxel) const;
  struct CutAxes {
    std::uint8_t bits = 0;  // 0 to 2: axes
    std::array<LinkCuts::Place, 3> places{};
  };
  void mark(const Link& link, LinkCuts::Place place = 0);
  CutPlanes::Side side_of(const Vec3i& voxel) const;
  /// The element that a voxel goes with, and its side of the surface.
  struct Owner {
    Vec3i element;
    CutPlanes::Side side;
  };
  Owner owner_of(const Vec3i& voxel) const;
  void join_around(const Vec3i& cell, CellSides& sides) const;
  std::vector<Vec3i> contested_voxels(const VectorBricks& u) const;
  BrickTopology shell_beside_cuts(const VectorBricks& u, const std::vector<Link>& links) const;
  void cut_shell(const VectorBricks& u, const std::vector<Link>& links);
  bool joins(const IndexBox& box, const Vec3i& from, const Vec3i& to, bool over_cuts) const;
  bool separates(const VectorBricks& u, const Vec3i& a, const Vec3i& b) const;
  void find_parted_cells();

  BrickTopology m_voxels;  // elements and shell
  const BrickTopology& m_elements;
  Vec3i m_dims;
  std::unordered_map<Vec3i, CutAxes, VoxelHash> m_cut;
  CutPlanes m_planes;
  std::vector<Vec3i> m_parted;
};

/// u extended over the shell anew where a cut parts it: each voxel there looks at its own side
/// only. Everything else keeps its bits.
void extend_beside_cuts(VectorBricks& u, const CutBody& body);

/// A parted cell whose sides are apart: displacements of its corners as each side has them.
struct TornCell {
  Vec3i cell;
  CellSides sides;
  std::vector<std::array<Vec3f, 8>> u;  // per side
};

/// Where the own corners of a side end, u is extrapolated: linearly along links where there are two
/// in a row, else constant. Cells that share a corner of a side share what they extrapolate, so
/// that a side is continuous from cell to cell. Sides that are nowhere further apart than `closed`
/// voxels count as one. Sorted by cell.
std::vector<TornCell> torn_cells(const VectorBricks& u, const CutBody& body, double closed);

}  // namespace supple
