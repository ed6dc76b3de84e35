#include "lib/body/link_masks.h"

#include <algorithm>
#include <cstring>

#include "volumes/base/simd.h"

namespace supple {

namespace {

constexpr std::uint64_t kAllOfPlane = ~std::uint64_t(0);
constexpr BrickMask kAllVoxels = {kAllOfPlane, kAllOfPlane, kAllOfPlane, kAllOfPlane,
                                  kAllOfPlane, kAllOfPlane, kAllOfPlane, kAllOfPlane};

/// Bits of a brick and of the voxels around it: rows of 10 along k, 10 x 10 of them, bit 1 of row
/// 11 being voxel 0 of the brick. Rows beyond are there to be read and mean nothing.
constexpr int kHaloRows = 100, kRowsOfPlane = 10, kBeyond = 14;
struct HaloBits {
  std::uint16_t rows[kBeyond + kHaloRows + kBeyond] = {};
  std::uint16_t* first() { return rows + kBeyond; }
  const std::uint16_t* first() const { return rows + kBeyond; }
};

/// Adds the part of a neighbour's mask that lies in the halo, or the brick's own.
void add_bits(const BrickMask& mask, const LinkStep& step, HaloBits& out) {
  const auto first = [&](int axis) { return step[std::size_t(axis)] < 0 ? 7 : 0; };
  const auto last = [&](int axis) { return step[std::size_t(axis)] > 0 ? 0 : 7; };
  for (int i = first(0); i <= last(0); ++i) {
    for (int j = first(1); j <= last(1); ++j) {
      const unsigned byte = unsigned(mask[std::size_t(i)] >> (8 * j) & 0xff);
      const unsigned bits = step[2] == 0 ? byte << 1 : step[2] < 0 ? byte >> 7 : (byte & 1) << 9;
      const int row = kRowsOfPlane * (i + 1 + 8 * step[0]) + j + 1 + 8 * step[1];
      out.first()[row] = std::uint16_t(out.first()[row] | bits);
    }
  }
}

/// to |= links & (the bit of `from` at the voxel one step along the axis).
void add_path(const HaloBits& links, const HaloBits& from, int axis, bool positive, HaloBits& to) {
  const int rows = axis == 0 ? kRowsOfPlane : axis == 1 ? 1 : 0;
  const std::uint16_t* next = from.first() + (positive ? rows : -rows);
  const std::uint16_t* step = links.first();
  std::uint16_t* out = to.first();
  if (axis < 2) {
    for (int r = 0; r < kHaloRows; ++r) out[r] = std::uint16_t(out[r] | (step[r] & next[r]));
  } else if (positive) {
    for (int r = 0; r < kHaloRows; ++r) out[r] = std::uint16_t(out[r] | (step[r] & next[r] >> 1));
  } else {
    for (int r = 0; r < kHaloRows; ++r) out[r] = std::uint16_t(out[r] | (step[r] & next[r] << 1));
  }
}

BrickMask own_bits(const HaloBits& halo) {
  using EightRows = Pack<std::uint16_t, 8>;
  using EightBytes = Pack<std::uint8_t, 8>;
  BrickMask mask;
  for (int i = 0; i < 8; ++i) {
    EightRows rows;
    std::memcpy(&rows, halo.first() + kRowsOfPlane * (i + 1) + 1, sizeof rows);
    const EightBytes bytes = __builtin_convertvector(rows >> 1, EightBytes);
    std::memcpy(&mask[std::size_t(i)], &bytes, sizeof bytes);
  }
  return mask;
}

/// Finds the links along the axes, both ways.
void find_axis_links(const BrickTopology& elements, const LinkCuts& cuts,
                     const BrickNeighbours& bricks, std::array<HaloBits, kDirections>& links) {
  HaloBits present, all;
  std::memset(all.rows, 0xff, sizeof all.rows);
  std::array<HaloBits, 3> uncut = {all, all, all};
  for (int direction = 0; direction < kDirections; ++direction) {
    const std::int32_t brick = bricks[std::size_t(direction)];
    if (brick < 0) continue;
    const LinkStep step = step_of_direction(direction);
    add_bits(elements.mask(std::size_t(brick)), step, present);
    const LinkCuts::BrickCuts* cut = cuts.empty() ? nullptr : cuts.brick(std::size_t(brick));
    for (int axis = 0; cut != nullptr && axis < 3; ++axis) {
      HaloBits removed;
      add_bits((*cut)[std::size_t(axis)], step, removed);
      for (int r = 0; r < kHaloRows; ++r) {
        std::uint16_t& row = uncut[std::size_t(axis)].first()[r];
        row = std::uint16_t(row & ~removed.first()[r]);
      }
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    HaloBits& up = links[std::size_t(direction_along(axis, true))];
    HaloBits& down = links[std::size_t(direction_along(axis, false))];
    HaloBits& low_end = uncut[std::size_t(axis)];
    for (int r = 0; r < kHaloRows; ++r) {
      low_end.first()[r] = std::uint16_t(low_end.first()[r] & present.first()[r]);
    }
    add_path(low_end, present, axis, true, up);
    add_path(present, up, axis, false, down);
  }
}

/// True where the brick and all bricks around it are full of elements and have no cut.
bool is_inside(const BrickTopology& elements, const LinkCuts& cuts, const BrickNeighbours& bricks) {
  return std::all_of(bricks.begin(), bricks.end(), [&](std::int32_t brick) {
    return brick >= 0 && elements.mask(std::size_t(brick)) == kAllVoxels &&
           (cuts.empty() || cuts.brick(std::size_t(brick)) == nullptr);
  });
}

}  // namespace

BrickNeighbours neighbours_of(const BrickTopology& elements, std::size_t brick) {
  BrickNeighbours bricks;
  bricks.fill(-1);
  bricks[kNoStep] = std::int32_t(brick);
  for (int axes = 1; axes <= 3; ++axes) {
    for (int direction = 0; direction < kDirections; ++direction) {
      if (axes_of_direction(direction) != axes) continue;
      const LinkStep step = step_of_direction(direction);
      std::int32_t& end = bricks[std::size_t(direction)];
      for (int axis = 0; axis < 3 && end < 0; ++axis) {
        const int way = step[std::size_t(axis)];
        if (way == 0) continue;
        const int before = direction - (direction_along(axis, way > 0) - kNoStep);
        const std::int32_t last = bricks[std::size_t(before)];
        if (last >= 0) end = elements.neighbour(std::size_t(last), 2 * axis + (way > 0 ? 1 : 0));
      }
    }
  }
  return bricks;
}

void find_links(const BrickTopology& elements, const LinkCuts& cuts, int links,
                const BrickNeighbours& bricks, LinkMasks& out) {
  if (is_inside(elements, cuts, bricks)) {
    for (int direction = 0; direction < kDirections; ++direction) {
      out[std::size_t(direction)] = has_direction(links, direction) ? kAllVoxels : BrickMask{};
    }
    return;
  }
  std::array<HaloBits, kDirections> halo;
  find_axis_links(elements, cuts, bricks, halo);
  for (int axes = 2; axes <= (links == 6 ? 1 : links == 18 ? 2 : 3); ++axes) {
    for (int direction = 0; direction < kDirections; ++direction) {
      if (axes_of_direction(direction) != axes) continue;
      // A path begins along any of the axes and goes on as the diagonal of the others does.
      const LinkStep step = step_of_direction(direction);
      for (int axis = 0; axis < 3; ++axis) {
        const int way = step[std::size_t(axis)];
        if (way == 0) continue;
        const int along = direction_along(axis, way > 0);
        add_path(halo[std::size_t(along)], halo[std::size_t(direction - (along - kNoStep))], axis,
                 way > 0, halo[std::size_t(direction)]);
      }
    }
  }
  for (int direction = 0; direction < kDirections; ++direction) {
    out[std::size_t(direction)] =
        has_direction(links, direction) ? own_bits(halo[std::size_t(direction)]) : BrickMask{};
  }
}

}  // namespace supple
