// Disjoint sets of numbers 0 ... count - 1 by union-find; the representative of a set is its
// smallest member. Nearly O(1) per call.
#pragma once

#include <cstdint>
#include <numeric>
#include <vector>

namespace supple {

class CornerSets {
 public:
  explicit CornerSets(std::size_t count) : m_up(count) {
    std::iota(m_up.begin(), m_up.end(), std::uint32_t(0));
  }

  std::uint32_t find(std::uint32_t member) {
    while (m_up[member] != member) {
      m_up[member] = m_up[m_up[member]];
      member = m_up[member];
    }
    return member;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    if (a < b) m_up[b] = a;
    if (b < a) m_up[a] = b;
  }

 private:
  std::vector<std::uint32_t> m_up;
};

}  // namespace supple
