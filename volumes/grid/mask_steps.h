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
inline void take_out(const BrickMask& other, BrickMask& mask) {
  for (std::size_t word = 0; word < mask.size(); ++word) mask[word] &= ~other[word];
}

/// The voxels of a brick at which a cell begins whose eight corners are set; `of`: the masks of the
/// brick and of those above it, as cell_corner() numbers them.
inline BrickMask cells_in(std::array<BrickMask, 8> of) {
  for (int axis = 2, step = 1; axis >= 0; --axis, step *= 2) {
    for (int n = 0; n < 8; n += 2 * step) keep(shifted_down(of[n], of[n + step], axis), of[n]);
  }
  return of[0];
}

/// The voxels of a brick at which a cell begins of whose eight corners any is set.
inline BrickMask cells_beside(std::array<BrickMask, 8> of) {
  for (int axis = 2, step = 1; axis >= 0; --axis, step *= 2) {
    for (int n = 0; n < 8; n += 2 * step) add(shifted_down(of[n], of[n + step], axis), of[n]);
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

/// Masks of the 27 bricks around a brick, an empty one where there is none.
using MasksAround = std::array<const BrickMask*, 27>;

/// The voxels of a brick that are set or touch a set one.
inline BrickMask dilated(const MasksAround& around) {
  const auto along = [](const BrickMask& below, const BrickMask& mask, const BrickMask& above,
                        int axis) {
    BrickMask out = mask;
    add(shifted_up(mask, below, axis), out);
    add(shifted_down(mask, above, axis), out);
    return out;
  };
  std::array<BrickMask, 9> columns;
  for (std::size_t n = 0; n < columns.size(); ++n) {
    columns[n] = along(*around[3 * n], *around[3 * n + 1], *around[3 * n + 2], 2);
  }
  std::array<BrickMask, 3> planes;
  for (std::size_t n = 0; n < planes.size(); ++n) {
    planes[n] = along(columns[3 * n], columns[3 * n + 1], columns[3 * n + 2], 1);
  }
  return along(planes[0], planes[1], planes[2], 0);
}

template <class MaskOf>
MasksAround masks_around(const Surroundings& around, MaskOf&& mask_of) {
  static constexpr BrickMask kNone{};
  MasksAround masks;
  for (std::size_t n = 0; n < masks.size(); ++n) {
    masks[n] = around[n] < 0 ? &kNone : &mask_of(around[n]);
  }
  return masks;
}

}  // namespace supple
