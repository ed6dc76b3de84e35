#include "volumes/grid/link_cuts.h"

#include <algorithm>

namespace supple {

LinkCuts::Place LinkCuts::place_of(double fraction) {
  return Place(1 + std::clamp(int(fraction * kPlaces), 0, kPlaces - 1));
}

bool LinkCuts::cut(std::size_t b, int offset, int axis, Place place) {
  if (b >= m_record_of.size()) m_record_of.resize(b + 1, -1);
  if (m_record_of[b] < 0) {
    m_record_of[b] = std::int32_t(m_records.size());
    m_records.push_back({});
  }
  const std::size_t record = std::size_t(m_record_of[b]);
  if (place != 0) {
    if (m_places.size() <= record) m_places.resize(record + 1);
    m_places[record].resize(3 * kBrickVoxels);
    Place& known = m_places[record][std::size_t(axis) * kBrickVoxels + std::size_t(offset)];
    if (known == 0) known = place;
  }
  BrickMask& mask = m_records[record][axis];
  if (mask_test(mask, offset)) return false;
  mask_set(mask, offset);
  ++m_count;
  return true;
}

std::size_t LinkCuts::bytes() const {
  std::size_t places = m_places.capacity() * sizeof(std::vector<Place>);
  for (const auto& brick : m_places) places += brick.capacity() * sizeof(Place);
  return m_record_of.capacity() * sizeof(std::int32_t) + m_records.capacity() * sizeof(BrickCuts) +
         places;
}

bool LinkCuts::operator==(const LinkCuts& other) const {
  if (m_count != other.m_count) return false;
  for (std::size_t b = 0; b < m_record_of.size(); ++b) {
    const BrickCuts* mine = brick(b);
    const BrickCuts* theirs = other.brick(b);
    if (mine == nullptr) continue;
    if (theirs == nullptr || *mine != *theirs) return false;
    if (m_places.empty() && other.m_places.empty()) continue;
    bool is_same = true;
    for (int axis = 0; axis < 3; ++axis) {
      for_each_active((*mine)[std::size_t(axis)], [&](int offset) {
        is_same = is_same && place(b, offset, axis) == other.place(b, offset, axis);
      });
    }
    if (!is_same) return false;
  }
  return true;
}

}  // namespace supple
