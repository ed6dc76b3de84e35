// Masks of bricks moved by one voxel, as whole words, and what follows for all voxels of a brick at
// once: cells whose corners are set, the corners of cells, and what touches a set voxel.
#pragma once

#include "volumes/grid/padded_rows.h"

namespace supple {

// A word holds the (j, k) plane of one i: bit 8 j + k.
constexpr std::uint64_t kFirstK = 0x0101010101010101u;
constexpr std::uint64_t kLastK = kFirstK << 7;

/// Every voxel goes one step up the axis, and the last plane of the brick below comes in.
inline BrickMask shifted_up(const BrickMask& mask, const BrickMask& below, int axis) {
  BrickMask out;
  for (int i = 0; i < kBrickDim; ++i) {
    switch (axis) {
      case 0:
        out[i] = i > 0 ? mask[i - 1] : below[kBrickDim - 1];
        break;
      case 1:
        out[i] = mask[i] << 8 | below[i] >> 56;
        break;
      default:
        out[i] = (mask[i] & ~kLastK) << 1 | (below[i] & kLastK) >> 7;
    }
  }
  return out;
}

/// Every voxel goes one step down the axis, and the first plane of the brick above comes in.
inline BrickMask shifted_down(const BrickMask& mask, const BrickMask& above, int axis) {
  BrickMask out;
  for (int i = 0; i < kBrickDim; ++i) {
    switch (axis) {
      case 0:
        out[i] = i < kBrickDim - 1 ? mask[i + 1] : above[0];
        break;
      case 1:
        out[i] = mask[i] >> 8 | above[i] << 56;
        break;
      default:
        out[i] = (mask[i] & ~kFirstK) >> 1 | (above[i] & kFirstK) << 7;
    }
  }
  return out;
}

inline void add(const BrickMask& other, BrickMask& mask) {
  for (std::size_t word = 0; word < mask.size(); ++word) mask[word] |= other[word];
}
inline void keep(const BrickMask& other, BrickMask& mask) {
  for (std::size_t word = 0; word < mask.size(); ++word) mask[word] &= other[word];
}

/// The voxels of a brick at which a cell begins whose eight corners are set; `of`: the masks of the
/// brick and of those above it, as cell_corner() numbers them.
inline BrickMask cells_in(std::array<BrickMask, 8> of) {
  for (int axis = 2, step = 1; axis >= 0; --axis, step *= 2) {
    for (int n = 0; n < 8; n += 2 * step) keep(shifted_down(of[n], of[n + step], axis), of[n]);
  }
  return of[0];
}

/// The voxels of a brick that are corners of cells; `of`: the cells that begin in the brick and in
/// those below it, as cell_corner() numbers them.
inline BrickMask corners_of(std::array<BrickMask, 8> of) {
  for (int axis = 2, step = 1; axis >= 0; --axis, step *= 2) {
    for (int n = 0; n < 8; n += 2 * step) add(shifted_up(of[n], of[n + step], axis), of[n]);
  }
  return of[0];
}

/// The voxels of a brick that are set or touch a set one; `around`: masks of the 27 bricks.
inline BrickMask dilated(std::array<BrickMask, 27> around) {
  int first = 0;
  for (int axis = 2, step = 1; axis >= 0; --axis, step *= 3) {
    first += step;  // in the middle along this axis and those before it
    for (int n = first; n < 27; n += 3 * step) {
      const BrickMask mask = around[n];
      add(shifted_up(mask, around[n - step], axis), around[n]);
      add(shifted_down(mask, around[n + step], axis), around[n]);
    }
  }
  return around[13];
}

/// Masks of the 27 bricks around a brick, empty where there is none.
template <class MaskOf>
std::array<BrickMask, 27> masks_around(const Surroundings& around, MaskOf&& mask_of) {
  std::array<BrickMask, 27> masks;
  for (std::size_t n = 0; n < masks.size(); ++n) {
    masks[n] = around[n] < 0 ? BrickMask{} : mask_of(around[n]);
  }
  return masks;
}

}  // namespace supple
