// The force on a cluster, and how far its links and the bounds of its elements let it go.
#pragma once

#include <vector>

#include "lib/body/body.h"
#include "lib/body/region.h"
#include "lib/body/slot_set.h"
#include "lib/relax/brick_springs.h"
#include "lib/relax/clusters.h"

namespace supple {

struct ClusterPull {
  double force = 0;            // N/m * 2^-32 voxel, upwards
  double stiffness = 0;        // N/m
  double rise, sink;           // slack, 2^-32 voxel; may be infinite
  bool touches_other = false;  // a link leads to another cluster
};

/// The pull on a cluster under the present offsets in 2^-32 voxel. It may take the part `share` of
/// the slack of a link to another cluster: half where both step at once.
ClusterPull pull_of_cluster(const Clusters& clusters, std::size_t cluster,
                            const BrickArray<double>& offsets, const std::vector<Bound>& at_least,
                            const std::vector<Bound>& at_most, double share);

}  // namespace supple
