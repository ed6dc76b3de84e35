// The node state that a body is to have, written node by node: offsets with their fractions, and
// velocities. The body is unchanged until give().
#pragma once

#include <array>
#include <cstdint>

#include "lib/body/body.h"

namespace supple {

class NodeOffsets {
 public:
  /// Starts from the present offsets and velocities of the body.
  explicit NodeOffsets(const Body& body);

  /// Sets an offset in voxels of the coordinate's axis, rounded to 2^-32 voxel. Throws InputError
  /// beyond +-16383 voxels. Returns the rounding in voxels.
  double set_offset(int c, Slot slot, double voxels);
  /// Sets an offset in 2^-16 voxel, without fraction.
  void set_whole(int c, Slot slot, std::int32_t q);
  void set_velocity(int c, Slot slot, double mm_s);

  /// Gives all to the body; velocities and fractions that are all 0 take no memory there. Unless
  /// nothing moved, links are not known to be valid afterwards (check_links, project).
  void give(Body& body);

 private:
  template <class T>
  bool set(BrickArray<T>& values, Slot slot, T value);

  const BrickTopology& m_elements;
  std::array<BrickValues, 3> m_q;
  std::array<BrickArray<std::int16_t>, 3> m_fraction;
  Velocities m_velocity;
  bool m_has_moved = false;
};

/// Offset of coordinate c in voxels, with its fraction.
double offset_with_fraction(const Body& body, int c, Slot slot);

}  // namespace supple
