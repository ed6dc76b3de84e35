#include "lib/body/beyond_limits.h"

#include "volumes/base/parallel.h"

namespace supple {

AdmissibleOffsets::AdmissibleOffsets(Body& body) : m_body(body), m_first(0), m_end(3) {
  add(-1);
}

AdmissibleOffsets::AdmissibleOffsets(Body& body, int coordinate)
    : m_body(body), m_first(coordinate), m_end(coordinate + 1) {
  add(-1);
}

AdmissibleOffsets::~AdmissibleOffsets() {
  add(1);
}

void AdmissibleOffsets::add(int sign) {
  if (!m_body.beyond) return;
  for (int c = m_first; c < m_end; ++c) {
    const BrickValues& beyond = (*m_body.beyond)[std::size_t(c)];
    BrickValues& q = m_body.q[std::size_t(c)];
    std::vector<std::size_t> bricks;
    for (std::size_t b = 0; b < beyond.brick_count(); ++b) {
      if (beyond.brick(b) == nullptr) continue;
      q.touch(b);  // stored before threads write it
      bricks.push_back(b);
    }
    parallel_for(bricks.size(), [&](std::size_t n) {
      const std::int32_t* const from = beyond.brick(bricks[n]);
      std::int32_t* const to = q.touch(bricks[n]);
      for (int offset = 0; offset < kBrickVoxels; ++offset) to[offset] += sign * from[offset];
    });
  }
}

namespace {

void shift(const Body& body, int sign, Holds& holds) {
  if (!body.beyond) return;
  for (int c = 0; c < 3; ++c) {
    for (auto* bounds : {&holds.at_least[std::size_t(c)], &holds.at_most[std::size_t(c)]}) {
      for (Bound& bound : *bounds) bound.value += sign * beyond_at(body, c, bound.slot);
    }
  }
}

}  // namespace

void to_admissible(const Body& body, Holds& holds) {
  shift(body, -1, holds);
}
void from_admissible(const Body& body, Holds& holds) {
  shift(body, 1, holds);
}

}  // namespace supple
