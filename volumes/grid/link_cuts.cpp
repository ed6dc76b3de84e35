#include "volumes/grid/link_cuts.h"

namespace supple {

bool LinkCuts::cut(std::size_t b, int offset, int axis) {
  if (b >= m_record_of.size()) m_record_of.resize(b + 1, -1);
  if (m_record_of[b] < 0) {
    m_record_of[b] = std::int32_t(m_records.size());
    m_records.push_back({});
  }
  BrickMask& mask = m_records[std::size_t(m_record_of[b])][axis];
  if (mask_test(mask, offset)) return false;
  mask_set(mask, offset);
  ++m_count;
  return true;
}

std::size_t LinkCuts::bytes() const {
  return m_record_of.capacity() * sizeof(std::int32_t) + m_records.capacity() * sizeof(BrickCuts);
}

bool LinkCuts::operator==(const LinkCuts& other) const {
  if (m_count != other.m_count) return false;
  for (std::size_t b = 0; b < m_record_of.size(); ++b) {
    const BrickCuts* mine = brick(b);
    const BrickCuts* theirs = other.brick(b);
    if (mine == nullptr) continue;
    if (theirs == nullptr || *mine != *theirs) return false;
  }
  return true;
}

}  // namespace supple
