// One sweep of relaxation over one brick: every free node steps towards the mean of its neighbours,
// weighted by the stiffness of its links, no further than the limits allow.
#pragma once

#include <algorithm>
#include <cstdint>

#include "lib/relax/brick_springs.h"
#include "lib/relax/link_table.h"

namespace supple {

struct SweepRule {
  /// Part of the way to the mean.
  double relaxation = 1;
  /// Part of a link's slack that one of its ends may take: half where both ends move at once.
  double share = 0.5;
  /// False: steps know no limits, as in the plain pass of the thesis.
  bool limited = true;
};

struct SweepOutcome {
  double largest_step = 0;  // 2^-32 voxel
  /// Twice the energy of the links of the brick's voxels to the next ones, before the sweep:
  /// N/m * (2^-32 voxel)^2.
  double energy = 0;
  double least_slack = 0;  // of all links that meet the brick, before the sweep; may be infinite
};

/// Joins the outcomes of the lanes of a sweep.
template <class Row>
SweepOutcome outcome_of(const Row& energy, const Row& least_slack, const Row& largest_step) {
  SweepOutcome outcome;
  outcome.least_slack = least_slack[0];
  for (int lane = 0; lane < 8; ++lane) {
    outcome.energy += energy[lane];
    outcome.least_slack = std::min(outcome.least_slack, least_slack[lane]);
    outcome.largest_step = std::max(outcome.largest_step, largest_step[lane]);
  }
  return outcome;
}

/// A spring pulls with stiffness * stretch; beyond its yield stretch the pull stays constant, as in
/// plastic flow. `rest` is null where all are elastic and at rest in the undeformed body.
///
/// `free` nodes of the brick step from `offsets`; all others stay. Writes 512 offsets, those of
/// `offsets` where nothing steps.
SweepOutcome sweep_brick(const PaddedBrick<double>& offsets, const BrickSprings& links,
                         const BrickRest* rest, const LinkTable& table, const BrickMask& free,
                         const SweepRule& rule, double* out);

}  // namespace supple
