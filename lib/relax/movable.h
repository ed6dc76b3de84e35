// Data of a body that every relaxation needs beside its links: the elements that may step, alone or
// as parts of rigid clusters, their bounds, and how far a step may go beyond equilibrium.
#pragma once

#include <utility>
#include <vector>

#include "lib/body/body.h"
#include "lib/body/region.h"
#include "lib/body/slot_set.h"
#include "lib/relax/clusters.h"
#include "lib/relax/link_table.h"

namespace supple {

struct Movable {
  std::vector<BrickMask> movable;  // elements that nothing holds, nor their clusters
  std::vector<BrickMask> single;   // those of them that step on their own
  Clusters rigid;                  // the others of them

  bool moves(Slot slot) const {
    return mask_test(movable[slot / kBrickVoxels], int(slot % kBrickVoxels));
  }
  std::size_t bytes() const;
};

/// Finds the elements that may step in the table's coordinate. A cluster with a held element is
/// held; without `has_clusters` every element steps on its own.
Movable find_movable(const Body& body, const LinkTable& table, const SlotSet& anchored,
                     bool has_clusters);

/// True where some spring of the coordinate rests elsewhere than in the undeformed body.
bool has_rest(const Body& body, int coordinate);

/// The bounds of a brick's elements.
std::pair<std::vector<Bound>::const_iterator, std::vector<Bound>::const_iterator> bounds_in(
    const std::vector<Bound>& bounds, std::size_t brick);

/// Over-relaxation of a pass, counted from 0: grows from 1 as the momentum of Nesterov's method
/// does, up to the value for the slowest mode of a body of that many voxels (Young 1971 for one
/// whose ends are fixed; a free end halves the rate). Any below 2 lowers the energy.
double over_relaxation(int pass, int extent);
/// Voxels of the body along its longest axis.
int largest_extent(const BrickTopology& elements);

}  // namespace supple
