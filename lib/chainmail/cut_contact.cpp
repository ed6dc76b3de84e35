#include "lib/chainmail/cut_contact.h"

#include <algorithm>
#include <utility>

namespace supple {

namespace {

/// Rounds until lips that change their shape as they are pushed fit each other.
constexpr int kMostRounds = 40;

/// Where a body is, and whether its links are known to be valid there.
class KeptOffsets {
 public:
  explicit KeptOffsets(const Body& body)
      : m_q(body.q), m_fraction(body.fraction), m_links_known_valid(body.links_known_valid) {}
  void restore(Body& body) const {
    body.q = m_q;
    body.fraction = m_fraction;
    body.links_known_valid = m_links_known_valid;
  }
  /// As far from `start` as so many parts of the way from there. Rounded down, which keeps every
  /// difference constraint: floor(x - W) is floor(x) - W.
  void restore_part(const KeptOffsets& start, int parts, Body& body) const {
    restore(body);
    body.links_known_valid = m_links_known_valid && start.m_links_known_valid;
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t b = 0; b < m_q[c].brick_count(); ++b) {
        if (m_q[c].brick(b) == nullptr && start.m_q[c].brick(b) == nullptr) continue;
        const std::int32_t* from = start.m_q[c].brick_or_zero(b);
        std::int32_t* now = body.q[c].touch(b);
        for (int n = 0; n < kBrickVoxels; ++n) {
          const std::int64_t way = (std::int64_t(now[n]) - from[n]) * parts;
          now[n] = std::int32_t(from[n] + (way >> kDragPartBits));
        }
        body.drop_fractions(int(c), b, m_q[c].brick_or_zero(b));
      }
    }
  }

 private:
  static constexpr int kDragPartBits = 10;
  static_assert(CutContact::kDragParts == 1 << kDragPartBits);

  std::array<BrickValues, 3> m_q;
  decltype(Body::fraction) m_fraction;
  bool m_links_known_valid;
};

/// Bounds that the body does not keep move to where it is.
void loosen(const Body& body, Holds& holds) {
  for (std::size_t c = 0; c < 3; ++c) {
    for (Bound& bound : holds.at_least[c]) {
      bound.value = std::min(bound.value, body.q[c].at(bound.slot));
    }
    for (Bound& bound : holds.at_most[c]) {
      bound.value = std::max(bound.value, body.q[c].at(bound.slot));
    }
  }
}

/// Of attempt(parts, is_first) the first, which is all of it, or that of the largest part that a
/// bisection finds to leave no overlap, as long as `may_go_on()`.
template <class Attempt, class MayGoOn>
SidesReport largest_part(Attempt&& attempt, MayGoOn&& may_go_on) {
  constexpr int kAll = CutContact::kDragParts;
  SidesReport report = attempt(kAll, true);
  if (report.left == 0 || !may_go_on()) return report;
  int done = 0, stopped = kAll, tried = kAll;
  const auto attempt_again = [&](int parts) {
    report = attempt(parts, false);
    report.parts = tried = parts;
  };
  while (stopped - done > 1 && may_go_on()) {
    attempt_again((done + stopped) / 2);
    (report.left == 0 ? done : stopped) = tried;
  }
  if (tried != done) attempt_again(done);
  return report;
}

}  // namespace

CutContact::CutContact(Body& body, std::shared_ptr<const CutLips> lips, ContactEffort effort)
    : m_body(body), m_lips(std::move(lips)), m_effort(effort) {
  if (!empty()) m_before = m_lips->points_before();
}

SidesReport CutContact::drag(const SlotSet& fixed, Holds& holds,
                             const std::function<void(int)>& move, Progress* progress) {
  const KeptOffsets start(m_body);
  const Holds before = holds;
  return largest_part(
      [&](int parts, bool is_first) {
        if (!is_first) {
          start.restore(m_body);
          holds = before;
        }
        move(parts);
        return part(fixed, holds, progress);
      },
      [&] { return may_go_on(); });
}

SidesReport CutContact::go(const SlotSet& fixed, Holds& holds, const std::function<void()>& move,
                           Progress* progress) {
  const KeptOffsets start(m_body);
  const std::vector<RigidPiece> pieces = m_body.rigid.list;
  move();
  const bool may_be_shortened = std::equal(pieces.begin(), pieces.end(), m_body.rigid.list.begin(),
                                           [&](const RigidPiece& a, const RigidPiece& b) {
                                             if (m_effort == ContactEffort::live)
                                               return a.pose == b.pose;
                                             return a.pose.turn == b.pose.turn;
                                           });
  if (!may_be_shortened) return part(fixed, holds, progress);
  const KeptOffsets end(m_body);
  const Holds at_end = holds;
  return largest_part(
      [&](int parts, bool is_first) {
        if (!is_first) {
          end.restore_part(start, parts, m_body);
          holds = at_end;
          loosen(m_body, holds);
        }
        return part(fixed, holds, progress);
      },
      [&] { return may_go_on(); });
}

bool CutContact::may_go_on(std::int64_t more_bricks) const {
  constexpr std::int64_t kMostLiveBricks = 8'000;
  return m_effort == ContactEffort::full || m_changed_bricks + more_bricks < kMostLiveBricks;
}

/// The largest move in voxels; 0 where there is no room. Sides that are pressed give way further in
/// the next round, so what is too far at once is done by halves.
double CutContact::part_across(int c, ContactProjection& projection) const {
  for (const double part : {1.0, 0.5, 0.25, 0.0625}) {
    if (!may_go_on(projection.changed_bricks())) break;
    const auto moved = projection.meet(c, m_lips->contacts(c, m_before, part).links);
    if (moved) return double(*moved) / kFixedOne;
  }
  return 0;
}

SidesReport CutContact::part(const SlotSet& fixed, const Holds& held, Progress* progress) {
  SidesReport report;
  if (empty()) return report;
  SlotSet anchored = held.anchored;
  anchored.add(fixed);
  for (const RigidPiece& piece : m_body.rigid.list) anchored.add(*piece.elements);
  ContactProjection projection(m_body, anchored, held, progress);
  for (int round = 0; round <= kMostRounds; ++round) {
    report.left = 0;
    report.left_voxels = 0;
    bool has_moved = false;
    for (int c = 0; c < 3; ++c) {
      const CutLips::Contacts contacts = m_lips->contacts(c, m_before);
      if (contacts.overlapping == 0) continue;
      report.left += contacts.overlapping;
      report.left_voxels = std::max(report.left_voxels, contacts.deepest_voxels);
      if (round == kMostRounds) continue;
      const double moved = part_across(c, projection);
      report.max_move_voxels = std::max(report.max_move_voxels, moved);
      has_moved = has_moved || moved > 0;
    }
    if (round == 0) {
      report.overlapping = report.left;
      report.deepest_voxels = report.left_voxels;
    }
    if (report.left == 0 || !has_moved) break;
  }
  m_changed_bricks += projection.changed_bricks();
  return report;
}

}  // namespace supple
