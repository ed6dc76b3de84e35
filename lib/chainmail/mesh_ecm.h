// Enhanced ChainMail on mesh bodies: membranes, networks, surfaces of the cortex (thesis sections
// 4.2.5 and 6.1.2), in exact integer form. Theory as for voxel bodies (ecm.h, docs/models/ecm.md);
// the links' limits: mesh_links.h; the engine: flat_engine.h.
//
// Offsets from rest are integers of 2^-16 mm along LPS x, y, z; results are the same bits whatever
// the processing order. They are written to MeshBody::pos_mm as rest + q 2^-16 mm, so that other
// models may move the same body in between.
//
// Cost on one thread: a look at every position per drag (1 to 3 ns per node), then 130 to 165 ns
// per moved node and coordinate.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "lib/chainmail/drag.h"
#include "lib/mesh/mesh_body.h"
#include "volumes/base/progress.h"

namespace supple {

class MeshLinks;
class MeshValues;

/// Factors of a link's rest length: 0 < min_length <= 1 <= max_length, shear >= 0, finite.
struct MeshLimits {
  double max_length, min_length, shear;
};

/// Indices of nodes that are held together; one that is named twice counts once.
using NodeSet = std::vector<int>;

/// A grabbed set and how far all its nodes move from where they are now, as one.
struct MeshHandle {
  NodeSet nodes;
  Vec3d by_mm;
  HandleKind kind = HandleKind::two_sided;
};

/// Links whose limits the positions break, rounded to 2^-16 mm, with the largest excess. A link
/// counts once, however many of its coordinates are broken.
struct MeshLinkCheck {
  std::int64_t links = 0;
  std::int64_t violated = 0;
  double worst_excess_mm = 0;
};

struct MeshProjection {
  std::int64_t violated_links = 0;
  std::int64_t held_moved = 0;  // nodes that were to stay but had to move
  double max_move_mm = 0;       // of one coordinate, rounding to 2^-16 mm not counted
};

struct MeshEcmReport {
  /// Part of the drag that anchors allow, kept rational; 1/1 when nothing stops it.
  std::int64_t fraction_numerator = 1;
  std::int64_t fraction_denominator = 1;
  std::int64_t moved = 0;     // nodes whose offset changed, after the projection
  MeshProjection projection;  // of an invalid start
  std::int64_t visited = 0;   // nodes, all coordinates
  std::int64_t max_queue = 0;
  double milliseconds = 0;

  double fraction() const { return double(fraction_numerator) / double(fraction_denominator); }
};

class MeshEcm {
 public:
  /// Refers to the body, whose nodes, rest positions and links must not change meanwhile; its
  /// positions may, by any model. Throws InputError: limits out of range, or not as many as links.
  MeshEcm(MeshBody& body, const MeshLimits& limits);
  /// Takes one entry of limits per link of the body.
  MeshEcm(MeshBody& body, const std::vector<MeshLimits>& limits);
  ~MeshEcm();
  MeshEcm(const MeshEcm&) = delete;
  MeshEcm& operator=(const MeshEcm&) = delete;

  /// Moves the handles, holds every node of the anchors where it is, and lets the body follow:
  /// median(L, q, U) of the envelopes. Anchors shorten the whole drag by one fraction; handles must
  /// agree with each other for the whole drag, whatever the anchors allow. Positions that another
  /// model left are rounded to 2^-16 mm and, when they break limits, projected first, the anchors
  /// in their places where the links allow that. A push handle takes part upwards or downwards
  /// only, and is not held after the drag; velocities stay. Throws InputError: an empty set, an
  /// index without node, a node in two sets, handles that contradict each other (names the pair and
  /// the missing distance in mm), an offset beyond +-16383 mm, a position that is not finite. The
  /// body is unchanged then, also when `progress` cancels.
  MeshEcmReport drag(const std::vector<MeshHandle>& handles, const std::vector<NodeSet>& anchors,
                     Progress* progress = nullptr);

  /// Checks links at the body's present positions. 16 to 28 ns per link. Throws InputError as drag.
  MeshLinkCheck check_links() const;
  /// Rounds the body's positions to 2^-16 mm and, when they break limits, projects them to
  /// floor((L + U) / 2): valid, with the smallest possible largest move; nodes of `anchored` keep
  /// their places where the links allow that for all of them. Throws InputError as drag.
  MeshProjection project(const std::vector<NodeSet>& anchored = {}, Progress* progress = nullptr);

  /// Memory of this object; the body's not included.
  std::size_t bytes() const;

 private:
  Vec3d place_of(Slot node) const;
  void require_positions() const;
  /// True where the body's positions are those that the last drag gave it.
  bool holds_positions() const;
  MeshProjection take_positions(const std::vector<NodeSet>& anchors, Progress* progress);
  void give_positions(bool all);
  std::int64_t count_moved() const;

  MeshBody& m_body;
  struct Coordinates;
  std::unique_ptr<Coordinates> m_coordinates;
  const MeshLinks& m_links;
  std::array<MeshValues, 3>& m_values;
  bool m_is_valid = true;  // the values, whatever the positions are
};

}  // namespace supple
