// ECM by brute force: dense arrays, limits from the table by its own arithmetic, distances by
// relaxing every link until nothing changes, all pairs of handles and anchors. It shares no code
// with lib/ beyond the plain values of a material table.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/lib/test_bodies.h"

namespace supple::test {

using Wide = std::int64_t;
constexpr Wide kNoPath = Wide(1) << 55;

class BruteForce {
 public:
  explicit BruteForce(const Block& block);

  struct Grab {
    int node;
    std::array<Wide, 3> by;
  };
  struct Outcome {
    bool conflict = false;
    int conflict_axis = 0;
    Wide missing = 0;  // the largest over pairs of handles, first coordinate that has any
    Wide numerator = 1, denominator = 1;
  };
  /// Moves q unless handles contradict each other.
  Outcome drag(const std::vector<Grab>& grabs, const std::vector<int>& anchors);

  /// T_a - T_b - dist(a, b) of two handles for the whole drag.
  Wide missing(int c, const Grab& a, const Grab& b) const;

  /// Shortest path in slack from `source` to every node, or from every node to it.
  std::vector<Wide> distances_from(int c, int source) const { return relax(c, source, true); }
  std::vector<Wide> distances_to(int c, int source) const { return relax(c, source, false); }
  int broken_links() const;

  std::array<std::vector<Wide>, 3> q;  // one per node of the block

 private:
  struct Link {
    int low, high;
    std::array<Wide, 3> upper, lower;
  };
  std::vector<Wide> relax(int c, int source, bool from) const;
  void move_between(int c, const std::vector<int>& held, const std::vector<Wide>& targets);

  int m_nodes;
  std::vector<Link> m_links;
};

}  // namespace supple::test
