#include "volumes/grid/brick_values.h"

#include <algorithm>

namespace supple {

namespace {

constexpr std::size_t kMaxChunk = 64;

}  // namespace

template <class T>
BrickArray<T>::BrickArray(const BrickArray& other) : BrickArray(other.brick_count()) {
  reserve(other.stored_bricks());
  for (std::size_t b = 0; b < other.brick_count(); ++b) {
    if (other.m_table[b] != nullptr) std::copy_n(other.m_table[b], kBrickVoxels, touch(b));
  }
}

template <class T>
BrickArray<T> BrickArray<T>::of(const std::vector<T>& values) {
  BrickArray array(values.size() / kBrickVoxels);
  for (std::size_t b = 0; b < array.brick_count(); ++b) {
    const T* const brick = &values[b * kBrickVoxels];
    if (!are_zeros(brick)) std::copy_n(brick, kBrickVoxels, array.touch(b));
  }
  return array;
}

template <class T>
std::vector<T> BrickArray<T>::all() const {
  std::vector<T> values;
  values.reserve(brick_count() * kBrickVoxels);
  for (std::size_t b = 0; b < brick_count(); ++b) {
    const T* const brick = brick_or_zero(b);
    values.insert(values.end(), brick, brick + kBrickVoxels);
  }
  return values;
}

template <class T>
void BrickArray<T>::swap(BrickArray& other) noexcept {
  m_table.swap(other.m_table);
  m_chunks.swap(other.m_chunks);
  m_free.swap(other.m_free);
  std::swap(m_stored, other.m_stored);
  std::swap(m_chunk_bricks, other.m_chunk_bricks);
}

template <class T>
T* BrickArray<T>::store(std::size_t b) {
  // A chunk never has more bricks than are left to store.
  if (m_free.empty()) add_chunk(std::min(kMaxChunk, m_table.size() - m_stored));
  T* const values = m_free.back();
  m_free.pop_back();
  std::fill_n(values, kBrickVoxels, T(0));
  m_table[b] = values;
  ++m_stored;
  return values;
}

/// Adds a chunk of bricks, which are handed out in ascending order.
template <class T>
void BrickArray<T>::add_chunk(std::size_t count) {
  // The free list has room for all bricks, so that release() never allocates.
  const std::size_t wanted = m_chunk_bricks + count;
  if (m_free.capacity() < wanted) m_free.reserve(std::max(wanted, 2 * m_free.capacity()));
  m_chunks.push_back(std::unique_ptr<Brick[]>(new Brick[count]));
  m_chunk_bricks += count;
  for (std::size_t n = count; n > 0; --n) m_free.push_back(m_chunks.back()[n - 1].values);
}

template <class T>
void BrickArray<T>::release(std::size_t b) {
  if (brick(b) == nullptr) return;
  m_free.push_back(m_table[b]);
  m_table[b] = nullptr;
  --m_stored;
}

template <class T>
void BrickArray<T>::reserve(std::size_t more) {
  if (more > m_free.size()) add_chunk(more - m_free.size());
}

template <class T>
void BrickArray<T>::touch_all() {
  reserve(brick_count() - m_stored);
  for (std::size_t b = 0; b < brick_count(); ++b) touch(b);
}

template <class T>
void BrickArray<T>::keep_only(const std::vector<std::size_t>& kept) {
  std::vector<T*> table;
  table.reserve(kept.size());
  std::size_t next = 0;  // of the bricks that were not looked at
  for (const std::size_t b : kept) {
    for (; next < b; ++next) release(next);
    table.push_back(m_table[next++]);
  }
  for (; next < m_table.size(); ++next) release(next);
  m_table = std::move(table);
}

template <class T>
void BrickArray<T>::place_at(const std::vector<std::size_t>& places, std::size_t brick_count) {
  std::vector<T*> table(brick_count, nullptr);
  for (std::size_t n = 0; n < places.size(); ++n) table[places[n]] = m_table[n];
  m_table = std::move(table);
}

template <class T>
void BrickArray<T>::resize(std::size_t brick_count) {
  for (std::size_t b = brick_count; b < m_table.size(); ++b) release(b);
  m_table.resize(brick_count, nullptr);
}

template <class T>
std::size_t BrickArray<T>::bytes() const {
  return m_chunk_bricks * sizeof(Brick) + m_chunks.capacity() * sizeof(m_chunks[0]) +
         (m_table.capacity() + m_free.capacity()) * sizeof(T*);
}

template <class T>
bool BrickArray<T>::operator==(const BrickArray& other) const {
  const std::size_t count = std::max(brick_count(), other.brick_count());
  for (std::size_t b = 0; b < count; ++b) {
    if (brick(b) == other.brick(b)) continue;
    const T* const values = brick_or_zero(b);
    if (!std::equal(values, values + kBrickVoxels, other.brick_or_zero(b))) return false;
  }
  return true;
}

template class BrickArray<std::int16_t>;
template class BrickArray<std::int32_t>;
template class BrickArray<double>;
template class BrickArray<Vec3f>;

}  // namespace supple
