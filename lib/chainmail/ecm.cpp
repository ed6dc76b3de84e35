#include "lib/chainmail/ecm.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>

#include "lib/body/beyond_limits.h"
#include "lib/chainmail/coordinate_drag.h"
#include "lib/chainmail/held_voxels.h"
#include "lib/chainmail/piece_bounds.h"
#include "volumes/base/parallel.h"
#include "volumes/base/stopwatch.h"

namespace supple {

namespace {

/// Puts the offsets back as they were, unless dismissed: for the projection of an invalid start.
class OffsetsGuard {
 public:
  explicit OffsetsGuard(Body& body) : m_body(body) {
    m_armed = !body.links_known_valid;
    if (!m_armed) return;
    m_before = body.q;
    m_fractions = body.fraction;
  }
  ~OffsetsGuard() {
    if (!m_armed) return;
    m_body.q.swap(m_before);
    m_body.fraction.swap(m_fractions);
    m_body.links_known_valid = false;
  }
  OffsetsGuard(const OffsetsGuard&) = delete;
  OffsetsGuard& operator=(const OffsetsGuard&) = delete;
  void dismiss() { m_armed = false; }

 private:
  Body& m_body;
  bool m_armed = false;
  std::array<BrickValues, 3> m_before;
  std::array<BrickArray<std::int16_t>, 3> m_fractions;
};

/// Keeps the body and its bounds at admissible offsets while this lives.
class AdmissibleDrag {
 public:
  AdmissibleDrag(Body& body, Holds& holds) : m_body(body), m_holds(holds), m_offsets(body) {
    to_admissible(body, holds);
  }
  ~AdmissibleDrag() { from_admissible(m_body, m_holds); }
  AdmissibleDrag(const AdmissibleDrag&) = delete;
  AdmissibleDrag& operator=(const AdmissibleDrag&) = delete;

