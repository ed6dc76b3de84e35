// The six faces of a brick as 64 values each. Faces are numbered as in BrickTopology::neighbour
// (0 -i, 1 +i, 2 -j, 3 +j, 4 -k, 5 +k); the order inside a face is that of the offsets.
#pragma once

#include <cstdint>
#include <cstring>

#include "volumes/grid/brick_topology.h"

namespace supple {

constexpr int kFaceVoxels = 64;

constexpr int axis_of_face(int face) {
  return face >> 1;
}
constexpr bool is_high_face(int face) {
  return (face & 1) != 0;
}
constexpr int opposite_face(int face) {
  return face ^ 1;
}

/// Copies the values of a face out of the 512 of a brick.
template <class T>
void take_face(const T* brick, int face, T* out) {
  const int layer = is_high_face(face) ? kBrickDim - 1 : 0;
  switch (axis_of_face(face)) {
    case 0:
      std::memcpy(out, brick + 64 * layer, 64 * sizeof(T));
      break;
    case 1:
      for (int i = 0; i < 8; ++i) {
        std::memcpy(out + 8 * i, brick + 64 * i + 8 * layer, 8 * sizeof(T));
      }
      break;
    default:
      for (int row = 0; row < 64; ++row) out[row] = brick[8 * row + layer];
  }
}

/// Copies the values of a face back into a brick.
template <class T>
void put_face(const T* values, int face, T* brick) {
  const int layer = is_high_face(face) ? kBrickDim - 1 : 0;
  switch (axis_of_face(face)) {
    case 0:
      std::memcpy(brick + 64 * layer, values, 64 * sizeof(T));
      break;
    case 1:
      for (int i = 0; i < 8; ++i) {
        std::memcpy(brick + 64 * i + 8 * layer, values + 8 * i, 8 * sizeof(T));
      }
      break;
    default:
      for (int row = 0; row < 64; ++row) brick[8 * row + layer] = values[row];
  }
}

/// The bits of a face, bit n for value n of take_face().
inline std::uint64_t face_bits(const BrickMask& mask, int face) {
  const int layer = is_high_face(face) ? kBrickDim - 1 : 0;
  if (axis_of_face(face) == 0) return mask[layer];
  std::uint64_t bits = 0;
  for (int i = 0; i < 8; ++i) {
    std::uint64_t row = mask[i] >> (8 * layer) & 0xff;
    if (axis_of_face(face) == 2) {
      // One bit of each byte, gathered into one byte by a multiplication.
      row = (mask[i] >> layer & 0x0101010101010101u) * 0x0102040810204080u >> 56;
    }
    bits |= row << (8 * i);
  }
  return bits;
}

}  // namespace supple
