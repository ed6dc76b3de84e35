#include <algorithm>
#include <limits>

#include "lib/state/pose.h"
#include "lib/state/state.h"
#include "volumes/base/parallel.h"
#include "volumes/field/ring_fill.h"

namespace supple {

namespace {

bool is_stored(const std::array<BrickValues, 3>& q, std::size_t b) {
  return q[0].brick(b) != nullptr || q[1].brick(b) != nullptr || q[2].brick(b) != nullptr;
}

}  // namespace

LiveDisplacement::LiveDisplacement(const Geometry& geometry, const BrickTopology& elements,
                                   const BrickTopology& shell)
    : m_elements(elements), m_is_moved(elements.brick_count(), 0) {
  const VectorBricks rest{elements, BrickVectors(elements.brick_count())};
  std::vector<std::uint8_t> ring_of;
  m_extended = {geometry, fill_rings(rest, shell, std::numeric_limits<int>::max(), RingFill::linear,
                                     &ring_of)};
  m_order = std::make_unique<RingOrder>(m_extended.u.topology, ring_of);
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    m_brick_of.push_back(m_extended.u.topology.find(elements.origin(b)));
  }
}

LiveDisplacement::~LiveDisplacement() = default;

/// Writes the elements of one brick; true when any of them changed.
bool LiveDisplacement::take_over(const std::array<BrickValues, 3>& q, std::size_t b) {
  const bool moves = is_stored(q, b);
  if (!moves && !m_is_moved[b]) return false;
  m_is_moved[b] = moves;
  const std::int32_t* values[3];
  for (int c = 0; c < 3; ++c) values[c] = q[c].brick_or_zero(b);
  Vec3f* u = m_extended.u.vectors.touch(std::size_t(m_brick_of[b]));
  bool is_changed = false;
  for_each_active(m_elements.mask(b), [&](int offset) {
    const Vec3f now(float(values[0][offset] / kFixedOne), float(values[1][offset] / kFixedOne),
                    float(values[2][offset] / kFixedOne));
    is_changed = is_changed || now != u[offset];
    u[offset] = now;
  });
  return is_changed;
}

std::vector<std::int32_t> LiveDisplacement::update(const std::array<BrickValues, 3>& q) {
  for (std::size_t b = 0; b < m_elements.brick_count(); ++b) {
    if (is_stored(q, b)) m_extended.u.vectors.touch(std::size_t(m_brick_of[b]));
  }
  std::vector<std::uint8_t> is_changed(m_elements.brick_count());
  parallel_for(is_changed.size(), [&](std::size_t b) { is_changed[b] = take_over(q, b); });
  std::vector<std::int32_t> changed;
  for (std::size_t b = 0; b < is_changed.size(); ++b) {
    if (is_changed[b]) changed.push_back(m_brick_of[b]);
  }
  return refill_rings(m_extended.u, *m_order, changed);
}

}  // namespace supple
