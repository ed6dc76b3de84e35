// One-sided asks of Enhanced ChainMail that may contradict each other: elements are to lie at least
// or at most at some offset, as far as links and anchors allow.
//
// Per coordinate the asks from below raise the offsets to their least envelope, and those from
// above lower them to their greatest one (lib/chainmail/propagate.h). Where both are asked for, the
// two orders give two valid configurations; links are difference constraints, so that floor of
// their mean is valid too. It fulfils all asks where they agree, and shares what is missing where
// they do not. Anchors stay: asks go no further than the envelopes of the anchors, which are found
// once. Cost: up to four propagations per coordinate, each as far as elements move.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "lib/body/body.h"
#include "lib/body/slot_set.h"
#include "lib/chainmail/propagate.h"

namespace supple {

/// Seeds per coordinate: offsets that elements are to have at least and at most.
struct OneSidedAsks {
  std::array<std::vector<Seed>, 3> at_least, at_most;
};

class OneSidedPush {
 public:
  /// Refers to the body, whose links hold and whose elements must not change. Links may be cut: the
  /// anchors then bound what they held before as they did, until it is set adrift.
  OneSidedPush(Body& body, const SlotSet& anchors);

  /// Moves the body; asks that anchors do not allow are shortened. Returns the bricks in which
  /// offsets may have changed, ascending.
  std::vector<std::size_t> push(OneSidedAsks asks);

  /// Takes bounds from all elements of pieces that have lost their anchors.
  void set_adrift(const SlotSet& elements);

  /// Bricks in which offsets have changed since clear_changes(), ascending, and their elements.
  std::vector<SlotSet::Brick> changes() const;
  void clear_changes();

 private:
  struct Coordinate {
    std::unique_ptr<Propagator> propagator;
    UndoLog undo;
    BrickValues least, most;           // that anchors allow
    std::vector<BrickMask> changed;    // per brick
    std::vector<std::int32_t> first;   // result of the first order, 512 per brick of `touched`
    std::vector<std::size_t> touched;  // by the first order, later by the whole push
  };

  void push_along(std::size_t c, std::vector<Seed>& at_least, std::vector<Seed>& at_most);
  void take_mean(Coordinate& own, BrickValues& values);
  void note_changes(std::size_t c);

  Body& m_body;
  std::array<Coordinate, 3> m_coordinates;
};

}  // namespace supple
