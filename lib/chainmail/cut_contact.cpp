#include "lib/chainmail/cut_contact.h"

#include <algorithm>
#include <utility>

#include "lib/body/kept_offsets.h"

namespace supple {

namespace {

/// Rounds until lips that change their shape as they are pushed fit each other.
constexpr int kMostRounds = 40;

/// Reports attempt(parts, is_first): the first, which is all of it, or that of the largest part
/// that a bisection finds to leave no more overlap than there was, as long as `may_go_on()`.
template <class Attempt, class MayGoOn>
SidesReport largest_part(Attempt&& attempt, MayGoOn&& may_go_on) {
  constexpr int kAll = CutContact::kDragParts;
  SidesReport report = attempt(kAll, true);
  if (report.deepened == 0 || !may_go_on()) return report;
  int done = 0, stopped = kAll, tried = kAll;
  const auto attempt_again = [&](int parts) {
    report = attempt(parts, false);
    report.parts = tried = parts;
  };
  while (stopped - done > 1 && may_go_on()) {
    attempt_again((done + stopped) / 2);
    (report.deepened == 0 ? done : stopped) = tried;
  }
  if (tried != done) attempt_again(done);
  return report;
}

}  // namespace

CutContact::CutContact(Body& body, std::shared_ptr<CutLips> lips, ContactEffort effort,
                       std::shared_ptr<const LipsBefore> before)
    : m_body(body), m_lips(std::move(lips)), m_before(std::move(before)), m_effort(effort) {
  if (!empty() && !m_before) {
    m_before = std::make_shared<const LipsBefore>(m_lips->points_before());
  }
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
  const bool stays =
      std::equal(pieces.begin(), pieces.end(), m_body.rigid.list.begin(),
                 [&](const RigidPiece& a, const RigidPiece& b) { return a.pose == b.pose; });
  if (!stays) {
    SidesReport report = part(fixed, holds, progress);
    report.is_crushed = report.left > 0;
    return report;
  }
  const KeptOffsets end(m_body);
  const Holds at_end = holds;
  return largest_part(
      [&](int parts, bool is_first) {
        if (!is_first) {
          end.restore_part(start, parts * (kWayParts / kDragParts), m_body);
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

/// Parts lips across an axis; returns the largest move in voxels, 0 where there is no room. Sides
/// that are pressed give way further in the next round, so a way too far at once is done by halves.
double CutContact::part_across(int c, ContactProjection& projection) const {
  for (const double part : {1.0, 0.5, 0.25, 0.0625}) {
    if (!may_go_on(projection.changed_bricks())) break;
    const auto moved = projection.meet(c, m_lips->contacts(c, *m_before, part).links);
    if (moved) return double(*moved) / kFixedOne;
  }
  return 0;
}

/// Adds the overlap across an axis to the report.
void CutContact::count(int c, const CutLips::Contacts& contacts, SidesReport& report) const {
  report.overlapping += contacts.overlapping;
  report.left += contacts.too_deep;
  report.deepened += contacts.deepened;
  if (contacts.overlapping == 0 || contacts.deepest_voxels <= report.deepest_voxels) return;
  report.deepest_voxels = contacts.deepest_voxels;
  const BrickValues& q = m_body.q[std::size_t(c)];
  const auto way = [&](const ContactLink& link) {
    return link.least + q.at(link.below) - q.at(link.above);
  };
  const auto deepest =
      std::max_element(contacts.links.begin(), contacts.links.end(),
                       [&](const ContactLink& a, const ContactLink& b) { return way(a) < way(b); });
  report.voxel = voxel_of(m_body.elements, deepest->below);
}

SidesReport CutContact::found() const {
  SidesReport report;
  for (int c = 0; c < 3 && !empty(); ++c) count(c, m_lips->contacts(c, *m_before), report);
  report.left_voxels = report.left > 0 ? report.deepest_voxels : 0;
  return report;
}

SidesReport CutContact::part(const SlotSet& fixed, const Holds& held, Progress* progress) {
  SidesReport report;
  if (empty()) return report;
  SlotSet anchored = held.anchored;
  anchored.add(fixed);
  for (const RigidPiece& piece : m_body.rigid.list) anchored.add(*piece.elements);
  ContactProjection projection(m_body, anchored, held, progress);
  for (int round = 0; round <= kMostRounds; ++round) {
    SidesReport now;
    bool has_moved = false;
    for (int c = 0; c < 3; ++c) {
      const CutLips::Contacts contacts = m_lips->contacts(c, *m_before);
      if (contacts.overlapping == 0) continue;
      count(c, contacts, now);
      if (round == kMostRounds) continue;
      const double moved = part_across(c, projection);
      report.max_move_voxels = std::max(report.max_move_voxels, moved);
      has_moved = has_moved || moved > 0;
    }
    if (round == 0) {
      report.overlapping = now.overlapping;
      report.deepest_voxels = now.deepest_voxels;
      report.voxel = now.voxel;
    }
    report.left = now.left;
    report.deepened = now.deepened;
    report.left_voxels = now.left > 0 ? now.deepest_voxels : 0;
    if (now.left > 0) report.voxel = now.voxel;
    if (now.overlapping == 0 || !has_moved) break;
  }
  m_changed_bricks += projection.changed_bricks();
  return report;
}

}  // namespace supple
