// The vectors that the cells of one brick interpolate between: its own nodes and those of its upper
// neighbours, gathered so that a cell is read in one place. Cost: 1 µs and 8.8 kB per brick.
#pragma once

#include <array>

#include "volumes/base/simd.h"
#include "volumes/field/offset_field.h"

namespace supple {

/// Properties of the nodes of a brick, and their layout in memory.
struct BrickNodes {
  static constexpr int kDim = 9;                                                 // nodes 0 … 8
  static constexpr int kStepX = 3 * kDim * kDim, kStepY = 3 * kDim, kStepZ = 3;  // in floats
  static constexpr int kFloats = 3 * kDim * kDim * kDim;

  bool is_zero = true;  // every vector there is
  bool is_void = true;  // wherever there is none
  /// Smallest and largest vectors; lo > hi without any, but where it is_identity().
  Vec3f lo{0, 0, 0}, hi{0, 0, 0};

  bool empty() const { return lo.x > hi.x; }
  /// A cell that has no vector may be read without one only if it is void.
  bool is_identity() const { return is_zero && is_void; }
};

/// Writes the nodes of the brick at `origin`, kFloats of them, x slowest, not a number where there
/// is none. A ring of them is added around the valid ones, as extrapolate_into_bricks() does.
/// `occupied`: voxels that are not void. Vectors that are not finite or lead nowhere (2^20 voxels)
/// count as none. Of a brick that is_identity() since no vector around it is stored, nothing is
/// written.
void gather_nodes(const VectorBrickFinder& field, const BrickTopology& occupied,
                  const Vec3i& origin, float* out, BrickNodes& nodes);

/// Gathered nodes of many bricks, `dim` along every axis, in slots that come and go.
class NodeSlots {
 public:
  explicit NodeSlots(int dim) : m_slot_floats(std::size_t(3) * dim * dim * dim) {}

  /// Takes a slot, which has no memory until grow().
  std::int32_t take();
  void give_back(std::int32_t slot) { m_free.push_back(slot); }
  void grow() { m_floats.resize(std::size_t(m_count) * m_slot_floats + 1); }
  /// Reserves address space for so many slots more, so that growing moves nothing.
  void reserve(std::size_t more);
  float* at(std::int32_t slot) { return &m_floats[std::size_t(slot) * m_slot_floats]; }

  /// Three floats per node, x slowest; four floats may be read at every node.
  const float* data() const { return m_floats.data(); }
  const float* at(std::int32_t slot) const { return &m_floats[std::size_t(slot) * m_slot_floats]; }
  std::size_t bytes() const { return m_floats.size() * sizeof(float); }

 private:
  std::size_t m_slot_floats;
  std::int32_t m_count = 0;
  std::vector<std::int32_t> m_free;
  std::vector<float> m_floats;
};

/// Four packed floats, of which three count.
using Float4 = Pack<float, 4>;

/// The trilinear vector and its derivatives along the axes.
struct NodeDerivatives {
  Float4 value, along_x, along_y, along_z;
};
/// Vector and derivatives from the corners of a cell, x slowest, at a place in it, 0 … 1.
NodeDerivatives derivatives_of(const Float4 (&corners)[8], float x, float y, float z);

}  // namespace supple
