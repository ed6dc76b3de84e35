// One visit of a brick whose material has diagonals: as the visit of block_propagate.cpp, with 26
// neighbours in place of 6. Sides are directions (lib/material/material.h).
#pragma once

#include <vector>

#include "lib/body/body.h"
#include "lib/chainmail/diagonal_kernel.h"
#include "lib/chainmail/propagation.h"

namespace supple {

/// Data that the visits of one phase share.
struct VisitContext {
  const Body& body;
  const LinkCosts& costs;
  const PropagationTask& task;
  const std::vector<BrickNeighbours>& neighbours;  // empty with 6 links
};

class DiagonalVisit {
 public:
  static constexpr int kNeighbours = kDirections;
  /// Entrance besides the neighbours: a seed was set inside.
  static constexpr int kSeeded = kNoStep;

  DiagonalVisit(const VisitContext& context, std::size_t brick);

  static std::size_t neighbour(const VisitContext& context, std::size_t brick, int side) {
    return std::size_t(context.neighbours[brick][std::size_t(side)]);
  }
  static int opposite(int side) { return opposite_direction(side); }

  /// Draws in the levels that a neighbour sends.
  void draw(int side);
  void close();
  /// Stores the values; returns the sides that a change may affect, as bits.
  unsigned store(std::int32_t* q) const;
  /// The largest level that goes to a neighbour and changes it; 0: none does.
  Level send(int side) const;

 private:
  template <class Visit>
  void for_each_link_to(int side, Visit&& visit) const;
  void draw_face(int side, int face, std::size_t other);
  Level send_face(int side, int face, std::size_t other) const;

  void take_levels(std::size_t other, int face, std::int32_t* levels) const;
  const std::int32_t* signed_levels() const {
    return reinterpret_cast<const std::int32_t*>(m_levels);
  }
  const std::int32_t* offsets(std::size_t brick) const { return m_values.brick_or_zero(brick); }
  const std::uint8_t* classes(std::size_t brick) const {
    return m_body.classes.data() + brick * kBrickVoxels;
  }

  /// Entry of a link in a row of costs.
  std::size_t entry_of(int own, std::size_t other, int there) const {
    return std::size_t(classes(m_brick)[own] * m_costs.stride() + classes(other)[there]);
  }

  const Body& m_body;
  const LinkCosts& m_costs;
  const BrickValues& m_values;
  const Direction m_direction;
  const std::size_t m_brick;
  const BrickNeighbours& m_neighbours;
  LinkMasks m_links;
  alignas(64) Level m_levels[kBrickVoxels];
};

}  // namespace supple
