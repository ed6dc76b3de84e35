#include "lib/body/node_change.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <utility>

#include "volumes/base/parallel.h"

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

template <class T>
void BrickChange<T>::take_over(const BrickArray<T>& now, BrickArray<T>& values) const {
  values.resize(std::max(values.brick_count(), now.brick_count()));
  for (const std::uint32_t b : m_bricks) {
    if (now.brick(b) != nullptr) {
      std::copy_n(now.brick(b), kBrickVoxels, values.touch(b));
    } else {
      values.release(b);
    }
  }
}

template class BrickChange<std::int16_t>;
template class BrickChange<std::int32_t>;
template class BrickChange<double>;

namespace {

template <class T>
using BeforeAfter = std::pair<const BrickArray<T>*, const BrickArray<T>*>;

template <class T>
std::vector<BrickChange<T>> changes_of(const std::vector<BeforeAfter<T>>& arrays) {
  std::vector<std::optional<BrickChange<T>>> found(arrays.size());
  parallel_for(arrays.size(),
               [&](std::size_t n) { found[n].emplace(*arrays[n].first, *arrays[n].second); });
  std::vector<BrickChange<T>> changes;
  for (auto& change : found) changes.push_back(std::move(*change));
  return changes;
}

}  // namespace

NodeChange::NodeChange(const StepNodes& before, const Body& after) {
  std::vector<BeforeAfter<std::int32_t>> integers;
  std::vector<BeforeAfter<std::int16_t>> fractions;
  std::vector<BeforeAfter<double>> velocities;
  for (std::size_t a = 0; a < 3; ++a) {
    integers.emplace_back(&before.q[a], &after.q[a]);
    fractions.emplace_back(&before.fraction[a], &after.fraction[a]);
    velocities.emplace_back(&before.velocity_mm_s[a], &after.velocity_mm_s[a]);
  }
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t c = 0; c < 3; ++c) {
      integers.emplace_back(&before.rest[a][c], &after.rest[a][c]);
    }
  }
  m_integers = changes_of(integers);
  m_fractions = changes_of(fractions);
  m_velocities = changes_of(velocities);
}

void StepNodes::follow(const Body& body, const NodeChange& change) {
  parallel_for(std::size_t(3), [&](std::size_t a) {
    change.m_integers[a].take_over(body.q[a], q[a]);
    change.m_fractions[a].take_over(body.fraction[a], fraction[a]);
    change.m_velocities[a].take_over(body.velocity_mm_s[a], velocity_mm_s[a]);
    for (std::size_t c = 0; c < 3; ++c) {
      change.m_integers[3 + 3 * a + c].take_over(body.rest[a][c], rest[a][c]);
    }
  });
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
