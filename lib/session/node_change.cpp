#include "lib/session/node_change.h"

#include <algorithm>
#include <cstring>

namespace supple {

template <class T>
BrickChange<T>::BrickChange(const BrickArray<T>& before, const BrickArray<T>& after)
    : m_brick_count(before.brick_count()) {
  const std::size_t count = std::max(before.brick_count(), after.brick_count());
  std::size_t stored = 0;
  for (std::size_t b = 0; b < count; ++b) {
    const T* was = before.brick(b);
    const T* is = after.brick(b);
    if (was == nullptr && is == nullptr) continue;
    const bool is_kept =
        was != nullptr && is != nullptr && std::memcmp(was, is, sizeof(T) * kBrickVoxels) == 0;
    if (is_kept) continue;
    m_bricks.push_back(std::uint32_t(b));
    m_is_stored.push_back(was != nullptr);
    stored += was != nullptr ? 1 : 0;
  }
  m_values.reserve(stored * kBrickVoxels);
  for (const std::uint32_t b : m_bricks) {
    const T* was = before.brick(b);
    if (was != nullptr) m_values.insert(m_values.end(), was, was + kBrickVoxels);
  }
}

template <class T>
void BrickChange<T>::take_back(BrickArray<T>& values) const {
  values.resize(m_brick_count);
  const T* was = m_values.data();
  for (std::size_t n = 0; n < m_bricks.size(); ++n) {
    if (m_is_stored[n]) {
      std::copy_n(was, kBrickVoxels, values.touch(m_bricks[n]));
      was += kBrickVoxels;
    } else {
      values.release(m_bricks[n]);
    }
  }
}

template class BrickChange<std::int16_t>;
template class BrickChange<std::int32_t>;
template class BrickChange<double>;

NodeChange::NodeChange(const StepNodes& before, const Body& after) {
  for (int a = 0; a < 3; ++a) {
    m_integers.emplace_back(before.q[a], after.q[a]);
    m_fractions.emplace_back(before.fraction[a], after.fraction[a]);
    m_velocities.emplace_back(before.velocity_mm_s[a], after.velocity_mm_s[a]);
  }
  for (int a = 0; a < 3; ++a) {
    for (int c = 0; c < 3; ++c) m_integers.emplace_back(before.rest[a][c], after.rest[a][c]);
  }
}

void NodeChange::take_back(Body& body) const {
  for (int a = 0; a < 3; ++a) {
    m_integers[std::size_t(a)].take_back(body.q[a]);
    m_fractions[std::size_t(a)].take_back(body.fraction[a]);
    m_velocities[std::size_t(a)].take_back(body.velocity_mm_s[a]);
    for (int c = 0; c < 3; ++c) {
      m_integers[3 + 3 * std::size_t(a) + std::size_t(c)].take_back(body.rest[a][c]);
    }
  }
}

std::size_t NodeChange::bytes() const {
  std::size_t sum = 0;
  for (const auto& change : m_integers) sum += change.bytes();
  for (const auto& change : m_fractions) sum += change.bytes();
  for (const auto& change : m_velocities) sum += change.bytes();
  return sum;
}

}  // namespace supple
