// Memory and work of a relaxation, for plans.
#pragma once

#include "volumes/base/unit_cost.h"

namespace supple {

constexpr UnitCost kRelaxElementCost = {"relax_element", 9, "An element, per pass and coordinate"};
constexpr UnitCost kVolumeElementCost = {"volume_element", 45,
                                         "The same where cells keep their volume"};

/// Bytes per voxel of the bricks that move, while passes go on (docs/models/relaxation.md), the
/// second where cells keep their volume; and those that stay, the second where tissue flows: a
/// fraction of 16 bits, and a rest length of 32.
constexpr double kRelaxBytes = 18, kVolumeBytes = 25;
constexpr double kFractionBytes = 2, kFlowBytes = 4;
constexpr double kRelaxStartNs = 80;  // per element of the body
/// Passes that take a relaxation one brick further; a budget ends it while it still spreads.
constexpr double kPassesOfRing = 4, kPassesOfRingInBudget = 6;

/// Nanoseconds of a pass over so many elements and coordinates of a body that no cache holds.
/// `relax_ns`, `volume_ns`: what the units cost here.
constexpr double pass_ns(double elements, bool conserves_volume, int links, double relax_ns,
                         double volume_ns) {
  constexpr double kBeyondCaches = 1.6, kVolumeBeyondCaches = 2.6;
  const double looks = links == 26 ? 4 : links == 18 ? 2.5 : 1;  // in those of 6 links
  return conserves_volume ? kVolumeBeyondCaches * elements / 3 * volume_ns
                          : kBeyondCaches * elements * relax_ns * looks;
}

}  // namespace supple
