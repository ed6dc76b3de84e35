// Offsets of all elements of a body by its responses, for pictures: of every event of a hand.
// Cost: 3 ns per element, core and direction.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "lib/session/hand/live_responses.h"

namespace supple {

/// Offsets from rest of all elements, as Body::q.
using BodyShape = std::array<BrickValues, 3>;

/// The elements and pieces of a body, wherever they are.
class LiveShape {
 public:
  explicit LiveShape(const Body& body);

  /// Writes the offsets that a pose gives, which must have a level, to `shape`, which has
  /// the body's bricks. Those of rigid pieces follow
  /// their poses. Those of tissue may differ by one unit from what a step stores.
  void put(const LiveResponses& responses, const LivePose& pose, BodyShape& shape) const;
  /// Writes `from` + `part` (`aim` - `from`); `part` from 0 to 1.
  void put_between(const BodyShape& from, const BodyShape& aim, double part,
                   BodyShape& shape) const;

 private:
  Geometry m_geometry;
  BrickTopology m_elements;
  RigidPieces m_rigid;
  std::vector<std::size_t> m_begin;  // per brick: of its elements among all
};

}  // namespace supple