 private:
  Body& m_body;
  Holds& m_holds;
  AdmissibleOffsets m_offsets;
};

void from_admissible(const Body& body, std::vector<std::vector<ElementBounds>>& bounds) {
  for (std::vector<ElementBounds>& of_piece : bounds) {
    for (ElementBounds& bound : of_piece) {
      for (std::size_t c = 0; c < 3; ++c) {
        const std::int32_t beyond = beyond_at(body, int(c), bound.slot);
        if (bound.least[c] != -ElementBounds::kNone) bound.least[c] += beyond;
        if (bound.most[c] != ElementBounds::kNone) bound.most[c] += beyond;
      }
    }
  }
}

using CoordinateDrags = std::vector<std::unique_ptr<CoordinateDrag>>;

/// Counts elements that changed in any coordinate.
std::int64_t count_moved(const CoordinateDrags& drags) {
  std::vector<std::size_t> bricks;
  for (const auto& drag : drags) {
    bricks.insert(bricks.end(), drag->undo().bricks().begin(), drag->undo().bricks().end());
  }
  if (drags.size() > 1) {
    std::sort(bricks.begin(), bricks.end());
    bricks.erase(std::unique(bricks.begin(), bricks.end()), bricks.end());
  }

  const auto moved_in = [&](std::size_t brick) {
    std::int32_t changes[kBrickVoxels] = {};
    for (const auto& drag : drags) {
      const std::int32_t* before = drag->undo().saved_of(brick);
      if (before == nullptr) continue;
      const std::int32_t* now = drag->values().brick_or_zero(brick);
      for (int n = 0; n < kBrickVoxels; ++n) changes[n] |= before[n] ^ now[n];
    }
    return kBrickVoxels - std::count(changes, changes + kBrickVoxels, 0);
  };
  return parallel_reduce(
      bricks.size(), Grain{64}, std::int64_t(0),
      [&](std::size_t n, std::int64_t& moved) { moved += moved_in(bricks[n]); }, std::plus<>());
}

std::vector<PieceShift> shifted_pieces(const FreePieces& pieces, const CoordinateDrags& drags) {
  if (pieces.empty()) return {};
  std::map<std::size_t, PieceShift> shifts;
  for (const auto& drag : drags) {
    const std::vector<std::int32_t> by_q = pieces.shifts(drag->values(), drag->undo());
    for (std::size_t n = 0; n < by_q.size(); ++n) {
      if (by_q[n] == 0) continue;
      PieceShift& shift = shifts.try_emplace(n, PieceShift{n, {0, 0, 0}}).first->second;
      shift.by_q[std::size_t(drag->coordinate())] = by_q[n];
    }
  }
  std::vector<PieceShift> list;
  for (const auto& [piece, shift] : shifts) list.push_back(shift);
  return list;
}

/// Undo memory that stays for the next drag: one byte per element and coordinate, so that local
/// drags find theirs and whole ones do not hold on to theirs.
std::size_t kept_undo_bricks(const Body& body) {
  return std::size_t(body.elements.active_count()) / (kBrickVoxels * sizeof(std::int32_t)) + 256;
}

bool moves_along(const HeldVoxels& held, int coordinate) {
  return std::any_of(held.handles.begin(), held.handles.end(), [&](const HeldHandle& handle) {
    const auto moves = [&](const std::array<std::int32_t, 3>& by) {
      return by[std::size_t(coordinate)] != 0;
    };
    const auto& each = handle.source->each_by_q;
    return each.empty() ? moves(handle.source->by_q) : std::any_of(each.begin(), each.end(), moves);
  });
}

/// Moves all coordinates to their whole targets; again, shortened by one common fraction, when
/// anchors stop one of them, and with less of their edges when anchors stop those.
CoordinateDrags solve(Body& body, HeldVoxels& held, const FreePieces& pieces,
                      Propagator& propagator, std::array<UndoLog, 3>& undo, bool whole_only,
                      Fraction& fraction, Progress* progress) {
  CoordinateDrags drags;
  for (int c = 0; c < 3; ++c) {
    report(progress, c / 3.0);
    if (!moves_along(held, c)) continue;
    drags.push_back(
        std::make_unique<CoordinateDrag>(body, c, held, pieces, propagator, undo[c], progress));
    drags.back()->try_whole(fraction);
  }
  const bool edges_yielded = std::any_of(drags.begin(), drags.end(),
                                         [](const auto& drag) { return drag->edges_yielded(); });
  if (fraction.is_whole() ? edges_yielded : !whole_only) {
    for (const auto& drag : drags) drag->redo(fraction);
  }
  return drags;
}

/// Adds the places that a push handle came to; one that was withdrawn beyond the range asks nothing
/// more.
void add_bounds(const std::vector<ToolPlace>& places, const Fraction& fraction, bool asks,
                std::vector<Bound>& bounds) {
  for (const ToolPlace& place : places) {
    const std::int32_t value = place.value + fraction.scale(place.by);
    bounds.push_back({place.slot, std::clamp(value, -kMaxOffset, kMaxOffset), asks});
  }
}

/// The holds after the drag: the rest of the earlier holds, and its own handles.
Holds holds_after(const HeldVoxels& held, const Fraction& fraction) {
  Holds holds = held.rest;
  std::vector<SlotSet::Brick> anchored = holds.anchored.bricks();
  for (const HeldHandle& handle : held.handles) {
    if (!handle.is_push()) {
      anchored.insert(anchored.end(), handle.slots.bricks().begin(), handle.slots.bricks().end());
      continue;
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const bool asks = handle.source->is_edge;
      add_bounds(handle.below[c], fraction, asks, holds.at_least[c]);
      add_bounds(handle.above[c], fraction, asks, holds.at_most[c]);
    }
  }
  holds.anchored = SlotSet(std::move(anchored));
  const auto by_slot = [](const Bound& a, const Bound& b) { return a.slot < b.slot; };
  for (auto* side : {&holds.at_least, &holds.at_most}) {
    for (std::vector<Bound>& bounds : *side) std::sort(bounds.begin(), bounds.end(), by_slot);
  }
  return holds;
}

}  // namespace

EcmSolver::EcmSolver(Body& body, Engine engine)
    : m_body(body), m_propagator(body, engine), m_fixed(std::make_unique<FixedElements>()) {}

EcmSolver::~EcmSolver() = default;

std::array<std::int32_t, 3> fixed_from_mm(const Vec3d& by_mm, const Vec3d& spacing_mm) {
  std::array<std::int32_t, 3> by_q;
  for (int c = 0; c < 3; ++c) {
    const double voxels = by_mm[c] / spacing_mm[c];
    if (!(std::abs(voxels) <= 16383)) {
      throw InputError(
          {"", std::string("displacement along axis ") + "ijk"[c], number_text(by_mm[c]) + " mm",
           "a finite length within +-16383 voxels of " + number_text(spacing_mm[c]) + " mm"});
    }
    by_q[c] = std::int32_t(std::lround(voxels * kFixedOne));
  }
  return by_q;
}

EcmReport EcmSolver::drag(const std::vector<Handle>& handles, const std::vector<Region>& anchors,
                          Progress* progress) {
  Holds none;
  return drag(handles, anchors, none, progress);
}

EcmReport EcmSolver::drag(const std::vector<Handle>& handles, const std::vector<Region>& anchors,
                          Holds& holds, Progress* progress) {
  return run(handles, anchors, holds, Extent::part, Shifts::allowed, progress);
}

EcmReport EcmSolver::drag_whole(const std::vector<Handle>& handles,
                                const std::vector<Region>& anchors, Holds& holds,
                                Progress* progress) {
  return run(handles, anchors, holds, Extent::whole, Shifts::allowed, progress);
}

EcmReport EcmSolver::drag_unless_pieces_shift(const std::vector<Handle>& handles,
                                              const std::vector<Region>& anchors, Holds& holds,
                                              bool whole, Progress* progress) {
  return run(handles, anchors, holds, whole ? Extent::whole : Extent::part, Shifts::never,
             progress);
}

EcmReport EcmSolver::drag_whole_or_unshifted(const std::vector<Handle>& handles,
                                             const std::vector<Region>& anchors, Holds& holds,
                                             Progress* progress) {
  return run(handles, anchors, holds, Extent::part, Shifts::in_whole, progress);
}

EcmReport EcmSolver::try_whole(const std::vector<Handle>& handles,
                               const std::vector<Region>& anchors, const Holds& holds,
                               Progress* progress) {
  Holds same = holds;
  return run(handles, anchors, same, Extent::tried, Shifts::allowed, progress);
}

std::vector<std::vector<ElementBounds>> EcmSolver::bounds_of(
    const std::vector<const RigidPiece*>& pieces, const std::vector<Handle>& handles,
    const std::vector<Region>& anchors, const Holds& holds, std::int32_t reach_q,
    LastingBounds& lasting, Progress* progress) {
  Holds own = holds;
  std::vector<std::vector<ElementBounds>> bounds;
  {
    const AdmissibleDrag admissible(m_body, own);
    if (lasting.reach_q < reach_q) {
      const auto end = handles.begin() + std::ptrdiff_t(lasting.handle_count);
      const std::vector<Handle> first(handles.begin(), end);
      find_lasting_bounds(m_body, hold(m_body, first, fixed(anchors), own), reach_q, lasting,
                          m_propagator, progress);
    }
    const HeldVoxels held = hold(m_body, handles, fixed(anchors), own);
    bounds = bounds_of_pieces(m_body, pieces, held, reach_q, lasting, m_propagator, progress);
  }
  if (m_body.beyond) from_admissible(m_body, bounds);
  return bounds;
}

FreePieces EcmSolver::free_pieces(const HeldVoxels& held) const {
  if (m_body.rigid.empty()) return {};
  std::vector<const SlotSet*> sets = {held.fixed, &held.rest.anchored};
  for (const HeldHandle& handle : held.handles) {
    if (!handle.is_push()) sets.push_back(&handle.slots);
  }
  return FreePieces(m_body, sets);
}

const FixedElements& EcmSolver::fixed(const std::vector<Region>& anchors) {
  if (m_fixed->regions != anchors) *m_fixed = fix(m_body, anchors);
  return *m_fixed;
}

EcmReport EcmSolver::run(const std::vector<Handle>& handles, const std::vector<Region>& anchors,
                         Holds& holds, Extent extent, Shifts shifts, Progress* progress) {
  const Stopwatch clock;
  EcmReport result;
  result.engine = engine();
  fixed(anchors);
  if (!m_body.links_known_valid) {
    const AdmissibleOffsets admissible(m_body);
    m_body.links_known_valid = check_links(m_body).violated == 0;
  }
  if (!m_body.links_known_valid && m_body.beyond) {
    keep_beyond(m_body, m_fixed->slots, holds, progress);
  }
  OffsetsGuard guard(m_body);
  if (!m_body.links_known_valid) {
    const ProjectionReport projection = project(m_body, m_fixed->slots, holds, progress);
    result.projected_links = projection.violated_links;
    result.projected_max_voxels = projection.max_move_voxels;
    result.projected_held = projection.held_moved;
  }
  const AdmissibleDrag admissible(m_body, holds);
  HeldVoxels held = hold(m_body, handles, *m_fixed, holds);
  const FreePieces pieces = free_pieces(held);
  Fraction fraction;
  const bool whole_only = extent == Extent::whole || extent == Extent::tried;
  const CoordinateDrags drags =
      solve(m_body, held, pieces, m_propagator, m_undo, whole_only, fraction, progress);
  result.fraction_numerator = fraction.numerator;
  result.fraction_denominator = fraction.denominator;
  result.shifted = shifted_pieces(pieces, drags);
  const bool may_shift =
      shifts == Shifts::allowed || (shifts == Shifts::in_whole && fraction.is_whole());
  if (!may_shift && !result.shifted.empty()) return result;
  if (extent == Extent::tried || (extent == Extent::whole && !fraction.is_whole())) return result;
  result.moved = count_moved(drags);
  Holds next = holds_after(held, fraction);
  for (const auto& coordinate : drags) {
    result.visited += coordinate->counts().visits;
    result.max_queue = std::max(result.max_queue, coordinate->counts().max_queue);
    coordinate->commit();
  }
  for (UndoLog& undo : m_undo) undo.clear(kept_undo_bricks(m_body));
  guard.dismiss();
  holds = std::move(next);
  result.milliseconds = clock.ms();
  return result;
}

std::size_t EcmSolver::bytes() const {
  std::size_t total =
      m_propagator.bytes() + m_fixed->slots.bricks().capacity() * sizeof(SlotSet::Brick);
  for (const UndoLog& undo : m_undo) total += undo.bytes();
  return total;
}

EcmReport drag(Body& body, const std::vector<Handle>& handles, const std::vector<Region>& anchors,
               Progress* progress) {
  return EcmSolver(body).drag(handles, anchors, progress);
}

EcmReport drag(Body& body, const std::vector<Handle>& handles, const std::vector<Region>& anchors,
               Holds& holds, Progress* progress) {
  return EcmSolver(body).drag(handles, anchors, holds, progress);
}

}  // namespace supple
