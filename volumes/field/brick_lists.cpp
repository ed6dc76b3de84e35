#include "volumes/field/brick_lists.h"

#include <algorithm>
#include <iterator>
#include <numeric>

#include "volumes/grid/cell.h"
#include "volumes/grid/padded_rows.h"

namespace supple {

namespace {

class Listed {
 public:
  explicit Listed(const BrickTopology& topology) : m_is_listed(topology.brick_count(), 0) {}

  void add(std::int32_t b) {
    if (b >= 0) m_is_listed[std::size_t(b)] = 1;
  }
  BrickList bricks() const {
    BrickList bricks;
    for (std::size_t b = 0; b < m_is_listed.size(); ++b) {
      if (m_is_listed[b]) bricks.push_back(std::int32_t(b));
    }
    return bricks;
  }

 private:
  std::vector<std::uint8_t> m_is_listed;
};

/// The bricks and those beside their corner cells, `towards` -1 below and 1 above.
BrickList with_corners(const BrickTopology& topology, const BrickList& bricks, int towards) {
  Listed listed(topology);
  for (const std::int32_t b : bricks) {
    listed.add(b);
    for (int n = 1; n < kCellCorners; ++n) {
      const Vec3i step = cell_corner(n) * (towards * kBrickDim);
      listed.add(topology.find(topology.origin(std::size_t(b)) + step));
    }
  }
  return listed.bricks();
}

}  // namespace

BrickList all_bricks(const BrickTopology& topology) {
  BrickList bricks(topology.brick_count());
  std::iota(bricks.begin(), bricks.end(), 0);
  return bricks;
}

BrickList unite(const BrickList& a, const BrickList& b) {
  BrickList both;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  return both;
}

BrickList with_neighbours(const BrickTopology& topology, const BrickList& bricks) {
  Listed listed(topology);
  for (const std::int32_t b : bricks) {
    for (const std::int32_t n : surroundings_of(topology, std::size_t(b))) listed.add(n);
  }
  return listed.bricks();
}

BrickList with_lower_neighbours(const BrickTopology& topology, const BrickList& bricks) {
  return with_corners(topology, bricks, -1);
}

BrickList with_upper_neighbours(const BrickTopology& topology, const BrickList& bricks) {
  return with_corners(topology, bricks, 1);
}

}  // namespace supple
