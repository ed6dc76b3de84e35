// Monotone priority queue over plain arrays: values come out in buckets of 2^shift units, in the
// order of their distance from `start`. Inside a bucket the order is first in, first out, so the
// user must correct labels there; the label-correcting result is exact whatever the width.
//
// Cost: O(1) per push and pop plus one step per bucket passed. The buckets form a sliding window;
// entries beyond it wait in one array that is redistributed when the window reaches them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "lib/body/slot_set.h"

namespace supple {

struct QueueEntry {
  Slot slot;
  std::int32_t value;
};

class BucketQueue {
 public:
  /// A power of two of buckets, which exist from the first reset on.
  explicit BucketQueue(std::size_t buckets) : m_mask(buckets - 1) {}

  /// Empties the queue. `downward`: later values are smaller than `start`, otherwise larger.
  void reset(std::int32_t start, bool downward, int shift) {
    m_buckets.resize(m_mask + 1);
    bucket(m_current).clear();
    if (m_in_window > 0) {
      for (Bucket& entries : m_buckets) entries.clear();
    }
    m_far.clear();
    m_start = std::uint32_t(start);
    m_downward = downward;
    m_shift = shift;
    m_current = m_next = m_in_window = m_max_size = 0;
    m_far_first = kNever;
  }

  /// Adds an entry; `value` must not precede the bucket of the last popped one.
  void push(Slot slot, std::int32_t value) {
    const std::uint64_t number = bucket_number(value);
    if (number <= m_current + m_mask) {
      bucket(number).push_back({slot, value});
      ++m_in_window;
    } else {
      m_far.push_back({slot, value});
      m_far_first = std::min(m_far_first, number);
    }
    m_max_size = std::max(m_max_size, m_in_window + m_far.size());
  }

  /// Takes the next entry out; false when the queue is empty.
  bool pop(QueueEntry& entry) {
    while (true) {
      auto& current = bucket(m_current);
      if (m_next < current.size()) {
        entry = current[m_next++];
        --m_in_window;
        return true;
      }
      current.clear();
      m_next = 0;
      if (m_in_window == 0 && m_far.empty()) return false;
      m_current = m_in_window == 0 ? m_far_first : m_current + 1;
      if (m_current >= m_far_first) fetch_far();
    }
  }

  /// Takes all entries of the first bucket that has some; false when the queue is empty.
  bool take_bucket(std::vector<QueueEntry>& entries) {
    entries.clear();
    QueueEntry first;
    if (!pop(first)) return false;
    auto& current = bucket(m_current);
    m_in_window -= current.size() - m_next;
    entries.swap(current);
    m_next = 0;
    return true;
  }

  std::size_t max_size() const { return m_max_size; }

  std::size_t bytes() const {
    std::size_t entries = m_far.capacity();
    for (const Bucket& each : m_buckets) entries += each.capacity();
    return m_buckets.capacity() * sizeof(Bucket) + entries * sizeof(QueueEntry);
  }

 private:
  using Bucket = std::vector<QueueEntry>;
  static constexpr std::uint64_t kNever = UINT64_MAX;

  Bucket& bucket(std::uint64_t number) { return m_buckets[number & m_mask]; }

  std::uint64_t bucket_number(std::int32_t value) const {
    const std::uint32_t depth =
        m_downward ? m_start - std::uint32_t(value) : std::uint32_t(value) - m_start;
    return depth >> m_shift;
  }

  /// Moves entries that now lie inside the window from the far array to their buckets.
  void fetch_far() {
    std::vector<QueueEntry> waiting;
    waiting.swap(m_far);
    m_far_first = kNever;
    for (const QueueEntry& entry : waiting) push(entry.slot, entry.value);
  }

  std::uint64_t m_mask;  // one less than there are buckets
  std::vector<Bucket> m_buckets;
  std::vector<QueueEntry> m_far;
  std::uint64_t m_far_first = kNever;
  std::uint32_t m_start = 0;
  bool m_downward = true;
  int m_shift = 0;
  std::uint64_t m_current = 0;  // bucket being emptied
  std::size_t m_next = 0;       // next entry in it
  std::size_t m_in_window = 0;  // entries not yet popped
  std::size_t m_max_size = 0;
};

}  // namespace supple
