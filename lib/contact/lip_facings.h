// Cells that the points of the lips of cuts face, followed from one state of the body to the next:
// bricks of offsets are compared with what they were, and points whose elements moved, cells with
// such points and the points over these are looked at anew. Cost: 2 us per cut link at first, later
// per one that moved or whose other lip did; others cost a comparison of the bricks that they read.
#pragma once

#include <array>
#include <unordered_map>
#include <vector>

#include "lib/body/body.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

/// The sheets of cuts across one axis of the lattice.
struct LipSheets {
  struct Lip {
    std::array<Slot, 2> ends;  // low, high
    Vec3i low;
    double place;  // 0 to 1 along the link
    int sheet;
    bool is_layered = false;  // another lip of the sheet lies before or behind it
  };
  /// Corners at (0, 0), (1, 0), (0, 1), (1, 1) along the other two axes: points of lips, or, where
  /// a lip ends, points half a voxel beyond them.
  struct Cell {
    std::array<int, 4> lips;
    std::array<double, 8> beyond{};  // u, v of each corner
  };

  std::vector<Lip> lips;
  std::vector<Cell> cells;
};

class LipFacings {
 public:
  /// The facings of the cuts of the body across an axis. All arguments outlive it.
  LipFacings(const Body& body, const LinkCuts& cuts, const LipSheets& sheets, int axis);

  /// Place of a point of a lip over a cell of the other one.
  struct Facing {
    std::size_t cell;
    std::array<double, 4> weights;
    double gap;  // voxels along the axis; negative behind
    double slid;
  };
  /// Calls `visit(side, lip, facing)` for every point of a lip over a cell of the other lip, in the
  /// present state.
  template <class Visit>
  void for_each(Visit&& visit) {
    follow();
    for (int side = 0; side < 2; ++side) {
      const std::vector<std::vector<Facing>>& facings = m_sides[std::size_t(side)].facings;
      for (std::size_t n = 0; n < facings.size(); ++n) {
        for (const Facing& facing : facings[n]) visit(side, n, facing);
      }
    }
  }

 private:
  /// An element that carries on to the other side, and the one behind it.
  struct Carrier {
    Slot near, behind;
  };
  /// The cells that may lie over a square of one voxel of a sheet, ascending, and the points there.
  struct Square {
    std::vector<int> cells, points;
  };
  /// The points of one side, and the cells of the other side's points.
  struct Side {
    std::vector<Vec3d> points;
    std::vector<std::int32_t> first_carrier;  // of every lip; and the end
    std::vector<Carrier> carriers;
    std::vector<std::array<double, 8>> corners;  // of the cells, along the other two axes
    std::unordered_map<Vec3i, Square, VoxelHash> squares;
    std::vector<std::vector<Facing>> facings;  // of every point
  };
  /// A brick of offsets as it was, and the lips whose points depend on it.
  struct Brick {
    std::vector<std::int32_t> q;  // of three coordinates
    std::vector<int> lips;        // 2 * lip + side
  };
  using Marks = std::vector<std::uint8_t>;

  void list_carriers(int side);
  void read_by(Slot slot, int lip);
  void follow();
  bool take_over(std::size_t b, Brick& brick) const;
  Vec3d displacement(Slot slot) const;
  Vec3d point(int side, std::size_t lip) const;
  std::vector<int> move_points(int side, const std::vector<int>& lips, Marks& is_stale);
  void move_cells(int side, const std::vector<int>& of_lips, Marks& is_stale);
  std::vector<Facing> facings_of(int side, std::size_t lip) const;
  bool is_of_one_layer(std::size_t lip, const LipSheets::Cell& cell) const;
  Vec3i square_of(std::size_t lip, const Vec3d& point) const;
  template <class Visit>
  void for_squares(const LipSheets::Cell& cell, const std::array<double, 8>& corners,
                   Visit&& visit) const;

  const Body& m_body;
  const LinkCuts& m_cuts;
  const LipSheets& m_sheets;
  const int m_axis, m_u, m_v;  // across, along
  std::array<Side, 2> m_sides;
  std::vector<std::vector<int>> m_cells_of;  // of every lip
  std::unordered_map<std::size_t, Brick> m_bricks;
};

}  // namespace supple
