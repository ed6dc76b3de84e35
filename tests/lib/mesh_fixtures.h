// Mesh bodies for tests of ECM on explicit connectors, and ECM on them by brute force: slacks in
// long double from directions, distances by relaxing every link until nothing changes, all pairs of
// handles and anchors. It shares no code with lib/ beyond plain values.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "lib/chainmail/mesh_links.h"
#include "lib/mesh/mesh_body.h"
#include "tests/lib/brute_force.h"

namespace supple::test {

/// 10 * 4^level + 2 vertices around the origin, outward faces.
TriangleMesh icosphere(int level, double radius_mm);

/// Nodes at 0, step, 2 step …, each linked to the next.
MeshBody chain_body(int nodes, const Vec3d& step_mm);

/// Up to `max_nodes` nodes, some links along axes, some of length 0; not always in one piece.
MeshBody random_network(std::mt19937& random, int max_nodes);
/// One entry per link: rigid, usual, wide and unlimited ones.
std::vector<MeshLimits> random_limits(std::mt19937& random, std::size_t links);

class MeshBruteForce {
 public:
  MeshBruteForce(const MeshBody& body, const std::vector<MeshLimits>& limits);

  struct Grab {
    std::vector<int> nodes;
    std::array<Wide, 3> by;
    bool push = false;
  };
  struct Outcome {
    bool conflict = false;
    int conflict_axis = 0;
    Wide missing = 0;  // the largest over pairs of handles, first coordinate that has any
    Wide numerator = 1, denominator = 1;
  };
  /// Moves q unless handles contradict each other.
  Outcome drag(const std::vector<Grab>& grabs, const std::vector<int>& anchors);
  /// floor((L + U) / 2) of all nodes; the largest move.
  Wide project();
  int broken_links() const;

  /// Distance by which two nodes' targets are further apart than the links between them allow.
  Wide missing(int c, int a, Wide target_a, int b, Wide target_b) const {
    return target_a - target_b - distances(c, a, true)[std::size_t(b)];
  }

  std::array<std::vector<Wide>, 3> q;  // per node

 private:
  struct Link {
    int a, b;
    std::array<Wide, 3> longer, shorter;  // q_b - q_a <= longer, q_a - q_b <= shorter
  };
  struct Limit {
    int node;
    Wide by;
    bool is_handle;
  };
  std::vector<Wide> distances(int c, int source, bool from) const;
  std::vector<Limit> limits(int c, bool lower, const std::vector<Grab>& grabs,
                            const std::vector<int>& anchors) const;
  void compare(int c, const std::vector<Limit>& lower, const std::vector<Limit>& upper,
               Outcome& outcome) const;

  std::size_t m_nodes;
  std::vector<Link> m_links;
};

/// Fails the test unless every position is rest + q 2^-16 mm, to the bit.
void expect_equal(const MeshBody& body, const MeshBruteForce& brute);

}  // namespace supple::test
