// Closure of one 8^3 brick under its own links: the inner loop of the block engine.
//
// A sweep along an axis carries levels up and down whole lines of links, which closes every line:
//   level_j = max(level_j, level_i - cost)      max-plus form of q_j = max(q_j, q_i - W)
// along i and j one vector of rows at a time, along k by a max-plus scan inside the vector (steps
// of 1, 2 and 4 with summed costs). Sweeps along the three axes alternate until two in a row change
// nothing, so the fixed point is exact. About 150 cycles per sweep with 16 lanes, 250 with 8;
// noise needs 12 sweeps per visit. Looking the costs up takes about 1,500 cycles.
#pragma once

#include <array>
#include <cstdint>

#include "lib/chainmail/link_costs.h"
#include "volumes/grid/link_cuts.h"

namespace supple {

/// Costs of the links inside a brick, [upward] each. 24 kB.
struct alignas(64) BrickCosts {
  Level i[2][7][64];        // between planes p and p + 1
  Level j[2][8][8][8];      // plane, between rows p and p + 1; the last row stays unused
  Level k[2][3][64][8];     // row, to this voxel from the one 1, 2, 4 steps away
  std::array<bool, 3> any;  // some link along that axis
};

/// The links inside a brick per axis, marked at their low end, and those across its high faces as
/// far as the brick itself knows.
using BrickLinks = std::array<BrickMask, 3>;
BrickLinks links_inside(const BrickMask& elements, const LinkCuts::BrickCuts* cuts);

void look_up_costs(const LinkCosts& costs, const std::uint8_t* classes, const BrickLinks& links,
                   BrickCosts& out);

/// Loads the offsets of a brick as levels.
void load_levels(const std::int32_t* q, Direction direction, Level* levels);
/// Stores levels as offsets; returns the faces on which an offset changed, as bits.
unsigned store_levels(const Level* levels, Direction direction, std::int32_t* q);

/// Costs of 64 links across a face; `links` has the bits of those that exist.
void look_up_face_costs(const CostRow& row, int stride, const std::uint8_t* low_classes,
                        const std::uint8_t* high_classes, std::uint64_t links, Level* out);

/// out[n] = row[index[n]] for a multiple of 64 links.
void gather_costs(const CostRow& row, const std::uint16_t* index, int count, Level* out);
/// Sets costs to kNoLink where a bit is missing, for `rows` times 8 of them.
void remove_missing(std::uint64_t links, int rows, Level* costs);

/// Closes every row of 512 levels under the links along k; true when a level changed.
bool close_rows(const BrickCosts& costs, Level* levels);
/// Raises 512 levels (64-byte aligned) to the closure; returns the number of sweeps.
int close_brick(const BrickCosts& costs, Level* levels);

}  // namespace supple
