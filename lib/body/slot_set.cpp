#include "lib/body/slot_set.h"

#include <algorithm>

namespace supple {

namespace {

bool is_empty(const BrickMask& mask) {
  return std::all_of(mask.begin(), mask.end(), [](std::uint64_t word) { return word == 0; });
}

BrickMask both(const BrickMask& a, const BrickMask& b) {
  BrickMask mask;
  for (std::size_t word = 0; word < mask.size(); ++word) mask[word] = a[word] & b[word];
  return mask;
}

/// Part of a brick inside `box`, in voxels of the whole; word i of a mask holds bits (j << 3 | k).
BrickMask mask_of_box(const Vec3i& origin, const IndexBox& box) {
  const Vec3i lo = box.lo - origin, hi = box.hi - origin;
  const auto within = [](int local, int first, int last) {
    return local >= first && local <= last;
  };
  std::uint64_t row = 0, plane = 0;
  for (int k = 0; k < kBrickDim; ++k) row |= std::uint64_t(within(k, lo.z, hi.z)) << k;
  for (int j = 0; j < kBrickDim; ++j) {
    if (within(j, lo.y, hi.y)) plane |= row << (8 * j);
  }
  BrickMask mask{};
  for (int i = 0; i < kBrickDim; ++i) mask[std::size_t(i)] = within(i, lo.x, hi.x) ? plane : 0;
  return mask;
}

}  // namespace

SlotSet::SlotSet(std::vector<Brick> bricks) : m_bricks(std::move(bricks)) {
  std::stable_sort(m_bricks.begin(), m_bricks.end(),
                   [](const Brick& a, const Brick& b) { return a.brick < b.brick; });
  std::size_t kept = 0;
  for (std::size_t n = 0; n < m_bricks.size(); ++n) {
    const Brick entry = m_bricks[n];
    if (is_empty(entry.mask)) continue;
    if (kept == 0 || m_bricks[kept - 1].brick != entry.brick) {
      m_bricks[kept++] = entry;
      continue;
    }
    for (std::size_t word = 0; word < entry.mask.size(); ++word) {
      m_bricks[kept - 1].mask[word] |= entry.mask[word];
    }
  }
  m_bricks.resize(kept);
}

SlotSet::SlotSet(std::vector<Slot> slots) {
  std::sort(slots.begin(), slots.end());
  for (const Slot slot : slots) {
    const std::uint32_t brick = slot / kBrickVoxels;
    if (m_bricks.empty() || m_bricks.back().brick != brick) m_bricks.push_back({brick, {}});
    mask_set(m_bricks.back().mask, int(slot % kBrickVoxels));
  }
}

std::size_t SlotSet::size() const {
  std::size_t count = 0;
  for (const Brick& entry : m_bricks) count += std::size_t(mask_count(entry.mask));
  return count;
}

const BrickMask* SlotSet::find(std::size_t brick) const {
  const auto found =
      std::lower_bound(m_bricks.begin(), m_bricks.end(), brick,
                       [](const Brick& entry, std::size_t b) { return entry.brick < b; });
  return found != m_bricks.end() && found->brick == brick ? &found->mask : nullptr;
}

bool SlotSet::contains(Slot slot) const {
  const BrickMask* mask = find(slot / kBrickVoxels);
  return mask != nullptr && mask_test(*mask, int(slot % kBrickVoxels));
}

Slot SlotSet::first() const {
  const Brick& entry = m_bricks.front();
  int first = -1;
  for_each_active(entry.mask, [&](int offset) { first = first < 0 ? offset : first; });
  return entry.brick * kBrickVoxels + Slot(first);
}

bool SlotSet::first_common(const SlotSet& other, Slot& slot) const {
  if (other.m_bricks.size() < m_bricks.size()) return other.first_common(*this, slot);
  for (const Brick& entry : m_bricks) {
    const BrickMask* mask = other.find(entry.brick);
    if (mask == nullptr) continue;
    const BrickMask common = both(entry.mask, *mask);
    for (std::size_t word = 0; word < common.size(); ++word) {
      if (common[word] == 0) continue;
      slot = entry.brick * kBrickVoxels + Slot(64 * word) + Slot(__builtin_ctzll(common[word]));
      return true;
    }
  }
  return false;
}

void SlotSet::add(const SlotSet& other) {
  std::vector<Brick> bricks = m_bricks;
  bricks.insert(bricks.end(), other.m_bricks.begin(), other.m_bricks.end());
  *this = SlotSet(std::move(bricks));
}

void SlotSet::remove(const SlotSet& other) {
  const auto emptied = [&](Brick& entry) {
    const BrickMask* mask = other.find(entry.brick);
    if (mask == nullptr) return false;
    for (std::size_t word = 0; word < entry.mask.size(); ++word) entry.mask[word] &= ~(*mask)[word];
    return is_empty(entry.mask);
  };
  m_bricks.erase(std::remove_if(m_bricks.begin(), m_bricks.end(), emptied), m_bricks.end());
}

SlotSet slots_in_box(const BrickTopology& elements, const IndexBox& box) {
  IndexBox part = elements.active_bounds();
  for (int a = 0; a < 3; ++a) {
    part.lo[a] = std::max(part.lo[a], box.lo[a]);
    part.hi[a] = std::min(part.hi[a], box.hi[a]);
  }
  if (part.empty()) return {};
  Vec3i first, count;
  for (int a = 0; a < 3; ++a) {
    first[a] = part.lo[a] & ~(kBrickDim - 1);
    count[a] = (part.hi[a] - first[a]) / kBrickDim + 1;
  }
  std::vector<SlotSet::Brick> bricks;
  const auto take = [&](std::size_t b) {
    const Vec3i& origin = elements.origin(b);
    bricks.push_back({std::uint32_t(b), both(elements.mask(b), mask_of_box(origin, part))});
  };
  if (double(count.x) * count.y * count.z >= double(elements.brick_count())) {
    for (std::size_t b = 0; b < elements.brick_count(); ++b) take(b);
    return SlotSet(std::move(bricks));
  }
  for (int i = 0; i < count.x; ++i) {
    for (int j = 0; j < count.y; ++j) {
      for (int k = 0; k < count.z; ++k) {
        const std::int32_t b = elements.find(first + Vec3i(i, j, k) * kBrickDim);
        if (b >= 0) take(std::size_t(b));
      }
    }
  }
  return SlotSet(std::move(bricks));
}

SlotSet slots_in_mask(const BrickTopology& elements, const BrickTopology& mask) {
  std::vector<SlotSet::Brick> bricks;
  for (std::size_t m = 0; m < mask.brick_count(); ++m) {
    const std::int32_t b = elements.find(mask.origin(m));
    if (b < 0) continue;
    bricks.push_back({std::uint32_t(b), both(mask.mask(m), elements.mask(std::size_t(b)))});
  }
  return SlotSet(std::move(bricks));
}

}  // namespace supple
