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
// the last element, more or less, carried on linearly. Cost: that of lip_facings.h.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "lib/body/body.h"
#include "lib/contact/contact_link.h"
#include "lib/contact/lip_facings.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

/// Lips that lie in each other by no more than this, in voxels, are parted where there is room, and
/// stop nothing.
constexpr double kLipOverlap = 0.1;

/// Earlier places of the points of both lips across each axis.
struct LipsBefore {
  static constexpr float kBeside = 1e9F;
  struct Side {
    std::vector<char> is_before;   // the other lip, or beside it
    std::vector<float> least_gap;  // voxels, negative behind the other lip; kBeside without one

    bool operator==(const Side& other) const {
      return is_before == other.is_before && least_gap == other.least_gap;
    }
  };
  std::array<std::array<Side, 2>, 3> of;
};

/// Follows the body from one question to the next, so only one thread at a time may ask.
class CutLips {
 public:
  /// The lips of cut links between elements that are not both of rigid pieces. Both outlive this.
  CutLips(const Body& body, const LinkCuts& cuts);

  bool empty() const;
  /// True while the body has the elements, cut links and rigid pieces of which these were found.
  bool is_current() const;
  LipsBefore points_before();

  struct Contacts {
    std::vector<ContactLink> links;
    std::int64_t overlapping = 0;  // points that lie behind the other lip
    std::int64_t too_deep = 0;     // of these, by more than kLipOverlap
    std::int64_t deepened = 0;     // of these, deeper than they were `before`
    double deepest_voxels = 0;
  };
  /// Contacts across one axis in the present state. Points more than two voxels behind a lip count
  /// where they lay `before` it: others came round the end of the cut. With Body::beyond, those
  /// that lay too deep stay where they are. `part`: the part of the way out that overlapping points
  /// are to go.
  Contacts contacts(int axis, const LipsBefore& before, double part = 1);

 private:
  using Lip = LipSheets::Lip;
  using Cell = LipSheets::Cell;
  using LipMap = std::unordered_map<Vec3i, int, VoxelHash>;  // by the voxel at the low end

  static Cell rim_cell(int lip, int beside, int above, double u, double v);
  void join_sheets(int axis);
  int neighbour(int axis, const LipMap& at, const Lip& lip, int along, int step) const;
  LipFacings& facings(int axis);

  const Body& m_body;
  const LinkCuts& m_cuts;
  struct Source {
    BrickTopology elements;
    LinkCuts cuts;
    std::shared_ptr<const BrickValues> rigid;
  };
  Source m_source;
  std::array<LipSheets, 3> m_sheets;
  std::array<std::optional<LipFacings>, 3> m_facings;  // none: nobody has asked
};

}  // namespace supple
