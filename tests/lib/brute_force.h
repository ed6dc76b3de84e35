// ECM by brute force: dense arrays, limits from the table by its own arithmetic, distances by
// relaxing every link until nothing changes, all pairs of handles and anchors. It shares no code
// with lib/ beyond the plain values of a material table.
#pragma once

#include <array>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include "lib/chainmail/ecm.h"
#include "tests/lib/test_bodies.h"

namespace supple::test {

using Wide = std::int64_t;
constexpr Wide kNoPath = Wide(1) << 55;
using Real = long double;

/// The part of a displacement that is performed, truncated toward zero.
template <class Outcome>
Wide part_of(Wide by, const Outcome& outcome) {
  const Wide size = std::abs(by) * outcome.numerator / outcome.denominator;
  return by < 0 ? -size : size;
}

class BruteForce {
 public:
  explicit BruteForce(const Block& block);

  struct Grab {
    std::vector<int> nodes;
    std::array<Wide, 3> by;
    bool push = false;
    std::vector<std::array<Wide, 3>> each = {};  // of every node, in place of by

    const std::array<Wide, 3>& by_of(std::size_t n) const { return each.empty() ? by : each[n]; }
  };
  struct Outcome {
    bool conflict = false;
    int conflict_axis = 0;
    Wide missing = 0;  // the largest over pairs of handles, first coordinate that has any
    Wide numerator = 1, denominator = 1;
  };
  /// Moves q unless handles contradict each other; among what earlier drags held, and keeps hold
  /// of these handles, when `keep` says so.
  Outcome drag(const std::vector<Grab>& grabs, const std::vector<int>& anchors, bool keep = false);
  void let_go() { m_kept.clear(); }

  /// The largest T_a - T_b - dist(a, b) of two handles for the whole drag.
  Wide missing(int c, const Grab& a, const Grab& b) const;

  /// Shortest path in slack from `source` to every node, or from every node to it.
  std::vector<Wide> distances_from(int c, int source) const { return relax(c, source, true); }
  std::vector<Wide> distances_to(int c, int source) const { return relax(c, source, false); }
  int broken_links() const;

  /// Keeps the present distances between these nodes, whose own links are cut.
  void join(const std::vector<int>& nodes);

  std::array<std::vector<Wide>, 3> q;  // one per node of the block

 private:
  struct Link {
    int low, high;
    std::array<Wide, 3> upper, lower;
  };
  /// A node that may not sink below (or rise above) `at` + the moved part of `by`.
  struct Limit {
    int node;
    Wide at, by;
    bool is_handle;
  };
  /// A node that an earlier drag holds: where it is, or by a bound per coordinate.
  struct Kept {
    int node;
    bool anchored;
    std::array<Wide, 3> least, most;
  };
  void add_diagonals(const Block& block);
  std::vector<Wide> relax(int c, int source, bool from) const;
  std::vector<Limit> limits(int c, bool lower, const std::vector<Grab>& grabs,
                            const std::vector<int>& anchors) const;
  void compare(int c, const std::vector<Limit>& lower, const std::vector<Limit>& upper,
               Outcome& outcome) const;
  void move_between(int c, const std::vector<Limit>& lower, const std::vector<Limit>& upper,
                    const Outcome& outcome);
  /// Limit that the tool of a push handle sets a node in one coordinate; none where it sets none.
  std::optional<Wide> tool_at(int c, bool lower, int node, Wide by) const;
  std::vector<Kept> kept_after(const std::vector<Grab>& grabs, const Outcome& outcome) const;

  std::vector<Kept> m_kept;
  int m_nodes;
  std::vector<Link> m_links;
};

/// One drag as the engine and as brute force take it: handles and anchors.
struct RandomDrag {
  std::vector<Handle> handles;
  std::vector<BruteForce::Grab> grabs;
  std::vector<Region> fixed;
  std::vector<int> anchors;
};

/// Fails the test unless every offset is the same.
void expect_equal(const Body& body, const Block& block, const BruteForce& brute);

}  // namespace supple::test
