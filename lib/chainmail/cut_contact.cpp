#include "lib/chainmail/cut_contact.h"

#include <algorithm>

#include "lib/chainmail/projection.h"

namespace supple {

namespace {

/// Rounds until lips that change their shape as they are pushed fit each other.
constexpr int kMostRounds = 40;

}  // namespace

CutContact::CutContact(Body& body, const LinkCuts& cuts) : m_body(body), m_lips(body, cuts) {
  if (!m_lips.empty()) m_before = m_lips.points_before();
}

SidesReport CutContact::drag(const SlotSet& fixed, Holds& holds,
                             const std::function<void(int)>& move, Progress* progress) {
  const std::array<BrickValues, 3> q = m_body.q;
  const auto fraction = m_body.fraction;
  const Holds before = holds;
  int tried = -1;
  const auto attempt = [&](int parts) {
    if (tried >= 0) {
      m_body.q = q;
      m_body.fraction = fraction;
      holds = before;
    }
    tried = parts;
    move(parts);
    SidesReport report = part(fixed, holds, progress);
    report.parts = parts;
    return report;
  };
  SidesReport report = attempt(kDragParts);
  if (report.left == 0) return report;
  int done = 0, stopped = kDragParts;
  while (stopped - done > 1) {
    const int parts = (done + stopped) / 2;
    report = attempt(parts);
    (report.left == 0 ? done : stopped) = parts;
  }
  return tried == done ? report : attempt(done);
}

/// The largest move in voxels; 0 where there is no room. Sides that are pressed give way further in
/// the next round, so what is too far at once is done by halves.
double CutContact::part_across(int c, const SlotSet& anchored, const Holds& held,
                               Propagator& propagator, const FreePieces& pieces,
                               Progress* progress) {
  BrickValues& q = m_body.q[std::size_t(c)];
  q.resize(m_body.elements.brick_count());
  const HeldBounds bounds = held_bounds(m_body, c, anchored, held);
  for (const double part : {1.0, 0.5, 0.25, 0.0625}) {
    std::optional<BrickValues> apart = projected(
        q, c, bounds, m_lips.contacts(c, m_before, part).links, propagator, progress, pieces);
    if (!apart) continue;
    const double moved = double(largest_move(q, *apart)) / kFixedOne;
    q.swap(*apart);
    for (std::size_t b = 0; b < m_body.fraction[std::size_t(c)].brick_count(); ++b) {
      m_body.drop_fractions(c, b, apart->brick_or_zero(b));
    }
    return moved;
  }
  return 0;
}

SidesReport CutContact::part(const SlotSet& fixed, const Holds& held, Progress* progress) {
  SidesReport report;
  if (m_lips.empty()) return report;
  SlotSet anchored = held.anchored;
  anchored.add(fixed);
  Propagator propagator(m_body);
  const FreePieces pieces = m_body.rigid.empty() ? FreePieces() : FreePieces(m_body, {});
  for (int round = 0; round <= kMostRounds; ++round) {
    report.left = 0;
    report.left_voxels = 0;
    bool has_moved = false;
    for (int c = 0; c < 3; ++c) {
      const CutLips::Contacts contacts = m_lips.contacts(c, m_before);
      if (contacts.overlapping == 0) continue;
      report.left += contacts.overlapping;
      report.left_voxels = std::max(report.left_voxels, contacts.deepest_voxels);
      if (round == kMostRounds) continue;
      const double moved = part_across(c, anchored, held, propagator, pieces, progress);
      report.max_move_voxels = std::max(report.max_move_voxels, moved);
      has_moved = has_moved || moved > 0;
    }
    if (round == 0) {
      report.overlapping = report.left;
      report.deepest_voxels = report.left_voxels;
    }
    if (report.left == 0 || !has_moved) break;
  }
  return report;
}

}  // namespace supple
