// The faces that an opened cut shows: a point on every cut link whose ends have moved apart, where
// the surface crossed it, each with the plane that fits the points around it. Within each cell the
// face is where the distances of the corners from those planes interpolate to zero, between the
// ends of every cut link; of a plane cut that is the plane. Where no surface is known (a cut around
// a label, a state of an older version) the points are the middles of the links. A cell in which
// more than two sides meet is split by voxels. Points and their planes are those of the body at
// rest, so they change only where cells are torn or close. Cost: about 4 µs and 0.5 kB per point
// once, 0.1 µs per look-up near a face.
#pragma once

#include <memory>
#include <vector>

#include "volumes/field/cuts/virtual_nodes.h"
#include "volumes/geometry/geometry.h"
#include "volumes/grid/padded_rows.h"

namespace supple {

// The parted cells of a cut body whose sides are apart, with what each side has where its own
// corners end: linearly along links where there are two in a row, else constant (virtual_nodes.h).

/// The torn cells of every brick of CutBody::cells().
class TornCells {
 public:
  explicit TornCells(const BrickTopology& cells)
      : m_bricks(cells), m_cells(cells.brick_count()), m_nodes(cells.brick_count()) {}

  /// Follows u, on the body's cells, where it has `moved`, and the body, where its links or parted
  /// cells are others, in these bricks. Sides that are nowhere further apart than `closed` voxels
  /// count as one. Returns the bricks in which torn cells are others than before.
  BrickList follow(const VectorBricks& u, const CutBody& body, const BrickList& moved,
                   const BrickList& parted, double closed);

  /// The torn cells that begin in brick b, sorted.
  const std::vector<TornCell>& in(std::size_t b) const { return m_cells[b]; }
  const BrickTopology& bricks() const { return m_bricks; }
  std::int64_t count() const { return m_count; }
  bool empty() const { return m_count == 0; }
  bool holds(const Vec3i& cell) const;

 private:
  BrickTopology m_bricks;
  std::vector<std::vector<TornCell>> m_cells;
  std::vector<std::unique_ptr<VirtualNodes>> m_nodes;  // null: no cells are parted, or not known
  std::int64_t m_count = 0;
};

/// How deep behind a face places know it, and how far beside a point its plane counts, in voxels.
constexpr double kDeepestFace = 4, kBesideFace = 1.5;

class CutFaces {
 public:
  /// Starts without faces. `cells`: the bricks of torn cells. Sides closer than `closed` voxels
  /// show no face.
  CutFaces(const BrickTopology& cells, const Geometry& geometry, double closed);

  /// Follows torn cells that are others in these bricks. Returns the bricks of whose places the
  /// faces beside them may be others.
  BrickList follow(const TornCells& torn, const CutBody& body, const BrickList& changed);

  struct Depth {
    double mm;
    Vec3d gradient;  // mm per voxel
  };
  struct Point;
  /// The points of open faces that places in a cell may know; null: none. Valid until follow()
  /// returns its brick.
  using Points = std::vector<const Point*>;
  const Points* seen_from(const Vec3i& cell) const;
  /// Distance of X, index space at rest, from the nearest open face beside it, positive on the side
  /// on which `inside` lies; infinite, without gradient, where none is within four voxels or X is
  /// beyond the end of the cut.
  Depth depth(const Vec3d& X, const Vec3d& inside) const {
    return depth(X, inside, seen_from(floor_voxel(X)));
  }
  /// The same, from what seen_from() gives for the cell in which X lies.
  Depth depth(const Vec3d& X, const Vec3d& inside, const Points* seen) const;
  /// The same beyond the end of the cut, too, as if the face went on.
  Depth depth_beyond(const Vec3d& X, const Vec3d& inside, const Points* seen) const;

