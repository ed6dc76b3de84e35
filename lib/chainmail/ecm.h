// Enhanced ChainMail in exact integer form (thesis section 4.2, design.md section 3).
//
// Per coordinate the links are difference constraints; "largest constraint violation first" is
// Dijkstra's algorithm on their slack. The result is the least solution, the same bits whatever
// the processing order or the number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "lib/body/body.h"
#include "lib/body/region.h"
#include "lib/body/slot_set.h"
#include "lib/body/smallest_motion.h"
#include "lib/chainmail/drag.h"
#include "lib/chainmail/propagate.h"
#include "volumes/base/progress.h"

namespace supple {

class FreePieces;
struct FixedElements;
struct HeldVoxels;
struct LastingBounds;

/// Moves the handles, holds every element of the anchors where it is, and lets the body follow:
/// median(L, q, U) of the envelopes. Rigid pieces (Body::rigid) that are not grabbed as a whole
/// only shift, all elements by the same; those that are must have targets that keep them rigid.
/// Anchors shorten the whole drag by one fraction; handles must agree with each other for the whole
/// drag, whatever the anchors allow. A start that is not known to be valid
/// (Body::links_known_valid) is checked and, when invalid, projected first, to floor((L + U) / 2);
/// with Body::beyond, what is beyond limits moves as it is (beyond_limits.h).
/// Throws InputError: a handle or anchor without element (names the nearest one), a voxel in two
/// handles or in a handle and an anchor, handles that contradict each other (names the pair and the
/// missing distance in mm), an offset beyond the range. The body is unchanged then, also when
/// `progress` cancels. Memory: 2 kB per brick touched and coordinate, for undoing.
EcmReport drag(Body& body, const std::vector<Handle>& handles, const std::vector<Region>& anchors,
               Progress* progress = nullptr);

/// The same among the elements that earlier drags hold, which count as anchors; these handles are
/// added to `holds`. Elements that are grabbed again are no anchors. Where a push handle grabbed
/// them both times, the new one is the same tool and goes on.
EcmReport drag(Body& body, const std::vector<Handle>& handles, const std::vector<Region>& anchors,
               Holds& holds, Progress* progress = nullptr);

/// The same for many drags of one body: queues, tables, undo memory and the elements of the anchors
/// stay, so that a local drag costs what it moves. The body's elements, classes and slacks must not
/// change between drags; its offsets and cuts may.
class EcmSolver {
 public:
  explicit EcmSolver(Body& body, Engine engine = Engine::automatic);
  ~EcmSolver();

  EcmReport drag(const std::vector<Handle>& handles, const std::vector<Region>& anchors,
                 Progress* progress = nullptr);
  EcmReport drag(const std::vector<Handle>& handles, const std::vector<Region>& anchors,
                 Holds& holds, Progress* progress = nullptr);

  /// Drags all or nothing: where anchors stop a part of the drag nothing moves, and the report's
  /// fraction says how much they allow.
  EcmReport drag_whole(const std::vector<Handle>& handles, const std::vector<Region>& anchors,
                       Holds& holds, Progress* progress = nullptr);

  /// Drags as drag(), or as drag_whole(), unless free pieces would shift. In that case nothing
  /// moves, and the report says which pieces would, and how far.
  EcmReport drag_unless_pieces_shift(const std::vector<Handle>& handles,
                                     const std::vector<Region>& anchors, Holds& holds, bool whole,
                                     Progress* progress = nullptr);

  /// Makes the whole drag with shifts of free pieces, or the part that anchors allow where that
  /// shifts none. Otherwise nothing moves: anchors stop a part of the drag that shifts the pieces
  /// of the report.
  EcmReport drag_whole_or_unshifted(const std::vector<Handle>& handles,
                                    const std::vector<Region>& anchors, Holds& holds,
                                    Progress* progress = nullptr);

  /// The report that drag_whole() would give; the body stays. Throws as drag() does.
  EcmReport try_whole(const std::vector<Handle>& handles, const std::vector<Region>& anchors,
                      const Holds& holds, Progress* progress = nullptr);

  /// Bounds that tissue puts on each element of the pieces by itself while the whole drag is
  /// performed: between the envelopes of all held elements, handles at their targets. Bounds
  /// further than `reach_q` from the place of an element are left out, and so are elements without
  /// any. A drag that keeps the pose of a single piece within them can only fail by paths that lead
  /// from the piece back to itself. `lasting`: of the same search (piece_bounds.h). Cost: six
  /// propagations, as far as `reach_q`, of all that is held where they are not known so far yet,
  /// and of the handles that do not last; and a copy of all offsets.
  std::vector<std::vector<ElementBounds>> bounds_of(const std::vector<const RigidPiece*>& pieces,
                                                    const std::vector<Handle>& handles,
                                                    const std::vector<Region>& anchors,
                                                    const Holds& holds, std::int32_t reach_q,
                                                    LastingBounds& lasting,
                                                    Progress* progress = nullptr);

  /// The engine in use, block or flat.
  Engine engine() const { return m_propagator.engine(); }
  /// Memory kept between drags, the body's not included.
  std::size_t bytes() const;

 private:
  /// part: as far as anchors allow; whole: all or nothing; tried: nothing, but the report.
  enum class Extent { part, whole, tried };
  /// When free pieces may shift; in_whole: in the whole drag alone, where anchors stop nothing.
  enum class Shifts { allowed, in_whole, never };
  EcmReport run(const std::vector<Handle>& handles, const std::vector<Region>& anchors,
                Holds& holds, Extent extent, Shifts shifts, Progress* progress);
  FreePieces free_pieces(const HeldVoxels& held) const;
  const FixedElements& fixed(const std::vector<Region>& anchors);

  Body& m_body;
  Propagator m_propagator;
  std::array<UndoLog, 3> m_undo;           // per coordinate
  std::unique_ptr<FixedElements> m_fixed;  // of the last drag's anchors
};

/// Projects an invalid configuration to floor((L + U) / 2): the smallest possible largest move.
/// Fixed and held elements stay, and push handles keep their side, in every coordinate in which the
/// links allow that. In the other coordinates all elements move, and `held_moved` counts those of
/// `fixed` and `held.anchored` that did.
struct ProjectionReport {
  std::int64_t violated_links = 0;
  double max_move_voxels = 0;
  std::int64_t held_moved = 0;
};
ProjectionReport project(Body& body, const SlotSet& fixed = {}, const Holds& held = {},
                         Progress* progress = nullptr);

/// Gives the body its Body::beyond: q less the offsets that project() would make of it. Nothing
/// moves; the links of the admissible offsets are known to hold. Throws Cancelled, with the body as
/// it was.
void keep_beyond(Body& body, const SlotSet& fixed, const Holds& held, Progress* progress = nullptr);

}  // namespace supple
