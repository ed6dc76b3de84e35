// The nodes of a lattice above a brick that are corners of its cells, as they were read last.
#pragma once

#include <array>
#include <bitset>

#include "volumes/field/offset_field.h"

namespace supple {

class UpperNodes {
 public:
  bool are_known() const { return m_are_known; }
  /// Reads the nodes above the brick at `origin`; returns the cells with another one than before.
  BrickMask follow(const VectorBrickFinder& lattice, const Vec3i& origin);

 private:
  static constexpr int kCount = 9 * 9 * 9 - kBrickVoxels;

  std::array<Vec3f, kCount> m_vectors;
  std::bitset<kCount> m_valid;
  bool m_are_known = false;
};

}  // namespace supple
