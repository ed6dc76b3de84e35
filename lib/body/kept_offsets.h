// Copy of the offsets of a body, to which it goes back wholly or in part.
#pragma once

#include <array>

#include "lib/body/body.h"
#include "lib/body/slot_set.h"

namespace supple {

/// Parts of a way: 1/kWayParts of it each.
constexpr int kWayPartBits = 20;
constexpr std::int64_t kWayParts = std::int64_t(1) << kWayPartBits;

/// Offsets of a body, and whether its links are known to be valid there.
class KeptOffsets {
 public:
  explicit KeptOffsets(const Body& body);
  void restore(Body& body) const;
  /// Puts the body `parts` of the way from `start` on. Offsets are rounded down, which keeps every
  /// difference constraint: floor(x - W) is floor(x) - W.
  void restore_part(const KeptOffsets& start, std::int64_t parts, Body& body) const;

 private:
  std::array<BrickValues, 3> m_q;
  decltype(Body::fraction) m_fraction;
  bool m_links_known_valid;
  BeyondLimits m_beyond;
};

/// Moves bounds that the body does not keep to where it is.
void loosen(const Body& body, Holds& holds);

}  // namespace supple
