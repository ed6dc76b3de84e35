// The lips of cuts: on either side of every cut link the point at which the side ends, and where
// these points press against the other lip.
//
// A sheet is a connected part of a cut across one axis of the lattice, that which its normal is
// nearest to (within 45 degrees). At rest it is a height over the other two axes; each of its lips
// stays one as long as it does not fold. A point p of one lip lies before the other one when its
// height is below (above) that of the lip's cell over which it is now. With the weights w_k of that
// cell's corners b_k, sum w_k = 1, and any e_k with sum w_k e_k = 0,
//   h(b_k) - h(p) >= e_k for all k   implies   sum w_k h(b_k) - h(p) >= 0.
// So a contact becomes up to four difference constraints in the coordinate across the sheet,
// whatever the lips slid along each other. e_k is the cell's present shape.
//
// Lips end where the inversion lets them end (volumes/field/cuts/cut_body.h): half a link beyond
// the last element, more or less, carried on linearly. Cost: 2 us per cut link.
#pragma once

#include <array>
#include <memory>
#include <unordered_map>
#include <vector>

#include "lib/body/body.h"
#include "lib/chainmail/contact_link.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

/// Lips that lie in each other by no more than this, in voxels, are parted where there is room, and
/// stop nothing.
constexpr double kLipOverlap = 0.1;

class CutLips {
 public:
  /// Of the cut links between elements that are not both of rigid pieces. Both outlive this.
  CutLips(const Body& body, const LinkCuts& cuts);

  bool empty() const;
  /// Whether the body has the elements, cut links and rigid pieces of which these were found.
  bool is_current() const;
  /// The points of both lips across each axis that lie before the other lip, or beside it.
  using Before = std::array<std::array<std::vector<char>, 2>, 3>;
  Before points_before() const;

  struct Contacts {
    std::vector<ContactLink> links;
    std::int64_t overlapping = 0;  // points that lie behind the other lip
    std::int64_t too_deep = 0;     // of these, by more than kLipOverlap
    double deepest_voxels = 0;
  };
  /// Contacts across one axis in the present state. Points more than two voxels behind a lip count
  /// where they lay `before` it: others came round the end of the cut.
  /// `part`: of the way out that overlapping points are to go.
  Contacts contacts(int axis, const Before& before, double part = 1) const;

 private:
  struct Lip {
    std::array<Slot, 2> ends;  // low, high
    Vec3i low;
    double place;  // 0 to 1 along the link
    int sheet;
    bool is_layered = false;  // another lip of the sheet lies before or behind it
  };
  /// Corners at (0, 0), (1, 0), (0, 1), (1, 1) along the other two axes: points of lips, or, where
  /// a lip ends, what is half a voxel beyond them.
  struct Cell {
    std::array<int, 4> lips;
    std::array<double, 8> beyond{};  // u, v of each corner
  };
  struct Sheets {
    std::vector<Lip> lips;
    std::vector<Cell> cells;
  };
  /// Where a point of a lip is over a cell of the other one.
  struct Facing {
    std::array<double, 4> weights;
    double gap;  // voxels along the axis; negative behind
    double slid;
  };
  using Points = std::vector<Vec3d>;
  class CellFinder;

  using LipMap = std::unordered_map<Vec3i, int, VoxelHash>;  // by the voxel at the low end

  static bool is_of_one_layer(const Sheets& sheets, std::size_t lip, const Cell& cell);
  static Cell rim_cell(int lip, int beside, int above, double u, double v);
  void join_sheets(int axis);
  int neighbour(int axis, const LipMap& at, const Lip& lip, int along, int step) const;
  Vec3d displacement(Slot slot) const;
  Vec3d carried_on(Slot beyond, Slot own) const;
  Points points(int axis, int side) const;
  template <class Visit>
  void for_each_facing(int axis, Visit&& visit) const;

  const Body& m_body;
  const LinkCuts& m_cuts;
  struct Source {
    BrickTopology elements;
    LinkCuts cuts;
    std::shared_ptr<const BrickValues> rigid;
  };
  Source m_source;
  std::array<Sheets, 3> m_sheets;
};

}  // namespace supple
