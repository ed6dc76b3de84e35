// Reach of drags without performing them: the algebra of Enhanced ChainMail on bricks in place of
// voxels.
//
// Per coordinate, a brick that a handle grabs goes as far as the handle; crossing half a brick
// costs four times the mean slack of its links along that axis (docs/models/ecm.md, "Theorem").
// What is left of the handle's way on arrival says how much of a brick moves. Mean slacks of up to
// 64 links per axis stand for all of a brick, so that thin plates of bone are blurred. Anchors,
// cuts, ball limits and rigid pieces are not seen: more moves than will.
//
// Cost: 2 us per brick of the body, and 1 us per brick that is reached.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/body/body.h"
#include "lib/session/step.h"

namespace supple::tools {

struct MovedBricks {
  std::array<std::vector<std::uint8_t>, 3>
      bricks;                               // per coordinate and brick of the body: 1, moves
  std::array<double, 3> elements{0, 0, 0};  // that move, per coordinate
  double split = 0;                         // bricks beside cut links, or beside joints of bones

  std::int64_t count(int coordinate) const;
  /// Bricks that move in any coordinate.
  std::int64_t count() const;
  /// True if a brick moves in any coordinate.
  bool moves_brick(std::size_t b) const;
  bool moves(int coordinate) const { return !bricks[std::size_t(coordinate)].empty(); }
  /// Lets every element move in the coordinate.
  void add_all(int coordinate, const BrickTopology& elements);
  void add(const MovedBricks& other);
};

/// Grabbed elements and the offsets `by_q` of their drag in 2^-16 voxel (ecm.h). A coordinate that
/// no drag asks for has no bricks.
struct PlannedGrip {
  SlotSet elements;
  std::array<std::int32_t, 3> by_q;
};
MovedBricks reach_of(const Body& body, const std::vector<PlannedGrip>& grips);

}  // namespace supple::tools