  /// Torn cells beside one that is whole: bits 2 a and 2 a + 1, below and above along axis a.
  std::uint8_t torn_beside(const Vec3i& cell) const;
  /// Distance of X, in a whole cell in which a cut ends, from its faces towards the torn cells
  /// `beside`, of which the nearest counts most: the cell is the end of the gap.
  Depth depth_of_end(const Vec3d& X, const Vec3i& cell, std::uint8_t beside) const;

  /// At the corners of a torn cell, the distance in voxels from the face of one side; positive at
  /// its own corners and there alone.
  std::array<float, 8> depths_of_corners(const TornCell& cell, int side) const;

 private:
  /// A cut link between sides that are apart.
  struct Opening {
    CutBody::Link link;
    LinkCuts::Place place;
    Vec3d apart;  // how far the middles are

    bool is_same_link(const Opening& other) const {
      return link.low == other.link.low && link.axis == other.link.axis && place == other.place;
    }
  };
  /// Points of the links of a brick in blocks of four voxels, crossings first.
  struct BrickPoints {
    std::array<std::vector<Point>, 8> blocks;

    bool operator==(const BrickPoints& other) const { return blocks == other.blocks; }
  };
  /// The points that places in the cells of a brick may know.
  struct Seen {
    std::array<std::int32_t, kBrickVoxels> at;  // number of a list, or -1
    std::vector<Points> lists;
  };

  std::vector<Opening> openings_in(const TornCells& torn, const CutBody& body, std::size_t b) const;
  std::unique_ptr<BrickPoints> points_of(std::size_t b) const;
  void fit_planes(std::size_t b);
  void mark_open(std::size_t b);
  std::unique_ptr<Seen> seen_in(std::size_t b) const;
  static void list_seen(const Point& point, const Vec3i& origin, Seen& seen);

  bool is_beside_surface(const Vec3d& X) const;
  bool is_torn(const Vec3i& cell) const;
  bool is_beside_torn(const Vec3d& X) const;
  void fit_plane(Point& point) const;
  struct Distance {
    double voxels = 0;
    bool is_known = false, is_exact = false;
  };
  Distance signed_distance(const Vec3d& X, const Vec3d& orientation) const;
  /// Points are in blocks of four voxels.
  static constexpr int kPointBlock = 4;
  static Vec3i point_block_of(const Vec3d& X) { return floor_voxel(X / double(kPointBlock)); }
  template <class Visit>
  void for_near(const Vec3d& X, Visit&& visit) const;

  BrickTopology m_bricks;
  Geometry m_geometry;
  double m_closed;
  std::vector<std::vector<Opening>> m_openings;  // per brick, by their links
  std::vector<std::unique_ptr<BrickPoints>> m_points;
  std::vector<std::unique_ptr<Seen>> m_seen;
  std::vector<BrickMask> m_torn;  // cells
  Vec3d m_axis_mm;
};

struct CutFaces::Point {
  Vec3d at;                  // index space
  Vec3d normal_mm{0, 0, 0};  // (X - at) . normal_mm is the distance from its plane in mm
  Vec3d across{0, 0, 0};     // the normal's direction, length 1
  std::int32_t opening = 0;  // of its brick
  std::int32_t axis = 0;     // of its link
  bool is_open = false;
  bool is_crossing = false;  // of a surface; otherwise the middle of a link

  bool operator==(const Point& other) const {
    return at == other.at && normal_mm == other.normal_mm && across == other.across &&
           is_open == other.is_open && is_crossing == other.is_crossing;
  }
};

template <class Visit>
void CutFaces::for_near(const Vec3d& X, Visit&& visit) const {
  const Vec3i middle = point_block_of(X);
  for (int n = 0; n < 27; ++n) {
    const Vec3i block = middle + surrounding_step(n);
    const std::int32_t b = m_bricks.find(block * kPointBlock);
    if (b < 0 || !m_points[std::size_t(b)]) continue;
    const int number = (block.x & 1) * 4 + (block.y & 1) * 2 + (block.z & 1);
    for (const Point& point : m_points[std::size_t(b)]->blocks[std::size_t(number)]) visit(point);
  }
}

}  // namespace supple
