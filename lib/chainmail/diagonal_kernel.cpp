#include "lib/chainmail/diagonal_kernel.h"

#include <algorithm>
#include <cstring>

#include "lib/chainmail/brick_vectors.h"

namespace supple {

namespace {

/// The voxels of a brick whose step stays in it.
constexpr std::array<BrickMask, kDirections> steps_inside() {
  std::array<BrickMask, kDirections> masks{};
  for (int direction = 0; direction < kDirections; ++direction) {
    const LinkStep step = step_of_direction(direction);
    for (int offset = 0; offset < kBrickVoxels; ++offset) {
      const int i = (offset >> 6) + step[0], j = (offset >> 3 & 7) + step[1];
      const int k = (offset & 7) + step[2];
      if (((i | j | k) & ~7) != 0) continue;
      masks[std::size_t(direction)][std::size_t(offset >> 6)] |= std::uint64_t(1) << (offset & 63);
    }
  }
  return masks;
}
constexpr std::array<BrickMask, kDirections> kStepsInside = steps_inside();

constexpr int offset_of_direction(int direction) {
  const LinkStep step = step_of_direction(direction);
  return 64 * step[0] + 8 * step[1] + step[2];
}

BrickMask inside(const LinkMasks& links, int direction) {
  BrickMask mask;
  for (std::size_t i = 0; i < 8; ++i) {
    mask[i] = links[std::size_t(direction)][i] & kStepsInside[std::size_t(direction)][i];
  }
  return mask;
}

/// Entries of a cost row for the links from every voxel to the one `step` > 0 offsets on.
void diagonal_entries(const std::uint8_t* __restrict classes, int step, int class_stride,
                      std::uint16_t* __restrict out) {
  const int count = kBrickVoxels - step;
  for (int n = 0; n < count; ++n) {
    out[n] = std::uint16_t(classes[n] * class_stride + classes[n + step]);
  }
  std::fill(out + count, out + kBrickVoxels, std::uint16_t(0));
}

Level* look_up_diagonal(const CostRow& row, const std::uint16_t* entries, const BrickMask& links,
                        Level* out) {
  std::fill(out, out + DiagonalCosts::kAround, kNoLink);
  Level* const first = out + DiagonalCosts::kAround;
  gather_costs(row, entries, kBrickVoxels, first);
  for (int plane = 0; plane < 8; ++plane) {
    remove_missing(links[std::size_t(plane)], 8, first + 64 * plane);
  }
  std::fill(first + kBrickVoxels, first + kBrickVoxels + DiagonalCosts::kAround, kNoLink);
  return first;
}

/// The levels `Step` offsets before those of vector n of a plane; lanes beyond the plane, where
/// links are missing, have some level of it.
template <int Step, std::size_t... Lane>
inline Rows shifted(const Rows* plane, int n, std::index_sequence<Lane...>) {
  constexpr int kWhole = (Step + 16 * kLanes) / kLanes - 16, kPart = Step - kWhole * kLanes;
  const Rows later = plane[std::clamp(n - kWhole, 0, kPlaneVectors - 1)];
  if constexpr (kPart == 0) return later;
  const Rows earlier = plane[std::clamp(n - kWhole - 1, 0, kPlaneVectors - 1)];
  return __builtin_shufflevector(earlier, later, (kLanes - kPart + int(Lane))...);
}
template <int Step>
inline Rows shifted(const Rows* plane, int n) {
  return shifted<Step>(plane, n, std::make_index_sequence<kLanes>());
}

inline Rows rows_at(const Level* levels) {
  Rows rows;
  std::memcpy(&rows, levels, sizeof rows);
  return rows;
}
inline SlackRow row_at(const Level* levels) {
  SlackRow row;
  std::memcpy(&row, levels, sizeof row);
  return row;
}

/// Carries levels along one diagonal into a plane (64 levels from offset `to` on) from the plane
/// before it (Way 1) or after it (-1).
template <int Index, int Way>
inline void carry(const DiagonalCosts& costs, const Rows* from, int to, Rows* into) {
  constexpr int kOffset = offset_of_direction(kUpDiagonals[Index]);
  const Level* links = Way > 0 ? costs.up[Index] : costs.down[Index];
  if (links == nullptr) return;
  links += Way > 0 ? to - kOffset : to;
  for (int n = 0; n < kPlaneVectors; ++n) {
    into[n] = larger(into[n], shifted<Way*(kOffset - 64)>(from, n) - rows_at(links + n * kLanes));
  }
}

template <int Way, std::size_t... Index>
inline void carry_all(const DiagonalCosts& costs, const Rows* from, int to, Rows* into,
                      std::index_sequence<Index...>) {
  (carry<int(Index), Way>(costs, from, to, into), ...);
}

/// Raises a plane from its neighbour plane, along the axis and all diagonals; collects the changes.
template <int Way>
inline void step_plane(const BrickCosts& axes, const DiagonalCosts& diagonals, int to, Rows* plane,
                       Rows* levels, Rows& changed) {
  const Level* axis = Way > 0 ? axes.i[1][to - 1] : axes.i[0][to];
  Rows* const out = levels + to * kPlaneVectors;
  Rows next[kPlaneVectors];
  for (int n = 0; n < kPlaneVectors; ++n) {
    next[n] = larger(out[n], plane[n] - rows_at(axis + n * kLanes));
  }
  carry_all<Way>(diagonals, plane, 64 * to, next, std::make_index_sequence<kPlaneDiagonals>());
  for (int n = 0; n < kPlaneVectors; ++n) {
    changed |= next[n] ^ out[n];
    out[n] = plane[n] = next[n];
  }
}

bool sweep_planes(const BrickCosts& axes, const DiagonalCosts& diagonals, Rows* levels) {
  Rows plane[kPlaneVectors], changed{};
  for (int n = 0; n < kPlaneVectors; ++n) plane[n] = levels[n];
  for (int p = 1; p < 8; ++p) step_plane<1>(axes, diagonals, p, plane, levels, changed);
  for (int p = 6; p >= 0; --p) step_plane<-1>(axes, diagonals, p, plane, levels, changed);
  return any_set(changed);
}

/// A row moved by one lane towards higher k (Way 1) or lower; the end repeats.
template <int Way>
inline SlackRow moved_row(SlackRow row) {
  return Way > 0 ? __builtin_shufflevector(row, row, 0, 0, 1, 2, 3, 4, 5, 6)
                 : __builtin_shufflevector(row, row, 1, 2, 3, 4, 5, 6, 7, 7);
}

bool sweep_rows(const BrickCosts& axes, const DiagonalCosts& diagonals, Level* levels) {
  constexpr int kBackward = 8, kForward = 9;  // directions 15 (0, 1, -1) and 17 (0, 1, 1)
  const Level *const back_up = diagonals.up[kBackward], *const back_down =
                                                            diagonals.down[kBackward];
  const Level *const fore_up = diagonals.up[kForward], *const fore_down = diagonals.down[kForward];
  SlackRow changed{};
  for (int plane = 0; plane < 8; ++plane) {
    Level* const rows = levels + 64 * plane;
    SlackRow level = row_at(rows);
    const auto step = [&](int to, SlackRow reached) {
      const SlackRow before = row_at(rows + 8 * to);
      level = larger(before, reached);
      changed |= level ^ before;
      std::memcpy(rows + 8 * to, &level, sizeof level);
    };
    for (int to = 1; to < 8; ++to) {
      const int at = 64 * plane + 8 * to;
      SlackRow reached = level - row_at(axes.j[1][plane][to - 1]);
      if (back_up) reached = larger(reached, moved_row<-1>(level) - row_at(back_up + at - 7));
      if (fore_up) reached = larger(reached, moved_row<1>(level) - row_at(fore_up + at - 9));
      step(to, reached);
    }
    for (int to = 6; to >= 0; --to) {
      const int at = 64 * plane + 8 * to;
      SlackRow reached = level - row_at(axes.j[0][plane][to]);
      if (back_down) reached = larger(reached, moved_row<1>(level) - row_at(back_down + at));
      if (fore_down) reached = larger(reached, moved_row<-1>(level) - row_at(fore_down + at));
      step(to, reached);
    }
  }
  return any_set(changed);
}

}  // namespace

void look_up_costs(const LinkCosts& costs, const std::uint8_t* classes, const LinkMasks& links,
                   BrickCosts& axes, DiagonalCosts& diagonals) {
  look_up_costs(costs, classes,
                {inside(links, direction_along(0, true)), inside(links, direction_along(1, true)),
                 inside(links, direction_along(2, true))},
                axes);
  alignas(64) std::uint16_t entries[kBrickVoxels];
  for (std::size_t n = 0; n < kUpDiagonals.size(); ++n) {
    const int direction = kUpDiagonals[n];
    const BrickMask present = inside(links, direction);
    diagonals.up[n] = diagonals.down[n] = nullptr;
    if (present == BrickMask{}) continue;
    diagonal_entries(classes, offset_of_direction(direction), costs.stride(), entries);
    diagonals.up[n] = diagonals.down[n] =
        look_up_diagonal(costs.along(direction), entries, present, diagonals.costs[0][n]);
    if (costs.is_symmetric_along(direction)) continue;
    diagonals.down[n] = look_up_diagonal(costs.along(opposite_direction(direction)), entries,
                                         present, diagonals.costs[1][n]);
  }
}

int close_brick(const BrickCosts& axes, const DiagonalCosts& diagonals, Level* levels) {
  // Diagonals exist only where links along their axes do.
  int sweeps = 0;
  for (int quiet = 0; quiet < 3; ++sweeps) {
    const int axis = sweeps % 3;
    bool changed = false;
    if (axis == 0 && axes.any[0]) {
      changed = sweep_planes(axes, diagonals, reinterpret_cast<Rows*>(levels));
    }
    if (axis == 1 && axes.any[1]) changed = sweep_rows(axes, diagonals, levels);
    if (axis == 2 && axes.any[2]) changed = close_rows(axes, levels);
    // Only the sweep along rows closes what it sweeps, so that it counts as quiet itself.
    quiet = !changed ? quiet + 1 : axis == 2 ? 1 : 0;
  }
  return sweeps;
}

}  // namespace supple
