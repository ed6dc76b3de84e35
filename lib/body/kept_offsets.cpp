#include "lib/body/kept_offsets.h"

#include <algorithm>

namespace supple {

KeptOffsets::KeptOffsets(const Body& body)
    : m_q(body.q),
      m_fraction(body.fraction),
      m_links_known_valid(body.links_known_valid),
      m_beyond(body.beyond) {}

void KeptOffsets::restore(Body& body) const {
  body.q = m_q;
  body.fraction = m_fraction;
  body.links_known_valid = m_links_known_valid;
  body.beyond = m_beyond;
}

void KeptOffsets::restore_part(const KeptOffsets& start, std::int64_t parts, Body& body) const {
  restore(body);
  body.links_known_valid =
      m_links_known_valid && start.m_links_known_valid && m_beyond == start.m_beyond;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t b = 0; b < m_q[c].brick_count(); ++b) {
      if (m_q[c].brick(b) == nullptr && start.m_q[c].brick(b) == nullptr) continue;
      const std::int32_t* from = start.m_q[c].brick_or_zero(b);
      std::int32_t* now = body.q[c].touch(b);
      for (int n = 0; n < kBrickVoxels; ++n) {
        const std::int64_t way = (std::int64_t(now[n]) - from[n]) * parts;
        now[n] = std::int32_t(from[n] + (way >> kWayPartBits));
      }
      body.drop_fractions(int(c), b, m_q[c].brick_or_zero(b));
    }
  }
}

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

}  // namespace supple
