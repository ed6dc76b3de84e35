// Keeps the sides of cuts from passing through each other: contact without friction.
//
// ECM, relaxation and whatever else moves a body know nothing of contacts. Afterwards lips that
// overlap are taken apart: across each axis in turn, the contacts of the present state
// (cut_lips.h) are difference constraints beside those of the links, and the projection of
// project.cpp meets both with the smallest possible largest move, exactly and whatever the order.
// Both lips yield alike, unless one is held. Lips change their shape as they are pushed, so the
// rounds go on until no point of a lip is behind the other one. A body without cuts costs nothing,
// one whose lips do not meet what lip_facings.h tells; lips that meet cost what they push.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "lib/body/slot_set.h"
#include "lib/chainmail/projection.h"
#include "lib/contact/collider_contact.h"
#include "lib/contact/cut_lips.h"
#include "volumes/base/progress.h"

namespace supple {

/// live: at most about an eighth of a second, after which sides that overlap are left.
enum class ContactEffort { full, live };

class CutContact {
 public:
  /// Remembers which parts of lips lie before each other: make it before the body moves, or give
  /// what another one remembered. `lips`: of the body and its cuts without the links that rigid
  /// pieces hide. The body outlives this.
  CutContact(Body& body, std::shared_ptr<CutLips> lips, ContactEffort effort = ContactEffort::full,
             std::shared_ptr<const LipsBefore> before = nullptr);
  const std::shared_ptr<const LipsBefore>& before() const { return m_before; }

  static constexpr int kDragParts = kContactParts;

  bool empty() const { return m_lips->empty(); }

  /// Calls move(n), which drags by n / kDragParts of the whole, and takes lips apart: for the whole
  /// drag, or for the largest n that a bisection finds to leave room for both lips: none lies
  /// deeper in the other one than before. `fixed` and what `holds` holds after the move stay.
  /// Throws what move() throws.
  SidesReport drag(const SlotSet& fixed, Holds& holds, const std::function<void(int)>& move,
                   Progress* progress = nullptr);

  /// The same for a move that is made once: it goes the straight way to its end by the whole, or by
  /// the largest n / kDragParts that leaves room. Places on that way keep all limits, too, since
  /// these are convex. Tissue does not stop rigid pieces: where any has moved it is the whole, and
  /// tissue between them is crushed. Bounds that `holds` has after the move are those of the way's
  /// end, and end where the way does.
  SidesReport go(const SlotSet& fixed, Holds& holds, const std::function<void()>& move,
                 Progress* progress = nullptr);

  /// Takes overlapping lips apart. Fixed and held elements and rigid pieces stay, and all links
  /// keep their limits. Where these leave no room some overlap is `left`.
  SidesReport part(const SlotSet& fixed, const Holds& held, Progress* progress = nullptr);

  /// Reports the present overlap, all of it `left`.
  SidesReport found() const;

 private:
  bool may_go_on(std::int64_t more_bricks = 0) const;
  double part_across(int c, ContactProjection& projection) const;
  void count(int c, const CutLips::Contacts& contacts, SidesReport& report) const;

  Body& m_body;
  std::shared_ptr<CutLips> m_lips;
  std::shared_ptr<const LipsBefore> m_before;
  ContactEffort m_effort;
  std::int64_t m_changed_bricks = 0;
};

}  // namespace supple
