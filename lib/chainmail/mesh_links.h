// Box limits of explicit connectors: the slack of every link of a mesh body (thesis sections 4.2.4
// and 4.2.5), per LPS coordinate, and the links seen from their nodes.
//
// The thesis' limits (eqs. 4.3-4.5) are those of a link along a grid axis: its length along the
// axis lies within [min_length, max_length] times its rest length L, and both transverse components
// within +-shear L. An oblique link has the rest difference r = L e, and a coordinate c sees |e_c|
// of the link lengthwise and sqrt(1 - e_c^2) of it sideways. So c may leave its rest difference by
// at most
//
//   longer:   ((max_length - 1) |e_c| + shear sqrt(1 - e_c^2)) L
//   shorter:  ((1 - min_length) |e_c| + shear sqrt(1 - e_c^2)) L
//
// where the sign of e_c says which way is longer. This is the smallest box along the LPS axes that
// holds every allowed elongation of the link together with a sideways move of at most shear L in
// any direction across it. For e along an axis that is the lattice's rule to the bit; in between it
// varies continuously with the direction. Boxes along fixed axes keep the three coordinates
// independent, which the exact solver needs (design.md section 3); limits that turned with the
// links would couple them, as ball limits do. The price: a box holds more than the link's own
// moves, so an oblique link may get longer than max_length L where coordinates use their slack
// together.
//
// Units: offsets from rest in 2^-16 mm; slacks rounded down. Memory: 72 bytes per link, 8 per node.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/body/slot_set.h"
#include "lib/chainmail/mesh_ecm.h"
#include "lib/material/material.h"
#include "lib/mesh/mesh_body.h"

namespace supple {

/// Slack of a link a -> b with rest difference r = rest_b - rest_a in mm, in 2^-16 mm. A link of
/// length 0 has none: its ends move as one.
LinkSlack slack_of(const Vec3d& rest_difference_mm, const MeshLimits& limits);

/// One coordinate of a link as a node sees it, in 2^-16 mm:
///   q_node - q_to <= out   and   q_to - q_node <= in.
struct MeshStep {
  Slot to;
  std::int32_t out, in;
};

/// Steps of all nodes, node after node, per coordinate.
class MeshLinks {
 public:
  /// Throws InputError: limits out of range, or not as many as links; a rest position beyond
  /// +-10^7 mm, where 2^-16 mm would get lost.
  MeshLinks(const MeshBody& body, const std::vector<MeshLimits>& limits);

  std::size_t node_count() const { return m_first.size() - 1; }
  std::size_t link_count() const { return m_steps[0].size() / 2; }

  /// Index of a node's first step; those of node n + 1 follow.
  std::size_t first(Slot node) const { return m_first[node]; }
  const MeshStep& step(int coordinate, std::size_t index) const {
    return m_steps[std::size_t(coordinate)][index];
  }

  /// Width of the flat engine's buckets, as a power of two: a quarter of a typical slack.
  int bucket_shift(int coordinate) const { return m_bucket_shift[std::size_t(coordinate)]; }
  std::size_t bytes() const;

 private:
  std::vector<std::size_t> m_first;  // per node, and the end
  std::array<std::vector<MeshStep>, 3> m_steps;
  std::array<int, 3> m_bucket_shift{};
};

}  // namespace supple
