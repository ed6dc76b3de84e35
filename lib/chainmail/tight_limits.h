// Limits of links that depend on the state of the perpendicular ones (thesis section 4.2.4, the
// second suggestion for volume conservation: "If e.g. a link is maximally stretched in x-direction,
// the constraints in y- and z-direction would be made smaller").
//
// A link along an axis has the length 1 + (q_high - q_low) in rest lengths, q along that axis. Let
// lambda be the mean length of the up to four links along a perpendicular axis at its two ends, of
// that perpendicular axis where it differs most from 1 (as max(lambda, 1 / lambda); the lower axis
// where both do so as much). When it differs more than the link's own length,
//   lambda > 1:  max_length' = clamp(lambda^-1/2, min_length, max_length)
//   lambda < 1:  min_length' = clamp(lambda^-1/2, min_length, max_length),
// since x y z stays when y and z both change by x^-1/2. Shear limits stay as they are, and so does
// the other limit of the length: within tightened limits a link holds its own.
#pragma once

#include <array>
#include <cstdint>

#include "lib/body/body.h"
#include "lib/body/slot_set.h"

namespace supple {

/// LinkOffsets in the body's place: q of all coordinates.
using LinkOffsets = std::array<BrickValues, 3>;

/// Range by which a link may be longer than at rest, in 2^-16 voxel.
struct StretchRange {
  std::int32_t least, most;
};

/// The tightened range of a link; not tightened where its limits are the material's.
struct TightRange : StretchRange {
  bool is_tightened;
};

/// The tightened range of the link along `axis` from `low` to `high`, in the state q. About 0.1 us.
TightRange tight_range(const Body& body, const LinkOffsets& q, int axis, Slot low, Slot high);

/// Excess of the links of a state over their tightened limits, and the number of these links.
struct TightCheck {
  std::int64_t links = 0;     // that are tightened
  std::int64_t violated = 0;  // of these, by more than the tolerance
  std::int64_t worst = 0;     // of these, in 2^-16 voxel
  std::int64_t squares = 0;   // of the excesses of all, summed, in 2^-24 voxel^2

  /// Root of the sum of squares, in voxels: 0 only where none misses more than 2^-13 voxel.
  double norm_voxels() const;
};

/// Checks the links of all bricks where one may be tightened, in parallel. `missing`, per axis and
/// at the slot of a link's low end, becomes the change of length that would just satisfy it.
TightCheck check_tight(const Body& body, const LinkOffsets& q, double tolerance,
                       LinkOffsets& missing);

}  // namespace supple
