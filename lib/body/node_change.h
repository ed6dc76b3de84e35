// Changes of a step to the nodes of a body, to be taken back: the bricks that it changed, as they
// were. Memory: those bricks. Cost to make: one comparison per stored value.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/body/body.h"

namespace supple {

/// Change of an array with a number per voxel.
template <class T>
class BrickChange {
 public:
  BrickChange(const BrickArray<T>& before, const BrickArray<T>& after);
  /// Turns `values`, which are those after the change, into those before.
  void take_back(BrickArray<T>& values) const;
  /// The bricks of the change become as they are in `now`.
  void take_over(const BrickArray<T>& now, BrickArray<T>& values) const;
  std::size_t bytes() const { return m_values.size() * sizeof(T) + m_bricks.size() * 5; }

 private:
  std::size_t m_brick_count;
  std::vector<std::uint32_t> m_bricks;
  std::vector<std::uint8_t> m_is_stored;  // before, one for each of them
  std::vector<T> m_values;                // of those that were
};

class NodeChange;

/// All that models leave in nodes, a copy that follows the body.
struct StepNodes {
  explicit StepNodes(const Body& body)
      : q(body.q), fraction(body.fraction), rest(body.rest), velocity_mm_s(body.velocity_mm_s) {}
  /// Takes over what has changed in the body since; nothing else has.
  void follow(const Body& body, const NodeChange& change);

  std::array<BrickValues, 3> q;
  std::array<BrickArray<std::int16_t>, 3> fraction;
  RestStretch rest;
  Velocities velocity_mm_s;
};

class NodeChange {
 public:
  /// Finds the change of a body that has the elements that it had.
  NodeChange(const StepNodes& before, const Body& after);
  void take_back(Body& body) const;
  std::size_t bytes() const;

 private:
  friend StepNodes;

  std::vector<BrickChange<std::int32_t>> m_integers;  // q, then rest
  std::vector<BrickChange<std::int16_t>> m_fractions;
  std::vector<BrickChange<double>> m_velocities;
};

}  // namespace supple
